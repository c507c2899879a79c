"""The end of a sweep in a terminal."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from rigsim.present.kit.console import column_widths, make_console, paragraph, print_table, say, total_width
from rigsim.present.kit.format import count, number, percent, ratio
from rigsim.study.agreement.agreement import flagged as flagged_rows
from rigsim.study.agreement.agreement import kinds
from rigsim.study.scene import columns as col

if TYPE_CHECKING:
    import pandas as pd

    from rigsim.present.sweep.plots.axes import PlotAxis
    from rigsim.study.sweep.result import SweepResult

_MOST_BEST = 5


_MOST_REASONS = 3


def print_sweep(result: SweepResult, folder: Path | None = None, *, console: Console | None = None) -> None:
    """Print the end of a sweep: the verdict, the best rows beside their prediction, flags, and the report.

    Args:
        result: the sweep.
        folder: where its report.html is; nothing is said about it when None.
        console: where to; standard output by default.
    """
    from rigsim.present.sweep.plots.axes import swept_axes
    from rigsim.present.sweep.same import at_same_distances, same_words
    from rigsim.present.sweep.words import verdict

    console = console or make_console()
    axes = swept_axes(result)
    rows = result.rows
    places = list(result.best[:_MOST_BEST]) or list(range(min(len(rows), _MOST_BEST)))
    said = verdict(result)
    paragraph(console, said.headline, style="bold")
    for sentence in said.sentences:
        paragraph(console, sentence, "  ")
    console.print()

    same = same_words(result)
    best = (at_same_distances(result) if same else rows).iloc[places]
    varied = [axis for axis in axes if best[axis.column].nunique() > 1] or axes[:1]
    shared = [axis for axis in axes if axis not in varied]
    title = f"Best {len(places)} of {count(len(rows))}" if len(rows) > len(places) else "Result"
    if result.requirements and len(rows) > len(places):
        title = _asked_title(result)
    if shared:
        title += ", with " + ", ".join(
            f"{axis.heading} {axis.say(best.iloc[0][axis.column])}" for axis in shared
        )
    columns = _fitting(_sweep_columns(result, best, varied, places), console.width)
    paragraph(console, title, style="bold")
    print_table(
        "",
        [column.head for column in columns],
        list(zip(*(column.cells for column in columns), strict=True)),
        numeric=[column.numeric for column in columns],
        console=console,
    )
    if same:
        words = f"Simulated and predicted: {same} of the left image, the same for all rows."
        paragraph(console, words if len(rows) > 1 else f"Simulated and predicted: {same} of the left image.")
        console.print()
    _print_flags(result, console, axes)
    if folder is not None:
        say(console, f"Report: {folder / 'report.html'}", "bold")


def _asked_title(result: SweepResult) -> str:
    """What stands in the table where something is asked: the rows that meet it before the others."""
    from rigsim.study.sweep.requirement import verdicts

    n, n_met = len(result.rows), verdicts(result.requirements).count("met")
    if n_met < 2:
        return f"The rig of the answer, and the nearest of the other {count(n - 1)}"
    others = "the other one" if n_met == 2 else f"others of the {count(n_met)}"
    if n_met >= _MOST_BEST:
        return f"The rig of the answer, and {others} that meet it"
    meet = "meets" if n_met == 2 else "meet"
    return f"The rig of the answer, {others} that {meet} it, and the nearest of the rest"


@dataclass(frozen=True, slots=True)
class _Column:
    head: str
    cells: tuple[str, ...]
    numeric: bool
    importance: int


def _sweep_columns(
    result: SweepResult, best: pd.DataFrame, axes: list[PlotAxis], places: list[int]
) -> list[_Column]:
    columns = [
        _Column(
            f"{axis.heading}\n{axis.unit}".rstrip(), tuple(map(axis.show, best[axis.column])), axis.numeric, 9
        )
        for axis in axes
    ]
    agreement = tuple(kinds(best))
    # what is asked for at a distance is not judged by the error at all distances together
    together = 6 if result.requirements else 9
    return [
        *columns,
        *_requirement_columns(result, places),
        _Column("simulated\nRMS, mm", tuple(map(number, best[col.DEPTH_RMSE])), True, together),
        _Column("predicted\nRMS, mm", tuple(map(number, best[col.PREDICTED_DEPTH_RMSE])), True, 5),
        _Column("predicted/\nsimulated", tuple(map(ratio, best[col.PREDICTED_OVER_SIMULATED])), True, 3),
        _Column("seen by\nboth, %", tuple(map(percent, best[col.VISIBLE_FRACTION])), True, 2),
        _Column("limited by", tuple(result.limits[place] for place in places), False, 4),
        *_measured_columns(best),
        _Column("agreement", agreement, False, 9),
    ]


def _requirement_columns(result: SweepResult, places: list[int]) -> list[_Column]:
    """The error at each distance asked for, and whether the rows keep it, where something is asked."""
    from rigsim.present.sweep.requirement_words import WORDS
    from rigsim.study.sweep.requirement import verdicts

    found = verdicts(result.requirements)
    if not found:
        return []
    columns = [
        _Column(
            f"at {one.asked.at_mm / 1e3:.4g} m\n{'p95' if one.asked.p95 else 'RMS'}, mm",
            tuple(number(one.rows[place].error_mm) for place in places),
            True,
            9 if one is result.requirements[0] else 8,
        )
        for one in result.requirements
    ]
    return [*columns, _Column("required", tuple(WORDS[found[place]] for place in places), False, 9)]


def _measured_columns(best: pd.DataFrame) -> list[_Column]:
    """What the third witness says, when there is one."""
    from rigsim.present.sweep.measured_words import was_measured

    if not was_measured(best):
        return []
    return [
        _Column("measured\nRMS, mm", tuple(map(number, best[col.MEASURED_DEPTH_RMSE])), True, 8),
        _Column("measured/\npredicted", tuple(map(ratio, best[col.MEASURED_OVER_PREDICTED])), True, 7),
    ]


def _fitting(columns: list[_Column], width: int) -> list[_Column]:
    """The columns without the least important ones that a line of `width` has no room for."""
    columns = list(columns)
    while min(column.importance for column in columns) < 9:
        heads = [column.head.split("\n") for column in columns]
        widths = column_widths(heads, list(zip(*(column.cells for column in columns), strict=True)))
        if total_width(widths) <= width:
            break
        columns.remove(min(columns, key=lambda column: column.importance))
    return columns


def _print_flags(result: SweepResult, console: Console, axes: list[PlotAxis]) -> None:
    from rigsim.present.kit.agreement import reason

    rows = result.rows
    flagged = rows[flagged_rows(rows)]
    if not len(flagged):
        return
    say(console, f"Flagged: {count(len(flagged))} of {count(len(rows))}", "bold yellow")
    for record in flagged.head(_MOST_REASONS).to_dict("records"):
        row: dict[Any, Any] = record
        where = ", ".join(f"{axis.heading} {axis.say(row[axis.column])}" for axis in axes)
        why = reason(row[col.AGREEMENT])
        paragraph(console, f"{where}: {why}" if where else why, "  ")
    if len(flagged) > _MOST_REASONS:
        say(console, f"  and {count(len(flagged) - _MOST_REASONS)} more, listed in the report")
    console.print()
