"""The tables of a report: cells as text, ready to be typeset."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from rigsim.present.kit.agreement import reason
from rigsim.present.kit.format import count, number, with_interval
from rigsim.present.sweep.column_words import COLUMNS, ShownColumn
from rigsim.present.sweep.measured_words import was_measured
from rigsim.present.sweep.plots.axes import swept_axes
from rigsim.present.sweep.same import comparison_of
from rigsim.study.scene import columns as col
from rigsim.study.scene.columns import AXES
from rigsim.study.sweep.comparison import row_of_bins
from rigsim.study.sweep.result import SweepResult

MOST_ROWS = 200
"""Rows of the table of all rows; of more, the best ones are shown."""

_SIMULATED: dict[str, str] = {
    col.DEPTH_RMSE: "RMS",
    "interval": "95 % interval",
    col.PREDICTED_DEPTH_RMSE: "predicted",
    col.PREDICTED_OVER_SIMULATED: "ratio",
}
_MEASURED: dict[str, str] = {
    col.MEASURED_DEPTH_RMSE: "RMS",
    col.PREDICTED_FROM_MEASURED_RMSE: "predicted",
    col.MEASURED_OVER_PREDICTED: "ratio",
    col.MEASURED_N: "points",
    col.MEASURED_OUTLIER_FRACTION: "outliers",
}
_ALONE = (col.DEPTH_ABS_P95, col.DEPTH_BIAS, col.DEPTH_RMSE_PCT, col.NEES)
"""What else the simulation says, where nothing was measured."""
DITTO = "″"
"""In place of a number that stands above already."""
_OF: dict[str, str] = {
    col.PREDICTED_OVER_SIMULATED: "pred. / sim.",
    col.MEASURED_OVER_PREDICTED: "meas. / pred.",
}
"""What is divided by what, where the heading is short."""
_GROUPS: tuple[tuple[str, dict[str, str]], ...] = (
    ("simulated: depth error", _SIMULATED),
    ("measured in renderings: depth error", _MEASURED),
)
"""Headings over the columns of the second and the third witness, and those columns' short headings."""


@dataclass(frozen=True, slots=True)
class TableRow:
    """One row of a table."""

    cells: tuple[str, ...]
    """Texts, one a column."""
    flagged: bool = False
    """Whether the witnesses disagree here."""
    best: bool = False
    """Whether this is the best configuration."""
    missed: bool = False
    """Whether it does not keep, or is not shown to keep, what was asked."""
    why: str = ""
    """What a line of its own under the row says."""


@dataclass(frozen=True, slots=True)
class PageTable:
    """A table for people."""

    headings: tuple[tuple[str, str], ...]
    """Heading and unit of each column."""
    numeric: tuple[bool, ...]
    """Whether a column holds numbers, which stand right."""
    rows: tuple[TableRow, ...]
    """The rows."""
    note: str = ""
    """What was left out, in words."""
    groups: tuple[tuple[str, int], ...] = ()
    """Headings over several columns: what they say and how many columns they span; none when empty."""


def all_rows(result: SweepResult) -> PageTable:
    """One row a configuration, in the order of the sweep; of more than `MOST_ROWS` the best, best first."""
    rows = result.rows
    places = list(range(len(rows)))
    note = ""
    if len(rows) > MOST_ROWS:
        ranked = list(result.best)
        chosen = set(ranked)
        rest = [
            int(i)
            for i in np.argsort(comparison_of(result).simulated_mm, kind="stable")
            if int(i) not in chosen
        ]
        places = (ranked + rest)[:MOST_ROWS]
        note = f"The best {MOST_ROWS} of {count(len(rows))} rows, best first."
    axes = swept_axes(result)
    shown: list[_Shown] = [
        _Shown(axis.heading, axis.unit, axis.column, axis.show if axis.numeric else str, axis.numeric)
        for axis in axes
    ]
    shown += _error_columns(rows)
    best = result.best[0] if result.best else -1
    same = _Shown("at the same distances", "mm", "same", number)
    limits = [_Shown("limited by", "", "limits", str, False)]
    if len(rows) > 1 and len(set(result.limits)) == 1:
        note = f"{note} All are limited by {result.limits[0]}.".strip()
        limits = []
    table = rows.assign(limits=list(result.limits), same=comparison_of(result).simulated_mm).iloc[places]
    columns = _fitting([*shown, same, *limits, _AGREEMENT])
    found = _table(columns, table, [place == best for place in places], note)
    return replace(found, rows=_once(found.rows, columns, table))


def _fitting(columns: list[_Shown]) -> list[_Shown]:
    """The columns that a page has room for; what is left out stands in the files."""
    for name in (col.MEASURED_OUTLIER_FRACTION, col.MEASURED_N, _INTERVAL.name):
        if len(columns) <= _MOST_COLUMNS:
            break
        columns = [column for column in columns if column.name != name]
    return columns


_MOST_COLUMNS = 14
_INDEPENDENT: dict[str, frozenset[str]] = {
    # pictures have a noise of their own; the simulation looks at no picture
    col.NOISE: frozenset((*_MEASURED, col.VISIBLE_FRACTION)),
    col.SENSOR: frozenset((*_SIMULATED, *_ALONE, "same", col.VISIBLE_FRACTION)),
}
"""Which columns do not depend on an axis."""


def _once(rows: tuple[TableRow, ...], columns: Sequence[_Shown], table: pd.DataFrame) -> tuple[TableRow, ...]:
    """The rows with a ditto mark where a number stands above, where no axis that matters differs."""
    seen: dict[tuple[Any, ...], str] = {}
    found = []
    for row, record in zip(rows, table.to_dict("records"), strict=True):
        cells = list(row.cells)
        for place, column in enumerate(columns):
            free = {axis for axis, names in _INDEPENDENT.items() if column.name in names}
            if not free:
                continue
            key = (column.name, *(record[axis] for axis in AXES if axis not in free))
            if seen.get(key) == row.cells[place]:
                cells[place] = DITTO
            seen[key] = row.cells[place]
        found.append(replace(row, cells=tuple(cells)))
    return tuple(found)


def best_by_depth(result: SweepResult) -> PageTable:
    """The best configuration, one row a bin of depth."""
    place = result.best[0] if result.best else result.showcase.row
    table = result.by_depth[row_of_bins(result.rows, result.by_depth) == place]
    names = (col.DEPTH_NEAR, col.DEPTH_FAR, col.N_POINTS)
    columns = (*(_of(COLUMNS[name]) for name in names), *_error_columns(table), _AGREEMENT)
    found = _table(columns, table, [False] * len(table))
    if result.rows.iloc[place][col.AGREEMENT].kind == "flagged":
        return found
    # of ten bins one is off by chance: what the page says of the rig goes by all of them
    return replace(found, rows=tuple(replace(row, flagged=False) for row in found.rows))


@dataclass(frozen=True, slots=True)
class _Shown:
    heading: str
    unit: str
    name: str
    show: Callable[[Any], str]
    numeric: bool = True


def _of(column: ShownColumn) -> _Shown:
    return _Shown(column.heading, column.unit, column.name, column.show, column.numeric)


def _error_columns(table: pd.DataFrame) -> list[_Shown]:
    """What says how good a configuration is; columns that are nil throughout are left out.

    With a third witness the columns stand in groups, and what a page has no room for stands in the files.
    """
    nil = [name for name in (col.LOW_DISPARITY_FRACTION, col.FAILED_FRACTION) if not (table[name] > 0).any()]
    rest = [col.VISIBLE_FRACTION, col.LOW_DISPARITY_FRACTION, col.FAILED_FRACTION]
    if was_measured(table):
        columns = [replace(_named(name), heading=head) for _, part in _GROUPS for name, head in part.items()]
        columns = [replace(column, unit=_OF.get(column.name, column.unit)) for column in columns]
    else:
        columns = [_named(name) for name in _SIMULATED]
        rest = [*_ALONE, *rest]
    return columns + [_named(name) for name in rest if name not in nil]


def _named(name: str) -> _Shown:
    return _INTERVAL if name == "interval" else _of(COLUMNS[name])


def _groups(columns: Sequence[_Shown]) -> tuple[tuple[str, int], ...]:
    """The headings over columns of the second and the third witness; none without a third."""
    if not any(column.name in _MEASURED for column in columns):
        return ()
    over = [next((heading for heading, names in _GROUPS if column.name in names), "") for column in columns]
    return tuple((heading, len(list(same))) for heading, same in itertools.groupby(over))


def _table(columns: Sequence[_Shown], table: pd.DataFrame, best: list[bool], note: str = "") -> PageTable:
    rows = tuple(
        TableRow(
            tuple(_cell(column, record, within=_INTERVAL in columns) for column in columns),
            record[col.AGREEMENT].kind == "flagged",
            is_best,
            why=reason(record[col.AGREEMENT]),
        )
        for record, is_best in zip(table.to_dict("records"), best, strict=True)
    )
    headings = tuple((column.heading, column.unit) for column in columns)
    return PageTable(headings, tuple(column.numeric for column in columns), rows, note, _groups(columns))


def _cell(column: _Shown, record: dict[Any, Any], within: bool) -> str:
    """A cell; the error beside its interval has no more digits than that leaves."""
    value, low, high = (
        record[name] for name in (col.DEPTH_RMSE, col.DEPTH_RMSE_CI_LOW, col.DEPTH_RMSE_CI_HIGH)
    )
    known = np.isfinite(low) and np.isfinite(high)
    if column.name == _INTERVAL.name:
        return " – ".join(with_interval(value, low, high)[1:]) if known else number(np.nan)
    if column.name == col.DEPTH_RMSE and within and known:
        return with_interval(value, low, high)[0]
    return column.show(record[column.name])


_AGREEMENT = replace(_of(COLUMNS[col.AGREEMENT]), show=lambda agreement: str(agreement.kind))
_INTERVAL = _Shown("95 % interval", "mm", "interval", str)
