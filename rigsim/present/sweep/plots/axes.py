"""Which axes a sweep varied, and the slices of its table that a picture can show."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from rigsim.present.sweep.column_words import COLUMNS
from rigsim.study.scene import columns as col
from rigsim.study.sweep.result import SweepResult

MAX_LINES = 6


@dataclass(frozen=True, slots=True)
class PlotAxis:
    """One thing that was varied."""

    column: str
    """Its column in the table."""
    heading: str
    """What a person calls it."""
    unit: str
    """Its unit, "" when it has none."""
    values: tuple[Any, ...]
    """Its values in the table, sorted when numeric, in order of appearance otherwise."""
    numeric: bool
    """Whether the values are numbers."""
    show: Callable[[Any], str]
    """A value as text, without its unit."""

    @property
    def label(self) -> str:
        """Heading and unit: ``baseline, mm``."""
        return f"{self.heading}, {self.unit}" if self.unit else self.heading

    def say(self, value: Any) -> str:
        """Value with its unit: ``120 mm``, ``8°``."""
        gap = "" if self.unit in ("", "°") else " "
        return f"{self.show(value)}{gap}{self.unit}"


@dataclass(frozen=True, slots=True)
class Slice:
    """What one plot against `x` shows: a line for each of `values` of `lines`, the rest held."""

    x: PlotAxis
    """Axis drawn along the page."""
    lines: PlotAxis | None
    """Axis that tells the curves apart; None for a single curve."""
    values: tuple[Any, ...]
    """Values of `lines` that are drawn."""
    held: dict[str, Any]
    """Columns kept at the value of the best row."""
    note: str
    """What was left out or held, in words; "" when nothing was."""

    def parts(self, table: pd.DataFrame) -> list[tuple[Any, pd.DataFrame]]:
        """The rows of each line, sorted along x; lines without rows are left out."""
        table = table[_matches(table, self.held)]
        parts: list[tuple[Any, pd.DataFrame]] = []
        for value in self.values or (None,):
            part = table if self.lines is None else table[table[self.lines.column] == value]
            if len(part):
                parts.append(
                    (value, part.sort_values(self.x.column, kind="stable") if self.x.numeric else part)
                )
        return parts


def swept_axes(result: SweepResult) -> list[PlotAxis]:
    """The varied axes in the order of `result.swept`; width and height that go together count as one."""
    rows, names = result.rows, [name for name in result.swept if name in result.rows]
    said = _resolutions(rows)
    if col.WIDTH in names and said:
        names = [name for name in names if name != col.HEIGHT]
    axes = [
        PlotAxis(name, "resolution", "px", tuple(sorted(said)), True, lambda value: said[int(value)])
        if name == col.WIDTH and said
        else _axis(rows, name)
        for name in names
    ]
    return [axis for axis in axes if len(axis.values) > 1]


def best_row(result: SweepResult) -> pd.Series[Any]:
    """The best row of the table, or the one on show when none is ranked."""
    return result.rows.iloc[result.best[0] if result.best else result.showcase.row]


def slice_along(result: SweepResult, x: PlotAxis, axes: list[PlotAxis]) -> Slice:
    """The slice through the best row that shows what `x` does, with the first other axis as lines."""
    others = [axis for axis in axes if axis.column != x.column]
    best = best_row(result)
    lines = others[0] if others else None
    held = {axis.column: best[axis.column] for axis in others[1:]}
    notes = [held_words(axis, best[axis.column]) for axis in others[1:]]
    values: tuple[Any, ...] = ()
    if lines is not None:
        values = representative(lines.values, best[lines.column])
        if len(values) < len(lines.values):
            notes.insert(0, f"{len(values)} of {len(lines.values)} values of {lines.heading} shown")
    return Slice(x, lines, values, held, "; ".join(notes))


def held_words(axis: PlotAxis, value: Any) -> str:
    """That an axis is held at a value; number and unit stay on one line."""
    said = axis.say(value)
    return f"{axis.heading} held at " + (said.replace(" ", "\u00a0") if axis.unit else said)


def representative(values: tuple[Any, ...], wanted: Any, count: int = MAX_LINES) -> tuple[Any, ...]:
    """At most `count` of `values`, evenly spread with both ends, `wanted` among them."""
    if len(values) <= count:
        return values
    picked = {int(i) for i in np.linspace(0, len(values) - 1, count).round()}
    place = values.index(wanted)
    if place not in picked:
        inner = sorted(picked - {0, len(values) - 1})
        picked.discard(min(inner, key=lambda i: abs(i - place)))
        picked.add(place)
    return tuple(values[i] for i in sorted(picked))


def _axis(rows: pd.DataFrame, name: str) -> PlotAxis:
    column = COLUMNS[name]
    numeric = column.numeric
    found = rows[name].unique().tolist()
    values = tuple(sorted(found) if numeric else found)
    show = column.show
    if not numeric and len({_function(value) for value in values}) == len(values):
        show = _function
    return PlotAxis(name, column.heading, column.unit, values, numeric, show)


def _function(name: str) -> str:
    """The last part of ``package.module:function``, which is all that fits beside a plot."""
    return name.rpartition(":")[2]


def _resolutions(rows: pd.DataFrame) -> dict[int, str]:
    """Image size by image width, when several heights go with the widths one to one; else empty."""
    sizes = rows[[col.WIDTH, col.HEIGHT]].drop_duplicates()
    if not sizes[col.WIDTH].is_unique or sizes[col.HEIGHT].nunique() < 2:
        return {}
    pairs = zip(sizes[col.WIDTH].tolist(), sizes[col.HEIGHT].tolist(), strict=True)
    return {int(width): f"{width:.0f} × {height:.0f}" for width, height in pairs}


def _matches(table: pd.DataFrame, held: dict[str, Any]) -> pd.Series[bool]:
    match = pd.Series(True, index=table.index)
    for name, value in held.items():
        match &= table[name] == value
    return match
