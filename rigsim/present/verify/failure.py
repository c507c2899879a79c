"""Why a triangulator failed, as plain text: what a test runner prints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigsim.present.verify import words
from rigsim.rig.arrays import Array
from rigsim.study.verify.result import CaseResult, TriangulatorResult
from rigsim.study.verify.worst import WorstRow, worst_rows

_MOST_CASES = 8
_MOST_ROWS = 4


def failure_text(result: TriangulatorResult, strict: bool = False) -> str:
    """Verdict, failing cases with what was found and allowed, the worst rows, and the diagnosis.

    Fits 100 columns where the names do.
    """
    failed = [case for case in result.results if case.status(strict) in ("failed", "error")]
    worst = sorted(failed, key=lambda case: case.case.kind != "exact")  # exact pixels say most plainly
    rows = [(case, row) for case in worst for row in worst_rows(case, 1)][:_MOST_ROWS]
    parts = [words.verdict(result, strict), _cases(worst, strict)]
    if rows:
        parts.append(_rows(rows))
    parts.extend(f"Diagnosis: {words.diagnosis(one)}" for one in result.diagnoses[:2])
    return "\n\n".join(parts)


def _cases(failed: Sequence[CaseResult], strict: bool) -> str:
    table = [("case", "found", "allowed", "what")]
    for result in failed[:_MOST_CASES]:
        if result.error:
            table.append((result.case.name, "error", "", result.error))
            continue
        bad = {check.name: check for check in result.failures(strict)}
        check = bad.get("exact") or next(iter(bad.values()))  # a distance says more than a count
        means = words.MEANS.get(check.name, check.name)
        table.append((result.case.name, words.found(check), words.allowed(check), means))
    text = _table(table)
    more = len(failed) - _MOST_CASES
    return f"{text}\n... and {more} more cases" if more > 0 else text


def _rows(rows: Sequence[tuple[CaseResult, WorstRow]]) -> str:
    table = [("worst row of", "uv_left (px)", "uv_right (px)", "expected (m)", "found (m)")]
    table.extend(
        (
            f"{result.case.name} [{row.row}]",
            _numbers(row.uv_left, 1),
            _numbers(row.uv_right, 1),
            _numbers(row.expected_left, 3),
            _numbers(row.found_left, 3),
        )
        for result, row in rows
    )
    return _table(table)


def _table(rows: Sequence[tuple[str, ...]]) -> str:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    )


def _numbers(values: Array, digits: int) -> str:
    if not np.isfinite(values).any():
        return "nothing"
    return " ".join(f"{value:.{digits}f}" if abs(value) < 1e5 else f"{value:.1e}" for value in values)
