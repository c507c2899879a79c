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
from rigsim.study.agreement.agreement import AGREES, Agreement
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
        "measured_scale": scale.value,
        "measured_scale_ci_low": scale.low,
        "measured_scale_ci_high": scale.high,
    }


def measured_agreement(row: Row, n_found: int, why: str) -> Agreement:
    """Whether the measurement of a row is as good as it says.

    Args:
        row: with the measured columns.
        n_found: matches, those of nothing included.
        why: why nothing was found, when nothing was.
    """
    if row["measured_method"] == "none":
        return AGREES
    n = int(row["measured_n"])
    n_astray = n_found - n
    share = n_astray / n_found if n_found else 0.0
    # probability of so many when a fifth of all go astray
    if n_astray and float(bdtrc(n_astray - 1, n_found, _ASTRAY)) <= (1 - CONFIDENCE) / 2:
        said = f"{share * 100:.2g} % of what was measured is not what both cameras see"
        return Agreement("flagged", "measured", "outliers", share, said)
    if n == 0:
        return _untold(f"nothing was measured ({why or 'no match of what both cameras see'})")
    value, low, high = (float(row[f"measured_scale{end}"]) for end in ("", "_ci_low", "_ci_high"))
    scale = Scale(value, low, high)
    if scale.low > BAND[1]:
        said = f"measured errors are {scale.value:.2g} times what they claim"
        return Agreement("flagged", "measured", "scale", scale.value, said)
    if not math.isfinite(scale.high):
        return _untold(f"{n} measured points are too few", scale.value)
    if row["measured_method"] == "dense":
        return _untold("dense matching claims no accuracy that its measured error could be held to")
    if share > _ASTRAY:
        return _untold(f"of {n_found} measured points {n_astray} are not what both cameras see")
    said = f"measured errors are {scale.value:.2g} times what they claim"
    if scale.high < BAND[0]:
        return _untold(f"{said}: too cautious a claim to confirm", scale.value)
    if BAND[0] <= scale.low and scale.high <= BAND[1]:
        return AGREES
    said += f" ({scale.low:.2g} to {scale.high:.2g}), not clearly within {BAND[0]:.2g} to {BAND[1]:.2g}"
    return _untold(said, scale.value)


def _untold(why: str, ratio: float = math.nan) -> Agreement:
    return Agreement("untold", "measured", "scale", ratio, why)
