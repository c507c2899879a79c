"""Whether what was measured is as good as it claims: a robust scale of error over claim, with its interval.

The scale is that within which nine of ten errors lie, over where the claim puts it: 1 when the claim holds,
whatever the worst tenth does. Its interval is made of order statistics, so it assumes nothing of the
errors' shape; few points make it wide.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import bdtr, bdtrc, chdtri

from rigsim.rig.arrays import Array
from rigsim.study.agreement.agreement import AGREES, Agreement, Reason, finite
from rigsim.study.scene import columns as col
from rigsim.study.scene.columns import Row

SHARE = 0.9
"""The share of the errors that the scale speaks of."""

BAND = (2 / 3, 3 / 2)
"""Scales that are agreement; the whole interval must lie inside."""

CONFIDENCE = 0.99
"""Of the interval."""

_ASTRAY = 0.2  # share of matches of nothing that is too much


@dataclass(frozen=True, slots=True)
class Scale:
    """Error over claim."""

    value: float
    """The scale; 1 when the claim holds."""
    low: float
    """Lower end of its interval; 0 when there are too few for one."""
    high: float
    """Upper end; infinite when there are too few for one."""


def claim_scale(distance2: Array, degrees: int) -> Scale:
    """The scale of squared errors over their claimed variance, (N,), of `degrees` degrees of freedom.

    Interval (David & Nagaraja, "Order Statistics", 7.1): with N errors the number below the true quantile
    is binomial.
    """
    unit = float(chdtri(degrees, 1 - SHARE))
    # an error where none is claimed is infinitely large
    found = np.sqrt(np.sort(np.nan_to_num(distance2, nan=math.inf, posinf=math.inf)) / unit)
    n = len(found)
    below = bdtr(np.arange(n), n, SHARE)  # that at most so many lie below the quantile
    tail = (1 - CONFIDENCE) / 2
    first = int(np.searchsorted(below, tail, side="right"))
    last = int(np.searchsorted(below, 1 - tail, side="left"))
    return Scale(
        float(found[math.ceil(SHARE * n) - 1]),
        float(found[first - 1]) if first > 0 else 0.0,
        float(found[last]) if last < n else math.inf,
    )


def scale_columns(scales: Sequence[Scale]) -> Row:
    """The columns of the largest of several scales."""
    scale = max(scales, key=lambda one: one.value)
    return {
        col.MEASURED_SCALE: scale.value,
        col.MEASURED_SCALE_CI_LOW: scale.low,
        col.MEASURED_SCALE_CI_HIGH: scale.high,
    }


def measured_agreement(row: Row, n_found: int, cause: str) -> Agreement:
    """Whether the measurement of a row is as good as it says.

    Args:
        row: with the measured columns.
        n_found: matches, those of nothing included.
        cause: the error for which nothing was found, when nothing was.
    """
    if row[col.MEASURED_METHOD] == "none":
        return AGREES
    n = int(row[col.MEASURED_N])
    n_astray = n_found - n
    share = n_astray / n_found if n_found else 0.0
    # probability of so many when a fifth of all go astray
    if n_astray and float(bdtrc(n_astray - 1, n_found, _ASTRAY)) <= (1 - CONFIDENCE) / 2:
        return Agreement("flagged", "measured", "outliers", "outliers", share, count=(n_astray, n_found))
    if n == 0:
        return Agreement("untold", "measured", "nothing-measured", "scale", cause=cause)
    ends = (col.MEASURED_SCALE, col.MEASURED_SCALE_CI_LOW, col.MEASURED_SCALE_CI_HIGH)
    value, low, high = (float(row[name]) for name in ends)
    reason = _claim(row, Scale(value, low, high), share)
    if not reason:
        return AGREES
    return Agreement(
        "flagged" if reason == "worse-than-claimed" else "untold",
        "measured",
        reason,
        "scale",
        finite(value),
        None if math.isnan(low + high) else (low, high),
        count=(n_astray, n_found) if reason == "many-astray" else (n, n_found),
    )


def _claim(row: Row, scale: Scale, astray: float) -> Reason:
    """What keeps the claim of points that were measured from being confirmed; empty when nothing does."""
    if scale.low > BAND[1]:
        return "worse-than-claimed"
    if not math.isfinite(scale.high):
        return "too-few-measured"
    if row[col.MEASURED_METHOD] == "dense":
        return "claims-nothing"
    if astray > _ASTRAY:
        return "many-astray"
    if scale.high < BAND[0]:
        return "too-cautious"
    return "" if BAND[0] <= scale.low and scale.high <= BAND[1] else "unclear"
