"""Standard deviations of depth to disparity noise: one a distance, then all together, then their law."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import special, stats

from rigsim.rig.arrays import Array
from rigsim.study.infer.random_effects import CONFIDENCE, NORMAL, Effects, random_effects

FEWEST = 3
"""Distances that a law can be tested with."""

Law = Literal["quadratic", "linear", "constant"]
FitVerdict = Literal["consistent", "inconsistent", "untested"]
IntervalFrom = Literal["samples", "fit", "none"]
_POWERS: dict[Law, float] = {"linear": 1.0, "constant": 0.0}
_STEPS = 50


@dataclass(frozen=True, slots=True)
class LawFit:
    """How three laws of distance fit, in logarithms, each with a free factor."""

    exponent: float
    """Power of the distance that fits best."""
    exponent_low: float
    """Lower end of its interval."""
    exponent_high: float
    """Upper end."""
    misfit: dict[Law, float]
    """Relative RMS difference between data and law; 0.1 is 10 %."""
    best: Law
    """Law of the least misfit."""
    verdict: FitVerdict
    """Inconsistent when the interval leaves the exponent of stereo noise out."""


@dataclass(frozen=True, slots=True)
class NoiseFit:
    """The noise behind all distances."""

    std_px: float
    """Standard deviation of the disparity, px."""
    low_px: float
    """Lower end of its interval; NaN where nothing says how sure it is."""
    high_px: float
    """Upper end."""
    interval_from: IntervalFrom
    """Chi-square of the counts, scatter between the distances, or no interval."""


def without_noise(means: Array, stds: Array, means_known: bool) -> tuple[Array, Array]:
    """Depths (N,) that disparities without noise give, and their relative noise squared, ``(sigma_d/d)^2``.

    Of ``Z = f B / (d + noise)`` with ``a = (sigma_d/d)^2`` the mean is ``Z0 (1 + a + 3 a^2)`` and the
    variance ``Z0^2 (a + 8 a^2 + 69 a^3)``: from `means` and `stds` back to Z0 and a. Where no mean was
    measured the distance itself is Z0.
    """
    steady, a = means, (stds / means) ** 2
    for _ in range(_STEPS):
        before, square = a, (stds / steady) ** 2
        # it grows faster than a straight line, so Newton's steps come down to the root
        a = np.maximum(a - (a + 8 * a**2 + 69 * a**3 - square) / (1 + 16 * a + 207 * a**2), 0.0)
        if means_known:
            steady = means / (1 + a + 3 * a**2)
        if (np.abs(a - before) <= 1e-15 * a).all():
            break
    return steady, a


def degrees_of_freedom(counts: Array, a: Array) -> Array:
    """What `counts` of depths are worth for a variance (N,).

    ``n - 1`` when normal; the tails of 1/d, whose fourth cumulant is 72 a of the variance squared, take
    the rest.
    """
    return np.asarray((counts - 1) / (1 + 36 * a))


def noise_fit(stds_px: Array, freedom: Array | None, more: float = 0.0) -> NoiseFit:
    """One disparity noise for the `stds_px` (N,) of single distances.

    With degrees of `freedom` (N,) that explain the scatter, pooled variances and chi-square; else the mean
    logarithm with the distances' own variance beside it. `more` is half the interval, relative, of what
    multiplies all of them alike.
    """
    effects = log_effects(stds_px, freedom)
    if freedom is not None and (effects is None or effects.between == 0):
        total = float(freedom.sum())
        std = math.sqrt(float((freedom * stds_px**2).sum()) / total)
        sides = (1 + CONFIDENCE) / 2, (1 - CONFIDENCE) / 2
        share = 1.0 if effects is None else effects.reach / NORMAL
        away = [share * 0.5 * math.log(total / float(stats.chi2.ppf(side, total))) for side in sides]
        how: IntervalFrom = "samples"
    elif effects is not None:
        std = math.exp(float(effects.values[0]))
        half = effects.half_width(0)
        away, how = [-half, half], "fit"
    else:
        return NoiseFit(math.exp(float(np.log(stds_px).mean())), math.nan, math.nan, "none")
    low, high = (std * math.exp(math.copysign(math.hypot(side, more), side)) for side in away)
    return NoiseFit(std, low, high, how)


def log_effects(stds_px: Array, freedom: Array | None) -> Effects | None:
    """The mean of ``ln sigma_d`` over the distances; None under three."""
    if len(stds_px) < FEWEST:
        return None
    return random_effects(np.ones((len(stds_px), 1)), *_logs(stds_px, freedom))


def _logs(stds_px: Array, freedom: Array | None) -> tuple[Array, Array | None]:
    """``ln sigma_d`` without the bias of a sample's logarithm, and its variances where counts tell them."""
    logs = np.log(stds_px)
    if freedom is None:
        return logs, None
    return logs - (special.digamma(freedom / 2) - np.log(freedom / 2)) / 2, special.polygamma(
        1, freedom / 2
    ) / 4


def smoothed_px(stds_px: Array, freedom: Array) -> Array:
    """Disparity noise (N,) px of each distance, drawn to the mean as far as its own sample is unsure."""
    effects = log_effects(stds_px, freedom)
    logs, variances = _logs(stds_px, freedom)
    assert variances is not None
    if effects is None:
        return np.full_like(stds_px, math.sqrt(float((freedom * stds_px**2).sum() / freedom.sum())))
    own = effects.between / (effects.between + variances)
    return np.asarray(np.exp(effects.values[0] + own * (logs - effects.values[0])))


def law_fit(depths: Array, stds: Array, stds_px: Array, freedom: Array | None) -> LawFit | None:
    """The exponent by regression in logarithms, and each law's misfit; None where nothing can be tested.

    The regression is of ``sigma_d`` on the distance, whose slope is zero for stereo noise of any rig; two
    more is the exponent of a rectified one.
    """
    logs_z = np.log(depths)
    if len(depths) < FEWEST or np.ptp(logs_z) < 1e-6:
        return None
    logs, variances = _logs(stds_px, freedom)
    fit = random_effects(np.column_stack([logs_z - logs_z.mean(), np.ones_like(logs_z)]), logs, variances)
    slope, reach = float(fit.values[0]), fit.half_width(0)
    weights = np.ones_like(logs_z) if freedom is None else freedom
    weights = weights / weights.sum()
    misfit: dict[Law, float] = {"quadratic": _misfit(np.log(stds_px), weights)}
    misfit |= {law: _misfit(np.log(stds) - power * logs_z, weights) for law, power in _POWERS.items()}
    # rounding alone separates claims that follow a law exactly
    outside = abs(slope) > reach + 1e-9
    return LawFit(
        2 + slope,
        2 + slope - reach,
        2 + slope + reach,
        misfit,
        min(misfit, key=lambda law: misfit[law]),
        "inconsistent" if outside else "consistent",
    )


def _misfit(residual: Array, weights: Array) -> float:
    away = residual - (weights * residual).sum()
    return float(np.sqrt((weights * np.expm1(np.abs(away)) ** 2).sum()))
