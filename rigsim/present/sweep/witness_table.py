"""The three witnesses of one configuration side by side, in words and numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rigsim.present.kit import agreement
from rigsim.present.kit.format import count, length_mm, number, plain, ratio
from rigsim.present.sweep.measured_words import found_words, method_words
from rigsim.present.sweep.tables import PageTable, TableRow
from rigsim.study.agreement.agreement import Agreement, Witness
from rigsim.study.scene import columns as col
from rigsim.study.sweep.result import SweepResult

_NONE = "–"


def witness_table(result: SweepResult) -> PageTable:
    """What each witness of the rig on show stands for, its error, its ratio and whether it agrees."""
    row: Mapping[Any, Any] = result.rows.iloc[result.showcase.row]
    noise = f"{plain(row[col.NOISE])} px, given"
    seen = count(row[col.N_VISIBLE])
    found = row[col.MEASURED_N] > 0
    method = method_words(row)
    equivalent = f"{number(row[col.MEASURED_DISPARITY_STD] / 2**0.5, 2)} px, found" if found else _NONE
    lines = (
        (
            "What it is",
            "closed formulas for what pixel noise does to depth; no picture",
            "exact projections of points in the scene, disturbed by pixel noise and triangulated",
            f"{method} found in both rendered pictures and triangulated; the truth is joined afterwards",
        ),
        ("Points", seen, f"{seen} × {count(row[col.N_TRIALS])} trials", found_words(row)),
        ("Pixel noise", noise, noise, equivalent),
        (
            "Depth error RMS",
            length_mm(row[col.PREDICTED_DEPTH_RMSE]),
            length_mm(row[col.DEPTH_RMSE]),
            length_mm(row[col.MEASURED_DEPTH_RMSE]),
        ),
        (
            "Its prediction",
            _NONE,
            length_mm(row[col.PREDICTED_DEPTH_RMSE]),
            length_mm(row[col.PREDICTED_FROM_MEASURED_RMSE]),
        ),
        (
            "Ratio",
            _NONE,
            f"{ratio(row[col.PREDICTED_OVER_SIMULATED])} predicted / simulated",
            f"{ratio(row[col.MEASURED_OVER_PREDICTED])} measured / predicted" if found else _NONE,
        ),
        (
            "Verdict",
            _NONE,
            _said(row, "simulated"),
            _said(row, "measured"),
        ),
    )
    headings = (("", ""), ("Predicted", ""), ("Simulated", ""), ("Measured in renderings", ""))
    return PageTable(headings, (False,) * 4, tuple(TableRow(line) for line in lines))


def _said(row: Mapping[Any, Any], witness: Witness) -> str:
    """What is said of one witness: the row's reason when it speaks of it."""
    found: Agreement = row[col.AGREEMENT]
    if found.kind != "agrees" and found.witness in (witness, ""):
        return {"flagged": "⚠ ", "untold": "? "}[found.kind] + agreement.text(found)
    if witness == "measured" and not row[col.MEASURED_N] > 0:
        return "nothing found"
    # a row says the worst of its witnesses: a flagged one leaves the other unsaid
    return _NONE if found.kind == "flagged" and witness == "measured" else "✓ agrees"
