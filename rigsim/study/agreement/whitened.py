"""What the simulated errors of some points must be when the prediction is right, as tests with a p-value.

All are on the errors of ``(1/Z, X/Z, Y/Z)`` (`rigsim.study.agreement.views`), whitened by their predicted
covariance: N(predicted bias, I), independent over points and trials. In any group of points their squares
sum to a chi-squared, and their sum is Gaussian.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.special import gammainc, gammaincc, ndtr

from rigsim.rig.arrays import Array, Mask
from rigsim.study.scene.statistics import ErrorStatistics
from rigsim.study.scene.trials import Prediction

INEFFICIENCY = 0.02
"""Relative excess of scatter over the best possible that is inefficiency of a method, not disagreement."""


@dataclass(frozen=True, slots=True, eq=False)
class Whitened:
    """Sums of whitened errors over the trials of each point, and what may excuse their mean."""

    count: Array
    """Trials."""
    mean: Array
    """Sum over trials, minus the predicted bias, (N, 3); depth first."""
    slack: Array
    """What the mean may be off by in each trial: half the predicted bias, and failures, (N, 3)."""
    depth_square: Array
    """Sum of squares of the first."""
    square: Array
    """Sum of squares of all three."""
    sigmas: Array
    """Z / sigma_Z."""
    rounding: float
    """Share of the variance that repeats in every trial."""


@dataclass(frozen=True, slots=True)
class WhitenedFinding:
    """One test of one group."""

    quantity: str
    """What was tested."""
    p: float
    """Probability of it, or more, when prediction is right."""
    sigmas: float
    """How far off it is, in standard errors."""
    ratio: float
    """Found over expected spread; NaN for a mean."""


def whitened(prediction: Prediction, stats: ErrorStatistics, kept: Mask) -> Whitened:
    """Whiten the sums of the visible points in `kept` (N,)."""
    w00, w10, w11, w20, w21, w22 = prediction.whitening[:, kept]

    def whiten(q0: Array, q1: Array, q2: Array) -> Array:
        return np.column_stack([w00 * q0, w10 * q0 + w11 * q1, w20 * q0 + w21 * q1 + w22 * q2])

    count, sigmas = stats.count[kept], prediction.depth_sigmas[kept]
    bias = whiten(*prediction.view_bias[kept].T)
    slack = 0.5 * np.abs(bias)
    slack[:, 0] += _density(sigmas)  # trials beyond infinity fail: the rest has this mean
    return Whitened(
        count=count,
        mean=whiten(*stats.sum_view[:, kept]) - count[:, None] * bias,
        slack=slack,
        depth_square=stats.sum_depth_w2[kept],
        square=stats.sum_nees[kept],
        sigmas=sigmas,
        rounding=prediction.rounding,
    )


def examine(sums: Whitened, inside: Mask) -> Iterator[WhitenedFinding]:
    """The five tests of one group of points."""
    count = sums.count[inside]
    n = float(count.sum())
    r = sums.rounding
    # a rounding error is the same in all trials of a point
    repeats = float((count**2).sum()) * r * r + n * (1 - r * r)
    lost = float((count * sums.sigmas[inside] * _density(sums.sigmas[inside])).sum()) / n
    for quantity, square, degrees in (
        ("depth spread", sums.depth_square, 1),
        ("position spread", sums.square, 3),
    ):
        ratio2 = float(square[inside].sum()) / n / degrees
        yield _spread(quantity, ratio2, degrees * n * n / repeats, lost / degrees + r, r)
    error = math.sqrt(float((count**2).sum()) * r + n * (1 - r))
    total = sums.mean[inside].sum(axis=0)
    slack = (count[:, None] * sums.slack[inside]).sum(axis=0)
    for axis, quantity in enumerate(("mean depth", "mean position across", "mean position down")):
        z = max(abs(float(total[axis])) - float(slack[axis]), 0.0) / error
        yield WhitenedFinding(quantity, _two_sided(z), z, math.nan)


def point_by_point(sums: Whitened) -> WhitenedFinding:
    """Whether the points' own means scatter as their trials allow: any field of mean errors shows here."""
    tried = sums.count > 0
    count = sums.count[tried]
    found = float(((sums.mean[tried] ** 2).sum(axis=1) / count).sum())
    expected = float((3 * (1 + (count - 1) * sums.rounding)).sum())
    excused = float((count[:, None] * sums.slack[tried] ** 2).sum()) / expected
    degrees = 3.0 * len(count)
    return _spread("mean error, point by point", found / expected, degrees, math.inf, excused + sums.rounding)


def _spread(quantity: str, ratio2: float, degrees: float, below: float, above: float) -> WhitenedFinding:
    """Mean square over its expectation against chi-squared; `below` and `above` are excused."""
    above += (1 + INEFFICIENCY) ** 2 - 1
    high, low = ratio2 / (1 + above), ratio2 / max(1 - below, 0.0) if below < 1 else math.inf
    upper = float(gammaincc(degrees / 2, degrees * high / 2))
    lower = float(gammainc(degrees / 2, degrees * low / 2))
    off = max(high - 1, 1 - low, 0.0) * math.sqrt(degrees / 2)
    return WhitenedFinding(quantity, min(2 * min(upper, lower), 1.0), off, math.sqrt(ratio2))


def _density(sigmas: Array) -> Array:
    return np.asarray(np.exp(-(sigmas**2) / 2) / math.sqrt(2 * math.pi))


def _two_sided(z: float) -> float:
    return 2 * float(ndtr(-z))
