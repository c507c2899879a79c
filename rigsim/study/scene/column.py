"""What a column of a table is: its name, unit, meaning, heading and format."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

_DIGITS = 12

ColumnFormat: TypeAlias = Literal["text", "count", "number", "short", "angle", "ratio", "percent", "metres"]
"""How values read for people: words, whole numbers, three digits, up to four digits as typed, up to three,
a ratio, a share as percent, millimetres as metres."""


@dataclass(frozen=True, slots=True, eq=False)
class Column:
    """One column, for files, documents, pages and docs alike."""

    name: str
    """In files: ``depth_rmse_mm``; it carries the unit."""
    heading: str
    """What a person calls it; a newline says where it breaks in a narrow table."""
    unit: str
    """Unit in files: mm, px, deg, %, 1/m, "" without one."""
    format: ColumnFormat
    """How values read for people."""
    meaning: str
    """One plain sentence."""
    empty: bool = True
    """Whether a row may have none (null, NaN, an empty cell)."""
    pattern: str = ""
    """What words must look like, a regular expression; "" for any."""
    whole: bool = False
    """Whether numbers are whole ones; those of the format "count" are in any case."""
    above: float | None = None
    """What numbers are greater than; None for any."""
    words: tuple[str, ...] = ()
    """The words there are; none for any."""

    @property
    def numeric(self) -> bool:
        """Whether values are numbers."""
        return self.format != "text"

    @property
    def shown_unit(self) -> str:
        """Unit of the number that people are shown."""
        if self.format in ("percent", "metres"):
            return {"percent": "%", "metres": "m"}[self.format]
        return "°" if self.unit == "deg" else self.unit


class ColumnList:
    """Columns that are being put together."""

    def __init__(self) -> None:
        self.columns: list[Column] = []
        """So far, in order."""

    def add(
        self,
        name: str,
        heading: str,
        unit: str,
        format: ColumnFormat,
        meaning: str,
        empty: bool = True,
        pattern: str = "",
    ) -> str:
        """Put one more column at the end; its name."""
        return self.put(Column(name, heading, unit, format, meaning, empty, pattern))

    def put(self, column: Column) -> str:
        """Put `column` at the end; its name."""
        self.columns.append(column)
        return column.name


def clean(value: float) -> float:
    """The value without the last digits' rounding noise: 150, not 149.99999999999997."""
    return float(f"{value:.{_DIGITS}g}")
