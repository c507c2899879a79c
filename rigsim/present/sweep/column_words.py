"""What the columns of the tables are called and how their values read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from rigsim.present.kit import format as fmt
from rigsim.study.scene import columns
from rigsim.study.scene.column import ColumnFormat


@dataclass(frozen=True, slots=True)
class ShownColumn:
    """One column of a table for people."""

    name: str
    """Column of `SweepResult.rows`."""
    heading: str
    """What a person calls it."""
    unit: str
    """Unit of the shown number, "" when it has none."""
    show: Callable[[Any], str]
    """A value as text, without its unit."""
    numeric: bool
    """Whether values are numbers."""

    @property
    def label(self) -> str:
        """Heading and unit, for an axis or a legend: ``baseline, mm``."""
        return f"{self.heading}, {self.unit}" if self.unit else self.heading


_SHOW: Mapping[ColumnFormat, Callable[[Any], str]] = {
    "text": str,
    "count": fmt.count,
    "number": fmt.number,
    "short": lambda value: fmt.plain(value, 4),
    "angle": lambda value: fmt.plain(value, 3),
    "ratio": fmt.ratio,
    "percent": fmt.percent,
    "metres": lambda value: fmt.number(value / 1e3),
}

COLUMNS: dict[str, ShownColumn] = {
    column.name: ShownColumn(
        column.name, column.heading, column.shown_unit, _SHOW[column.format], column.numeric
    )
    for column in columns.COLUMNS.values()
}
"""Every column a report may show, by its name in the table."""
