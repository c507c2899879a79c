"""Golden results in a terminal: what moved, by how much, and whether that is more than noise."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING

from rigsim.present.kit.console import make_console, paragraph, print_table, say
from rigsim.study.golden.compare import VERDICTS, GoldenReport, GoldenValue, Move

if TYPE_CHECKING:
    from rich.console import Console

_HEADS = ("file", "number", "golden", "now", "change", "may differ by", "verdict")
_MOST = 20
_FEWEST, _MOST_DIGITS = 3, 10
_SHOWN = ("moved", "gone")


def print_golden(report: GoldenReport, *, console: Console | None = None) -> None:
    """Print the counts, what moved, and what could not be read."""
    console = console or make_console()
    comparison = report.comparison
    for trouble in report.troubles:
        paragraph(console, f"{'Note' if report.written else 'Unreadable'}: {trouble}.")
    for remark in comparison.remarks:
        paragraph(console, f"Note: {remark}.")
    paragraph(console, f"Golden results of {report.folder}: {_counts(report)}.", style="bold")
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
        say(console, written_words(report), "bold")


def written_words(report: GoldenReport) -> str:
    """What was written, one sentence."""
    n = len(report.written)
    place = f"into {report.folder}" if report.written[0] != report.folder else report.folder
    if place == report.folder:
        return f"Wrote golden file {place}."
    return f"Wrote {n} golden file{'s' if n != 1 else ''} {place}."


def golden_text(report: GoldenReport) -> str:
    """What moved and what is gone, a line each; for the message of a failed test."""
    lines = [f"golden results of {report.folder}: {_counts(report)}", *report.comparison.remarks]
    moves = [move for verdict in _SHOWN for move in report.comparison.moves if move.verdict == verdict]
    for move in moves[:_MOST]:
        _, name, before, now, change, bound, verdict = _row(move)
        off = f", off by {change}, may differ by {bound}" if change != "–" else ""
        lines.append(f"  {verdict}: {name}: was {before}, now {now}{off}")
    if len(moves) > _MOST:
        lines.append(f"  and {len(moves) - _MOST} more")
    return "\n".join(lines)


def _counts(report: GoldenReport) -> str:
    count = report.comparison.count
    return ", ".join(f"{count(one)} {one}" for one in VERDICTS if count(one)) or "none to compare with"


def _row(move: Move) -> tuple[str, ...]:
    before, now = move.before, move.now
    change = math.nan if isinstance(before, str) or isinstance(now, str) else now - before
    return (
        move.record,
        move.number,
        _figure(before, move.unit, change),
        _figure(now, move.unit, change),
        _figure(change, move.unit, change),
        _figure(move.bound, move.unit, move.bound),
        move.verdict,
    )


def _figure(value: GoldenValue, unit: str, change: float) -> str:
    """A value with as many digits as show the change."""
    if isinstance(value, str):
        return value
    if not math.isfinite(value):
        return "–" if math.isnan(value) else "infinite"
    digits = _FEWEST
    if value and change and math.isfinite(change):
        size = math.floor(math.log10(abs(value)))
        shown = size - math.floor(math.log10(abs(change))) + 2
        digits = min(max(_FEWEST, shown, size + 1 if size < _MOST_DIGITS else 0), _MOST_DIGITS)
    return f"{value:#.{digits}g}".rstrip(".") + (f" {unit}" if unit else "")
