"""Golden results of any command: written, or what came now held against them."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rigsim.errors import InvalidRange
from rigsim.rig import given

if TYPE_CHECKING:
    from rigsim.study.golden.compare import GoldenComparison, GoldenReport, Record

GOLDEN = Path("reports/golden")
"""Where golden results are written unless something else is said."""


def check(path: Path, command: str, update: bool) -> None:
    """Fail before the work rather than after it where golden results cannot be read or not be written.

    Raises:
        OutputError: there is none to compare with, it is another command's, or something else lies there.
    """
    from rigsim.interop.files.golden import check_golden

    check_golden(path, command, update)


def hold(
    record: Record, path: str | os.PathLike[str], update: bool = False, tolerance: float = 0.0
) -> GoldenReport:
    """Hold golden numbers against those of a file, or write them there.

    Args:
        record: what came now.
        path: a CSV file, or a folder that holds one for each command.
        update: whether the file is written anew.
        tolerance: what every number may differ by in any case, relative.

    Raises:
        InvalidRange: a tolerance that cannot be.
        OutputError: there is no golden file, it cannot be read or written, or it is another command's.
    """
    from rigsim.interop.files.golden import check_golden, golden_file, read_one, write_one
    from rigsim.study.golden.compare import COMMAND, GoldenComparison, GoldenReport, compare

    place, looser = given.path(path, "golden"), given.real(tolerance, "golden tolerance")
    if not (math.isfinite(looser) and looser >= 0):
        raise InvalidRange(f"golden tolerance {looser:g}: must be >= 0")
    command = record.about[COMMAND]
    file = golden_file(place, command)
    if not update:
        return GoldenReport(
            str(file), compare([_named(read_one(place, command), record)], [record], looser=looser)
        )
    check_golden(place, command, update)
    comparison, troubles = (
        _against_old(place, record, looser) if file.exists() else (GoldenComparison(()), ())
    )
    return GoldenReport(str(file), comparison, troubles, written=(str(write_one(place, record)),))


def print_comparison(report: GoldenReport | None) -> None:
    """Print what moved, where it was asked."""
    if report is not None:
        from rigsim.present.verify.golden import print_golden

        print_golden(report)


def record_of(command: str, document: Mapping[str, Any], about: Mapping[str, str] | None = None) -> Record:
    """The golden numbers of a command's document, and what made them."""
    from rigsim.study.golden.record import document_record

    return document_record(command, document, {**_versions(command, document), **(about or {})})


def record_from(found: Any, keys: str | Sequence[str] = ()) -> Record:
    """The golden numbers of a result, of a command's document, or of a table, pandas or rows as mappings.

    Raises:
        InvalidRange: it is nothing of these.
    """
    from rigsim.api.result import Result
    from rigsim.study.golden.record import command_of, table_record

    document = found.document() if isinstance(found, Result) else found
    if isinstance(document, Mapping):
        command = command_of(document)
        if command is None:
            raise InvalidRange("golden: must be of a sweep, a design, a tolerance study, calc, or a table")
        return record_of(command, document)
    rows = document.to_dict("records") if hasattr(document, "to_dict") else document
    if not isinstance(rows, Sequence) or not all(isinstance(row, Mapping) for row in rows):
        raise InvalidRange(f"golden {type(found).__name__}: must be a result, a document or a table")
    return table_record(rows, [str(key) for key in given.several(keys)], {})


def _against_old(place: Path, record: Record, looser: float) -> tuple[GoldenComparison, tuple[str, ...]]:
    """What moved since the golden file that is written over, and why that is not known."""
    from rigsim.errors import OutputError
    from rigsim.interop.files.golden import read_one
    from rigsim.study.golden.compare import COMMAND, GoldenComparison, compare

    try:
        old = read_one(place, record.about[COMMAND])
    except OutputError as error:  # edited or cut off: what is there says nothing
        what, _, _ = str(error).rpartition("; ")  # without the way out, which was taken
        return GoldenComparison(()), (f"{what}; it was written over, and what moved is not known",)
    return compare([_named(old, record)], [record], looser=looser), ()


def _named(old: Record, record: Record) -> Record:
    """A golden record under the name of the one that is held against it, whatever its file is called."""
    from dataclasses import replace

    return replace(old, name=record.name)


def _versions(command: str, document: Mapping[str, Any]) -> dict[str, str]:
    """Versions of what made the numbers, where the document does not say itself."""
    if document.get("provenance"):
        return {}
    from importlib.metadata import version

    closed_forms = command.startswith("calc")
    names = ("rigsim", "numpy") if closed_forms else ("rigsim", "mujoco", "numpy", "scipy")
    return {name: version(name) for name in names}
