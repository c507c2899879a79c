"""Golden results in a terminal: what moved, by how much, and whether that is more than noise."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING

from rigsim.present.kit.console import make_console, paragraph, print_table, say
from rigsim.present.verify.words import amount
from rigsim.study.verify.golden import VERDICTS, GoldenReport, Move

if TYPE_CHECKING:
    from rich.console import Console

_HEADS = ("file", "number", "golden", "now", "change", "may differ by", "verdict")
_MOST = 20
_SHOWN = ("moved", "gone")


def print_golden(report: GoldenReport, *, console: Console | None = None) -> None:
    """Print the counts, what moved, and what could not be read."""
    console = console or make_console()
    comparison = report.comparison
    for trouble in report.troubles:
        paragraph(console, f"Unreadable: {trouble}.")
    for remark in comparison.remarks:
        paragraph(console, f"Note: {remark}.")
    counts = ", ".join(
        f"{comparison.count(verdict)} {verdict}" for verdict in VERDICTS if comparison.count(verdict)
    )
    paragraph(
        console, f"Golden results of {report.folder}: {counts or 'none to compare with'}.", style="bold"
    )
    moves = [move for verdict in _SHOWN for move in comparison.moves if move.verdict == verdict]
    new = Counter(move.record for move in comparison.moves if move.verdict == "new")
    if new and not report.written:
        paragraph(
            console, "Without a golden value: " + ", ".join(f"{n} of {name}" for name, n in new.items())
        )
    if moves:
        console.print()
        print_table(
            "",
            _HEADS,
            [_row(move) for move in moves[:_MOST]],
            numeric=(False, False, True, True, True, True, False),
            console=console,
        )
        if len(moves) > _MOST:
            say(console, f"and {len(moves) - _MOST} more.")
    if report.written:
        n = len(report.written)
        say(console, f"Wrote {n} golden file{'s' if n != 1 else ''} into {report.folder}.", "bold")


def _row(move: Move) -> tuple[str, ...]:
    change = move.now - move.before
    return (
        move.record,
        move.number,
        amount(move.before, move.unit),
        amount(move.now, move.unit),
        amount(change, move.unit) if math.isfinite(change) else "–",
        amount(move.bound, move.unit),
        move.verdict,
    )
