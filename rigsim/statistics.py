"""What errors amount to: root mean square, robust spread, quantiles. Every number of no errors is NaN."""

from __future__ import annotations

import math

import numpy as np

from rigsim.rig.arrays import Array

NORMAL_MAD = 1.4826
"""Standard deviation over median absolute deviation of a normal distribution, rounded as is the custom."""


def rms(errors: Array) -> float:
    """Root mean square of all errors."""
    return math.sqrt(float(np.mean(errors**2))) if errors.size else math.nan


def robust_rms(errors: Array) -> float:
    """Root mean square of normal errors by their median absolute value, which outliers do not move."""
    return NORMAL_MAD * float(np.median(np.abs(errors))) if errors.size else math.nan


def nmad(errors: Array) -> float:
    """Normalised median absolute deviation from the median: a standard deviation that outliers do not move.

    Source: Hoehle & Hoehle, "Accuracy assessment of digital elevation models by means of robust statistical
    methods", ISPRS Journal 64 (2009).
    """
    return robust_rms(errors - np.median(errors)) if errors.size else math.nan


def abs_p95(errors: Array) -> float:
    """95th percentile of the absolute errors."""
    return float(np.quantile(np.abs(errors), 0.95)) if errors.size else math.nan


def inner_range(values: Array, left_out: float = 0.01) -> tuple[float, float]:
    """The range of all finite values but a share `left_out` at either end."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return math.nan, math.nan
    low, high = np.quantile(finite, (left_out, 1 - left_out))
    return float(low), float(high)
