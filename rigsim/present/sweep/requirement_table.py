"""What was asked of the rows, and what each makes of it, as a table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rigsim.present.kit.format import MISSING, number
from rigsim.present.sweep.plots.axes import swept_axes
from rigsim.present.sweep.requirement_words import WORDS, asked_words
from rigsim.present.sweep.tables import MOST_ROWS, PageTable, TableRow
from rigsim.study.scene import columns as col
from rigsim.study.scene.columns import AXES
from rigsim.study.sweep.requirement import RowHeld, take
from rigsim.study.sweep.result import SweepResult


def requirement_table(result: SweepResult) -> PageTable | None:
    """One row a configuration that the simulation tells apart, in the order of the sweep, or where they are
    many those that were ranked first: its error at each distance asked for, with its interval, and whether
    that is enough; None where nothing was asked."""
    held = result.requirements
    if not held:
        return None
    axes = [axis for axis in swept_axes(result) if axis.column != col.SENSOR]
    headings = [(axis.heading, axis.unit) for axis in axes]
    numeric = [axis.numeric for axis in axes]
    for one in held:
        headings += [(asked_words(one.asked), "simulated, mm"), ("95 % interval", "mm"), ("verdict", "")]
        numeric += [True, True, False]
    taken = take(result.rows, result.best, held)
    places: Sequence[int] = range(len(result.rows))
    if len(places) > MOST_ROWS:
        places = [*result.best, *(i for i in places if i not in set(result.best))]
    rows: list[TableRow] = []
    seen: set[tuple[object, ...]] = set()
    for place in places:
        row = result.rows.iloc[place]
        own = tuple(row[axis] for axis in AXES if axis != col.SENSOR)
        if own in seen or len(rows) == MOST_ROWS:
            continue
        seen.add(own)
        cells = [axis.show(row[axis.column]) if axis.numeric else str(row[axis.column]) for axis in axes]
        for one in held:
            cells += _cells(one.rows[place])
        missed = any(one.rows[place].verdict != "met" for one in held)
        rows.append(TableRow(tuple(cells), best=place == taken, missed=missed))
    if not axes:
        headings, numeric = [("rig", ""), *headings], [False, *numeric]
        rows = [replace(row, cells=("this rig", *row.cells)) for row in rows]
    return PageTable(tuple(headings), tuple(numeric), tuple(rows))


def _cells(row: RowHeld) -> list[str]:
    if not row.near_mm > 0:
        return [MISSING, MISSING, WORDS[row.verdict]]
    return [number(row.error_mm), f"{number(row.low_mm)} – {number(row.high_mm)}", WORDS[row.verdict]]
