"""Whether a triangulator stays within noise of the bound, in all rows of a comparison together."""

from __future__ import annotations

import pandas as pd

from rigsim.study.compare import columns as col
from rigsim.study.compare.run import ComparisonResult

_ERROR = 0.05
"""Probability that any row of a triangulator at the bound is called off it."""


def quantile(result: ComparisonResult) -> float:
    """How many standard errors a row may be off, so that all rows together hold with 95 %."""
    from scipy.stats import norm

    return float(norm.isf(_ERROR / 2 / max(len(result.rows), 1)))


def off_bound(result: ComparisonResult) -> pd.Series[bool]:
    """Whether a row's pixel error is farther from the bound than noise takes it; True without a number."""
    rows = result.rows
    return ~((rows[col.PIXEL_ERROR_OVER_BOUND] - 1).abs() <= quantile(result) * rows[col.BOUND_SE])
