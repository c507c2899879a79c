"""The rows of a sweep at the same distances: what a picture or a table may set side by side."""

from __future__ import annotations

import numpy as np
import pandas as pd

from rigsim.present.sweep.phrases import distances
from rigsim.study.scene import columns as col
from rigsim.study.sweep.comparison import Comparison, compare
from rigsim.study.sweep.result import SweepResult


def comparison_of(result: SweepResult) -> Comparison:
    """The depth error of the rows at the distances that they share."""
    return compare(result.rows, result.by_depth)


def at_same_distances(result: SweepResult) -> pd.DataFrame:
    """`SweepResult.rows` with the simulated and the predicted depth error at the same distances, per pixel.

    NaN where a row does not answer them all. What was measured stays what it is: each row's own matches.
    """
    found = comparison_of(result)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = found.predicted_mm / found.simulated_mm
    same = {
        col.DEPTH_RMSE: found.simulated_mm,
        col.DEPTH_RMSE_CI_LOW: found.ci_low_mm,
        col.DEPTH_RMSE_CI_HIGH: found.ci_high_mm,
        col.PREDICTED_DEPTH_RMSE: found.predicted_mm,
        col.PREDICTED_OVER_SIMULATED: np.where(np.isfinite(ratio) & (ratio > 0), ratio, np.nan),
    }
    return result.rows.assign(**same)


def same_words(result: SweepResult) -> str:
    """The distances, and how many rows do not answer them; empty when the rows have none in common."""
    found = comparison_of(result)
    if not found.spans_mm:
        return ""
    missing = int((result.rows[col.DEPTH_RMSE].notna() & ~found.compared).sum())
    rows = "row does" if missing == 1 else "rows do"
    return f"at {distances(found.spans_mm)}, per pixel" + (
        f"; {missing} {rows} not cover them" if missing else ""
    )
