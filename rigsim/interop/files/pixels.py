"""Matched pixels as a table: somebody's CSV in, the same with its points out."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from rigsim import foreign
from rigsim.errors import InvalidRange, OutputError
from rigsim.interop.formats.values import clipped
from rigsim.rig import extent, given
from rigsim.rig.arrays import Array

if TYPE_CHECKING:
    import pandas as pd

    from rigsim.study.calc.points import PairPoints

NEEDED = ("u_left", "v_left", "u_right", "v_right")
"""The columns that a table of pairs must have, px."""
MADE = ("x_mm", "y_mm", "z_mm", "std_x_mm", "std_y_mm", "std_z_mm", "off_px", "consistent", "why")
"""The columns that are added."""
Cells: TypeAlias = Sequence[Any] | npt.NDArray[Any]
"""The cells of a column."""
_WHAT = "a CSV file of matched pixels"


@dataclass(frozen=True, slots=True, eq=False)
class PairTable:
    """Matched pixels, and what else stood beside them."""

    names: tuple[str, ...]
    """Its columns' names, as written."""
    columns: tuple[Cells, ...]
    """The cells of each, N each; words where they were read from a file."""
    uv: Array
    """Pixels (N, 4): u and v left, u and v right, px."""

    def kept(self) -> dict[str, Cells]:
        """Its columns by name, none of them like one that is made: ``z_mm`` is ``z_mm_given``."""
        made = {*MADE}
        return {
            f"{name}_given" if name.lower() in made else name: cells
            for name, cells in zip(self.names, self.columns, strict=True)
        }


def read_pairs(path: Path) -> PairTable:
    """The pairs of the CSV file `path`, with commas, semicolons or tabs between.

    The first line names the columns `NEEDED`, in any order and case, and any others; or there are four
    columns of numbers, without names, in that order. Empty lines are left out.

    Raises:
        OutputError: the file cannot be read.
        InvalidRange: a column is missing, or a pixel is no number; the message names file, line and column.
    """
    try:
        text = foreign.read_text(path, _WHAT, foreign.TABLE_BYTES)
    except UnicodeDecodeError:
        raise OutputError(f"{path}: is not CSV (not UTF-8 text)") from None
    first = next((line for line in text.splitlines() if line.strip()), "")
    try:
        reader = csv.reader(io.StringIO(text, newline=""), delimiter=max(",;\t", key=first.count))
        read = [(reader.line_num, row) for row in reader if any(cell.strip() for cell in row)]
    except csv.Error as error:
        raise InvalidRange(f"{path}: is not valid CSV: {error}") from None
    head = [name.strip() for name in read[0][1]] if read else []
    if head and not _all_numbers(head):
        head[0] = head[0].lstrip("# ")  # as numpy.savetxt writes it
        read = read[1:]
    elif len(head) == len(NEEDED):
        head = list(NEEDED)
    return _table(head, [row for _, row in read], [line for line, _ in read], str(path))


def pairs_from(values: object) -> PairTable:
    """The pairs of a table in memory: a pandas DataFrame, columns by name, or numbers (N, 4).

    Raises:
        InvalidRange: it is none, a column is missing, or a pixel is no number.
    """
    named: Mapping[str, Any] | None = None
    if isinstance(values, Mapping):
        named = values
    elif hasattr(values, "columns") and hasattr(values, "to_numpy"):
        frame: Any = values  # a DataFrame, known without pandas
        named = {str(name): frame[name] for name in frame.columns}
    if named is None:
        uv = _numbers_of(values)
        _check_pixels(uv)
        return PairTable(NEEDED, tuple(uv.T), uv)
    columns = {str(name): np.asarray(column).ravel() for name, column in named.items()}
    places = _places(list(columns), "the table")
    if len({len(column) for column in columns.values()}) > 1:
        raise InvalidRange("the table: its columns must be as long as each other")
    uv = _numbers_of([list(columns.values())[place] for place in places]).T
    extent.PAIRS.check(len(uv))
    _check_pixels(uv)
    return PairTable(tuple(columns), tuple(columns.values()), uv)


def points_columns(pairs: PairTable, found: PairPoints) -> dict[str, Cells]:
    """The columns of the table with its points, N cells each; lengths in mm."""
    numbers = [*(found.points * 1e3).T, *(found.stds * 1e3).T, found.off_px, found.consistent, found.why]
    return {**pairs.kept(), **dict(zip(MADE, numbers, strict=True))}


def points_csv(pairs: PairTable, found: PairPoints) -> str:
    """The same as CSV: what was given as it stood there, numbers at full precision, NaN as an empty cell."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    columns = points_columns(pairs, found)
    writer.writerow(columns)
    writer.writerows(zip(*map(_cells, columns.values()), strict=True))
    return text.getvalue()


def points_table(pairs: PairTable, found: PairPoints) -> pd.DataFrame:
    """The same as a DataFrame; columns of a file that hold numbers alone are numbers."""
    import pandas as pd

    made = points_columns(pairs, found)
    return pd.DataFrame({name: _typed(cells) for name, cells in made.items()})


def _table(head: Sequence[str], rows: Sequence[Sequence[str]], lines: Sequence[int], where: str) -> PairTable:
    places = _places(head, where)
    extent.PAIRS.check(len(rows))
    for row, line in zip(rows, lines, strict=True):
        if len(row) > len(head):
            raise InvalidRange(f"{where}, line {line}: {len(row)} cells, there are {len(head)} columns")
    width = range(len(head))
    columns = tuple([row[place] if place < len(row) else "" for row in rows] for place in width)
    uv = np.empty((len(rows), len(NEEDED)))
    for place, name, out in zip(places, NEEDED, uv.T, strict=True):
        cells = columns[place]
        try:
            out[:] = [float(cell) for cell in cells]
        except ValueError:
            out[:] = [_number(cell) for cell in cells]
        bad = np.flatnonzero(~np.isfinite(out))
        if bad.size:
            cell = cells[bad[0]].strip()
            raise InvalidRange(
                f"{where}, line {lines[bad[0]]}: {name} {clipped(cell) or 'empty'}: must be a number, px"
            )
    return PairTable(tuple(head), columns, uv)


def _places(head: Sequence[str], where: str) -> list[int]:
    """Where the columns `NEEDED` stand."""
    lower = [name.lower() for name in head]
    for name in NEEDED:
        if lower.count(name) > 1:
            raise InvalidRange(f"{where}: column {name} is there {lower.count(name)} times; leave one")
        if name not in lower:
            found = clipped(", ".join(head)) or "nothing"
            raise InvalidRange(
                f"{where}: column {name} is missing (found {found}); the first line must name"
                f" {', '.join(NEEDED)}, or there must be four columns of numbers"
            )
    return [lower.index(name) for name in NEEDED]


def _numbers_of(values: object) -> Array:
    try:
        uv = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidRange(_wanted(values)) from None
    return uv


def _check_pixels(uv: Array) -> None:
    """Refuse what is no pairs (N, 4)."""
    if uv.ndim != 2 or uv.shape[1] != len(NEEDED):
        raise InvalidRange(f"pairs of shape {uv.shape}: must be (N, 4): {', '.join(NEEDED)}, px")
    extent.PAIRS.check(len(uv))
    bad = np.argwhere(~np.isfinite(uv))
    if bad.size:
        row, column = bad[0]
        raise InvalidRange(f"pairs, row {row}: {NEEDED[column]} {uv[row, column]:g}: must be a number, px")


def _wanted(values: object) -> str:
    return (
        f"pairs {given.shown(values)}: must be a CSV file's path, a table with {', '.join(NEEDED)}, or"
        " numbers (N, 4)"
    )


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return math.nan


def _all_numbers(cells: Sequence[str]) -> bool:
    return all(not math.isnan(_number(cell)) or cell.lower() == "nan" for cell in cells)


def _cells(column: Cells) -> Cells:
    """A column's cells for the writer, which spells a number so that it is read back bit for bit."""
    if not isinstance(column, np.ndarray):
        return column
    if column.dtype == bool:
        return ["true" if cell else "false" for cell in column.tolist()]
    if column.dtype.kind != "f":
        return list(column.tolist())
    return ["" if cell != cell else cell for cell in column.tolist()]  # NaN alone differs from itself


def _typed(column: Cells) -> Cells:
    if isinstance(column, np.ndarray) or not _all_numbers(column[:1]):
        return column
    numbers = np.array([_number(cell) for cell in column])
    return column if np.isnan(numbers).any() else numbers
