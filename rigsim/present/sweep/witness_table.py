"""The three witnesses of one configuration side by side, in words and numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rigsim.present.kit import agreement
from rigsim.present.kit.format import count, length_mm, number, plain, ratio
from rigsim.present.sweep.measured_words import found_words, method_words
from rigsim.present.sweep.tables import Row, Table
from rigsim.study.agreement.agreement import Agreement, Witness
from rigsim.study.sweep.result import SweepResult

_NONE = "–"


def witness_table(result: SweepResult) -> Table:
    """What each witness of the rig on show stands for, its error, its ratio and whether it agrees."""
    row: Mapping[Any, Any] = result.rows.iloc[result.showcase.row]
    noise = f"{plain(row['noise_px'])} px, given"
    seen = count(row["n_visible"])
    found = row["measured_n"] > 0
    method = method_words(row)
    equivalent = f"{number(row['measured_disparity_std_px'] / 2**0.5, 2)} px, found" if found else _NONE
    lines = (
        (
            "What it is",
            "closed formulas for what pixel noise does to depth; no picture",
            "exact projections of points in the scene, disturbed by pixel noise and triangulated",
            f"{method} found in both rendered pictures and triangulated; the truth is joined afterwards",
        ),
        ("Points", seen, f"{seen} × {count(row['n_trials'])} trials", found_words(row)),
        ("Pixel noise", noise, noise, equivalent),
        (
            "Depth error RMS",
            length_mm(row["predicted_depth_rmse_mm"]),
            length_mm(row["depth_rmse_mm"]),
            length_mm(row["measured_depth_rmse_mm"]),
        ),
        (
            "Its prediction",
            _NONE,
            length_mm(row["predicted_depth_rmse_mm"]),
            length_mm(row["predicted_from_measured_rmse_mm"]),
        ),
        (
            "Ratio",
            _NONE,
            f"{ratio(row['predicted_over_simulated'])} predicted / simulated",
            f"{ratio(row['measured_over_predicted'])} measured / predicted" if found else _NONE,
        ),
        (
            "Verdict",
            _NONE,
            _said(row, "simulated"),
            _said(row, "measured"),
        ),
    )
    headings = (("", ""), ("Predicted", ""), ("Simulated", ""), ("Measured", ""))
    return Table(headings, (False,) * 4, tuple(Row(line) for line in lines))


def _said(row: Mapping[Any, Any], witness: Witness) -> str:
    """What is said of one witness: the row's reason when it speaks of it."""
    found: Agreement = row["agreement"]
    if found.kind != "agrees" and found.witness in (witness, ""):
        return {"flagged": "⚠ ", "untold": "? "}[found.kind] + agreement.text(found)
    if witness == "measured" and not row["measured_n"] > 0:
        return "nothing found"
    # a row says the worst of its witnesses: a flagged one leaves the other unsaid
    return _NONE if found.kind == "flagged" and witness == "measured" else "✓ agrees"
