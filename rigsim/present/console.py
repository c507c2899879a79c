"""Tables in a terminal: the end of a sweep, and lists of anything; plain text when nobody is watching."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.cells import cell_len
from rich.console import Console
from rich.text import Text

from rigsim.present.format import count, number, percent, ratio
from rigsim.study.agreement import kind_of, reason_of

if TYPE_CHECKING:
    import pandas as pd

    from rigsim.present.axes import Axis
    from rigsim.study.result import SweepResult

_MOST_BEST = 5
_MOST_REASONS = 3
_GAP = 2
_NARROWEST = 12
_NUMBER = re.compile(r"[-−+]?\d[\d\u202f]*(\.\d+)?([eE][-+]?\d+)?|–")


def make_console(*, stderr: bool = False, width: int | None = None) -> Console:
    """A console that prints what it is given: no markup, no emoji, and no colour unless on a terminal."""
    return Console(stderr=stderr, width=width, emoji=False, markup=False, highlight=False)


def print_table(
    title: str,
    columns: Sequence[str],
    rows: Sequence[Sequence[object]],
    *,
    numeric: Sequence[bool] | None = None,
    console: Console | None = None,
) -> None:
    """Print a table with a heading, and an empty line after it.

    Only the last column of words is wrapped when the terminal is narrow, and only between words.

    Args:
        title: heading; none when empty.
        columns: heads of the columns; a newline starts a second line.
        rows: values, one sequence a row, turned into text as they are.
        numeric: which columns stand right; by default those whose values are all numbers.
        console: where to; standard output by default.
    """
    console = console or make_console()
    if numeric is None:
        numeric = [bool(rows) and all(_is_number(row[i]) for row in rows) for i in range(len(columns))]
    texts = [[str(value) for value in row] for row in rows]
    heads = [column.split("\n") for column in columns]
    widths = _widths(heads, texts)
    loose = max((i for i in range(len(columns)) if not numeric[i]), default=None)
    excess = _total(widths) - console.width
    if loose is not None and excess > 0:
        # words are not broken, and what stands beside them stays in line
        longest = max((len(word) for row in texts for word in row[loose].split()), default=0)
        widths[loose] = max(widths[loose] - excess, min(_NARROWEST, widths[loose]), longest)

    if title:
        say(console, title, "bold")
    depth = max((len(head) for head in heads), default=0)
    for i in range(depth):
        # heads stand on the line below them
        cells = [head[i - depth + len(head)] if i >= depth - len(head) else "" for head in heads]
        say(console, _line(cells, widths, numeric), "bold")
    say(console, ("─" if console.is_terminal else "-") * min(_total(widths), console.width), "dim")
    for row in texts:
        wrapped = list(row)
        more: list[str] = []
        if loose is not None:
            width = max(widths[loose], 1)  # a column may be empty, head and all
            parts = textwrap.wrap(row[loose], width, break_long_words=False, break_on_hyphens=False)
            wrapped[loose], more = (parts[0], parts[1:]) if parts else ("", [])
        say(console, _line(wrapped, widths, numeric))
        for part in more:
            say(console, _line([part if i == loose else "" for i in range(len(row))], widths, numeric))
    console.print()


def print_sweep(result: SweepResult, folder: Path | None = None, *, console: Console | None = None) -> None:
    """Print the end of a sweep: the verdict, the best rows beside their prediction, flags, and the report.

    Args:
        result: the sweep.
        folder: where its report.html is; nothing is said about it when None.
        console: where to; standard output by default.
    """
    from rigsim.present.axes import swept_axes
    from rigsim.present.measured import equivalent_noise_words
    from rigsim.present.same import at_same_distances, same_words

    console = console or make_console()
    axes = swept_axes(result)
    rows = result.rows
    places = list(result.best[:_MOST_BEST]) or list(range(min(len(rows), _MOST_BEST)))
    paragraph(console, result.verdict.headline, style="bold")
    for sentence in result.verdict.sentences:
        paragraph(console, sentence, "  ")
    console.print()

    same = same_words(result)
    best = (at_same_distances(result) if same else rows).iloc[places]
    varied = [axis for axis in axes if best[axis.column].nunique() > 1] or axes[:1]
    shared = [axis for axis in axes if axis not in varied]
    title = f"Best {len(places)} of {count(len(rows))}" if len(rows) > len(places) else "Result"
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
    noise = equivalent_noise_words(rows.iloc[places[0]])
    if noise and not any("--noise" in sentence for sentence in result.verdict.sentences):
        paragraph(console, noise)
        console.print()
    _print_flags(result, console, axes)
    if folder is not None:
        say(console, f"Report: {folder / 'report.html'}", "bold")


def paragraph(console: Console, text: str, indent: str = "", *, style: str = "") -> None:
    """Print prose, wrapped between words; code marks are for pages, not for terminals."""
    lines = textwrap.wrap(
        text.replace("`", ""),
        max(console.width, 20),
        initial_indent=indent,
        subsequent_indent=indent,
        break_long_words=False,
        break_on_hyphens=False,
    )
    for line in lines:
        say(console, line, style)


def say(console: Console, text: str, style: str = "") -> None:
    """Print one line as it is: what is too long, such as a path, is left to the terminal."""
    console.print(Text(text, style=style), soft_wrap=True)


@dataclass(frozen=True, slots=True)
class _Column:
    head: str
    cells: tuple[str, ...]
    numeric: bool
    importance: int


def _sweep_columns(
    result: SweepResult, best: pd.DataFrame, axes: list[Axis], places: list[int]
) -> list[_Column]:
    columns = [
        _Column(
            f"{axis.heading}\n{axis.unit}".rstrip(), tuple(map(axis.show, best[axis.column])), axis.numeric, 9
        )
        for axis in axes
    ]
    agreement = tuple(map(kind_of, best["agreement"]))
    return [
        *columns,
        _Column("simulated\nRMS, mm", tuple(map(number, best["depth_rmse_mm"])), True, 9),
        _Column("predicted\nRMS, mm", tuple(map(number, best["predicted_depth_rmse_mm"])), True, 5),
        _Column("predicted/\nsimulated", tuple(map(ratio, best["predicted_over_simulated"])), True, 3),
        _Column("seen by\nboth, %", tuple(map(percent, best["visible_fraction"])), True, 2),
        _Column("limited by", tuple(result.limits[place] for place in places), False, 4),
        *_measured_columns(best),
        _Column("agreement", agreement, False, 9),
    ]


def _measured_columns(best: pd.DataFrame) -> list[_Column]:
    """What the third witness says, when there is one."""
    from rigsim.present.measured import was_measured

    if not was_measured(best):
        return []
    return [
        _Column("measured\nRMS, mm", tuple(map(number, best["measured_depth_rmse_mm"])), True, 8),
        _Column("measured/\npredicted", tuple(map(ratio, best["measured_over_predicted"])), True, 7),
    ]


def _fitting(columns: list[_Column], width: int) -> list[_Column]:
    """The columns without the least important ones that a line of `width` has no room for."""
    columns = list(columns)
    while min(column.importance for column in columns) < 9:
        heads = [column.head.split("\n") for column in columns]
        widths = _widths(heads, list(zip(*(column.cells for column in columns), strict=True)))
        if _total(widths) <= width:
            break
        columns.remove(min(columns, key=lambda column: column.importance))
    return columns


def _print_flags(result: SweepResult, console: Console, axes: list[Axis]) -> None:
    rows = result.rows
    flagged = rows[rows["agreement"].map(kind_of) == "flagged"]
    if not len(flagged):
        return
    say(console, f"Flagged: {count(len(flagged))} of {count(len(rows))}", "bold yellow")
    for record in flagged.head(_MOST_REASONS).to_dict("records"):
        row: dict[Any, Any] = record
        where = ", ".join(f"{axis.heading} {axis.say(row[axis.column])}" for axis in axes)
        why = reason_of(str(row["agreement"]))
        paragraph(console, f"{where}: {why}" if where else why, "  ")
    if len(flagged) > _MOST_REASONS:
        say(console, f"  and {count(len(flagged) - _MOST_REASONS)} more, listed in the report")
    console.print()


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) or bool(isinstance(value, str) and _NUMBER.fullmatch(value))


def _widths(heads: Sequence[Sequence[str]], rows: Sequence[Sequence[str]]) -> list[int]:
    return [
        max([cell_len(part) for part in head] + [cell_len(row[i]) for row in rows])
        for i, head in enumerate(heads)
    ]


def _total(widths: Sequence[int]) -> int:
    return sum(widths) + _GAP * max(len(widths) - 1, 0)


def _line(cells: Sequence[str], widths: Sequence[int], numeric: Sequence[bool]) -> str:
    parts = []
    for cell, width, right in zip(cells, widths, numeric, strict=True):
        room = " " * max(width - cell_len(cell), 0)
        parts.append(room + cell if right else cell + room)
    return (" " * _GAP).join(parts).rstrip()
