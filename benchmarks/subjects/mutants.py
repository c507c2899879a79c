"""Wrong triangulators: small mistakes, of the kind that people make, in correct ones of their own.

Each is a plain function: ``rigsim verify --triangulator
benchmarks.subjects.mutants_of_input:swapped_pixels`` runs it too.
"""

from __future__ import annotations

from benchmarks.subjects import mutants_of_answer, mutants_of_files, mutants_of_input, mutants_on_condition
from benchmarks.subjects.mutant import Mutant

MUTANTS: tuple[Mutant, ...] = (
    *mutants_of_input.MUTANTS,
    *mutants_of_answer.MUTANTS,
    *mutants_of_files.MUTANTS,
    *mutants_on_condition.MUTANTS,
)
"""All of them."""
