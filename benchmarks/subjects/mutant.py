"""What a mutant is: a triangulator with one mistake in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

from rigsim.theory.custom import TriangulatorFunction

Symptom: TypeAlias = Literal["pixels", "camera", "pose", "lens", "frame", "scale", "rows", "range", "scatter"]
"""What part of the answer or of the input the mistake touches."""


@dataclass(frozen=True)
class Mutant:
    """One mistake."""

    name: str
    bug: str
    """What is wrong, one line."""
    expected: str
    """What somebody who sees only its answers would have to be told."""
    symptom: Symptom
    function: TriangulatorFunction
    only_strict: bool = False
    """Whether it is right but wasteful: `verify` must say so, and fail it under --strict alone."""


def mutant(
    mutants: list[Mutant], symptom: Symptom, bug: str, expected: str, only_strict: bool = False
) -> Callable[[TriangulatorFunction], TriangulatorFunction]:
    """Puts a function on the list under its own name."""

    def register(function: TriangulatorFunction) -> TriangulatorFunction:
        name = function.__name__.replace("_", "-")
        mutants.append(Mutant(name, bug, expected, symptom, function, only_strict))
        return function

    return register
