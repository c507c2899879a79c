"""A comparison in a terminal: one table at one noise level, and what all levels say in sentences."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rich.console import Console

from rigsim.present.compare.words import headline, sentences
from rigsim.present.kit.console import make_console, paragraph, print_table, say
from rigsim.present.kit.format import count, number, percent, plain, ratio, with_error
from rigsim.study.compare import columns as col
from rigsim.study.compare.run import ComparisonResult


def _head(name: str) -> str:
    column = col.COLUMNS[name]
    return f"{column.heading}\n{column.shown_unit}" if column.shown_unit else column.heading


HEADS = (
    _head(col.GEOMETRY),
    _head(col.TRIANGULATOR),
    _head(col.PIXEL_ERROR_OVER_BOUND),
    _head(col.PIXEL_ERROR_OVER_FIRST),
    "bias beyond\nexpected, σ",
    _head(col.FAILED_SHARE),
    _head(col.EXPECTED_FAILED_SHARE),
    "million\npoints/s",
    _head(col.SPEED_OVER_FIRST),
)
"""Columns of `table_rows`."""
NUMERIC = (False, False, *[True] * 7)
"""Which of them hold numbers."""
_LONGEST = 24


def print_comparison(
    result: ComparisonResult, folder: Path | None = None, *, console: Console | None = None
) -> None:
    """Print the table at the middle noise level, the conclusion, and what was left out.

    Args:
        result: the comparison.
        folder: where the report is; nothing is said about it when None.
        console: where to; standard output by default.
    """
    console = console or make_console()
    noise_px = shown_noise_px(result)
    rows = table_rows(result, noise_px)
    # a name is not said again below itself
    brief = [
        (row[0] if not place or rows[place - 1][0] != row[0] else "", _short(row[1]), *row[2:])
        for place, row in enumerate(rows)
    ]
    n = count(result.plan.n_points)
    print_table(f"{plain(noise_px)} px of noise, {n} points", HEADS, brief, numeric=NUMERIC, console=console)
    paragraph(console, headline(result), style="bold")
    for sentence in sentences(result):
        paragraph(console, sentence, "  ")
    for sentence in result.left_out:
        paragraph(console, f"Left out: {sentence}", "  ")
    if folder is not None:
        console.print()
        say(console, f"Report: {folder / 'compare.html'}", "bold")


def shown_noise_px(result: ComparisonResult) -> float:
    """The middle one of the noise levels."""
    levels = sorted(result.plan.noises_px)
    return levels[len(levels) // 2]


def table_rows(result: ComparisonResult, noise_px: float) -> list[tuple[str, ...]]:
    """The rows of one noise level as text; their columns are `HEADS`."""
    rows = result.rows[result.rows[col.NOISE] == noise_px]
    return [_row(record) for record in rows.to_dict("records")]


def _row(row: dict[Any, Any]) -> tuple[str, ...]:
    return (
        str(row[col.GEOMETRY]),
        str(row[col.TRIANGULATOR]),
        with_error(row[col.PIXEL_ERROR_OVER_BOUND], row[col.PIXEL_ERROR_OVER_BOUND_SE]),
        _factor(row[col.PIXEL_ERROR_OVER_FIRST]),
        with_error(row[col.DEPTH_BIAS] - row[col.EXPECTED_DEPTH_BIAS], row[col.DEPTH_BIAS_SE]),
        percent(row[col.FAILED_SHARE]),
        percent(row[col.EXPECTED_FAILED_SHARE]) if row[col.EXPECTED_FAILED_SHARE] > 5e-8 else "0",
        _speed(row[col.POINTS_PER_SECOND] / 1e6),
        _speed(row[col.SPEED_OVER_FIRST]),
    )


def _factor(value: float) -> str:
    return ratio(value) if value < 10 else number(value)


def _speed(value: float) -> str:
    """Two or three digits, the last ones being noise."""
    return plain(value, 2) if value < 10 else number(value, 2)


def _short(label: str) -> str:
    return label if len(label) <= _LONGEST else "…" + label[-_LONGEST + 1 :]
