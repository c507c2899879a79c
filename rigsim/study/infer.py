"""From depth errors at known distances back to the disparity noise behind them, and on to another rig.

A rig turns a disparity error of one standard deviation ``sigma_d`` into ``K(Z) sigma_d`` of depth, with
``K = Z^2/(f B)`` when rectified (Gallup et al., CVPR 2008) and its numerical equal for any other rig.
Every distance therefore tells ``sigma_d = std/K`` on its own, and stereo noise is what makes them agree.
Mean errors are kept apart: they are calibration, not noise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt
from scipy import stats

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.infer_bias import BiasPart, bias_part
from rigsim.theory.uncertainty import parallax_px, predict_depth_std

CONFIDENCE = 0.95
"""Of every interval here."""
FEWEST = 3
"""Distances that a law can be tested with."""
P95 = 1.959963984540054
"""Standard deviations within which 95 % of a normal error lie."""

_UNIT_DISPARITY = PixelNoise(1 / math.sqrt(2))
_SCATTER = 0.01
"""Rarer scatter than this between distances, and the samples' own chi-square is not believed."""

Law = Literal["quadratic", "linear", "constant"]
Verdict = Literal["consistent", "inconsistent", "untested"]
_POWERS: dict[Law, float] = {"linear": 1.0, "constant": 0.0}


@dataclass(frozen=True, slots=True)
class DepthErrors:
    """What a data sheet claims or a wall test gave, one entry a distance."""

    depths_m: Array
    """Distances (N,) along the left optical axis, m."""
    stds_m: Array
    """Standard deviation of depth (N,) about its own mean, m."""
    biases_m: Array | None = None
    """Mean of measured minus true depth (N,), m; None where nobody says."""
    counts: Array | None = None
    """Independent measurements (N,) behind each standard deviation; None where nobody says."""

    def __post_init__(self) -> None:
        count = len(self.depths_m)
        if count == 0:
            raise InvalidRange("no depth errors: give at least one, as in 1%@4m")
        for name, values in (("distance", self.depths_m), ("depth std", self.stds_m)):
            bad = values[~(np.isfinite(values) & (values > 0))]
            if len(bad):
                raise InvalidRange(f"{name} {bad[0] * 1e3:g} mm: must be > 0 and finite")
        if self.biases_m is not None and not np.isfinite(self.biases_m).all():
            raise InvalidRange("depth bias: must be a finite number at every distance")
        if self.counts is not None and not (self.counts >= 2).all():
            raise InvalidRange(f"n {self.counts.min():g}: a standard deviation needs >= 2 measurements")


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
    verdict: Verdict
    """Inconsistent when the interval leaves the exponent of stereo noise out."""


@dataclass(frozen=True, slots=True)
class Inference:
    """The disparity noise behind some depth errors."""

    rig: StereoRig
    """The rig they are of."""
    errors: DepthErrors
    """The depth errors."""
    gains_m_per_px: Array
    """Depth error per pixel of disparity (N,), m/px."""
    disparity_std_px: float
    """Standard deviation of the disparity, px."""
    low_px: float
    """Lower end of its interval; NaN where nothing says how sure it is."""
    high_px: float
    """Upper end."""
    interval_from: Literal["samples", "fit", "none"]
    """Chi-square of the counts, scatter between the distances, or no interval."""
    fit: LawFit | None
    """None where too few distances, or equal ones, leave nothing to test."""
    bias: BiasPart | None
    """None where no bias is known."""

    @property
    def verdict(self) -> Verdict:
        """Whether stereo noise can be behind it."""
        return "untested" if self.fit is None else self.fit.verdict


@dataclass(frozen=True, slots=True)
class Transfer:
    """What the same disparity noise does to another rig."""

    rig: StereoRig
    """The other rig."""
    depths_m: Array
    """Distances (N,), m."""
    stds_m: Array
    """Standard deviation of depth there (N,), m."""
    lows_m: Array
    """Lower ends of their intervals (N,), m; NaN without one."""
    highs_m: Array
    """Upper ends (N,), m."""
    trusted: npt.NDArray[np.bool_]
    """Where the disparity is at least four times its noise (N,): elsewhere a std says little."""


def infer_disparity_noise(rig: StereoRig, errors: DepthErrors) -> Inference:
    """The disparity noise that makes `rig` err as `errors` say.

    With counts, the variances are pooled: ``sum(nu s^2/K^2) / sum(nu)``, ``nu = n - 1``, chi-square
    distributed when the noise is normal. Without, the mean of ``ln(s/K)`` and Student's t on its scatter,
    from three distances on. Counts that cannot explain the scatter between the distances are not believed
    and the scatter decides.

    Raises:
        InvalidRange: a distance at which the rig has no depth.
    """
    gains = depth_gain(rig, errors.depths_m)
    logs = np.log(errors.stds_m / gains)
    estimate, low, high, interval_from = _estimate(logs, errors.counts)
    bias = None
    if errors.biases_m is not None:
        bias = bias_part(errors.depths_m, errors.stds_m, errors.counts, gains, errors.biases_m)
    fit = _fit(errors, gains)
    return Inference(rig, errors, gains, estimate, low, high, interval_from, fit, bias)


def depth_gain(rig: StereoRig, depths_m: Array) -> Array:
    """Depth error per pixel of disparity error (N,) m/px on the left optical axis at `depths_m` (N,).

    Raises:
        InvalidRange: a distance at which the rig has no depth.
    """
    gains = predict_depth_std(rig, _on_axis(depths_m), _UNIT_DISPARITY)
    bad = ~(np.isfinite(gains) & (gains > 0))
    if bad.any():
        raise InvalidRange(f"distance {depths_m[bad][0] * 1e3:g} mm: this rig has no depth there")
    return gains


def law_factor(errors: DepthErrors, power: float) -> float:
    """Factor, m at 1 m, of the law ``factor x distance^power`` that fits `errors` best, in logarithms."""
    freedom = np.ones(len(errors.depths_m)) if errors.counts is None else errors.counts - 1
    logs = np.log(errors.stds_m) - power * np.log(errors.depths_m)
    return math.exp(float((freedom * logs).sum() / freedom.sum()))


def disparity_of_bounds(rig: StereoRig, near_m: float, far_m: float) -> float:
    """Disparity error, px, whose two signs put a point at `near_m` and at `far_m`: half their disparity."""
    near_px, far_px = parallax_px(rig, _on_axis(np.array([near_m, far_m])))
    return float(near_px - far_px) / 2


def transfer(inference: Inference, rig: StereoRig, depths_m: Array) -> Transfer:
    """The depth errors of `rig` (N,) at `depths_m` (N,) with the inferred disparity noise, in pixels.

    The noise is carried over in pixels, as it is for the same matcher on pictures of the same quality.

    Raises:
        InvalidRange: a distance at which the rig has no depth.
    """
    gains = depth_gain(rig, depths_m)
    sigma = inference.disparity_std_px
    trusted = parallax_px(rig, _on_axis(depths_m)) >= 4 * sigma
    return Transfer(
        rig, depths_m, sigma * gains, inference.low_px * gains, inference.high_px * gains, np.asarray(trusted)
    )


def _on_axis(depths_m: Array) -> Array:
    zero = np.zeros_like(depths_m)
    return np.column_stack([zero, zero, depths_m])


def _estimate(
    logs: Array, counts: Array | None
) -> tuple[float, float, float, Literal["samples", "fit", "none"]]:
    if counts is not None:
        freedom = counts - 1
        total = float(freedom.sum())
        variance = float((freedom * np.exp(2 * logs)).sum()) / total
        if len(logs) < FEWEST or _scatter_probability(logs, freedom) > _SCATTER:
            low, high = (
                math.sqrt(variance * total / float(stats.chi2.ppf(side, total)))
                for side in ((1 + CONFIDENCE) / 2, (1 - CONFIDENCE) / 2)
            )
            return math.sqrt(variance), low, high, "samples"
    middle = float(logs.mean())
    if len(logs) < FEWEST:
        return math.exp(middle), math.nan, math.nan, "none"
    reach = _t(len(logs) - 1) * float(logs.std(ddof=1)) / math.sqrt(len(logs))
    return math.exp(middle), math.exp(middle - reach), math.exp(middle + reach), "fit"


def _scatter_probability(logs: Array, freedom: Array) -> float:
    """How likely counts alone make the variances scatter as much (Bartlett 1937)."""
    total, groups = float(freedom.sum()), len(logs)
    pooled = math.log(float((freedom * np.exp(2 * logs)).sum()) / total)
    correction = 1 + (float((1 / freedom).sum()) - 1 / total) / (3 * (groups - 1))
    statistic = (total * pooled - float((freedom * 2 * logs).sum())) / correction
    return float(stats.chi2.sf(statistic, groups - 1))


def _t(freedom: int) -> float:
    return float(stats.t.ppf((1 + CONFIDENCE) / 2, freedom))


def _fit(errors: DepthErrors, gains: Array) -> LawFit | None:
    """The exponent by regression in logarithms, and each law's misfit.

    The regression is of ``s/K`` on Z, whose slope is zero for stereo noise of any rig; two more is the
    exponent of a rectified one.
    """
    logs_z = np.log(errors.depths_m)
    count = len(logs_z)
    freedom = np.ones(count) if errors.counts is None else errors.counts - 1
    weights = freedom / freedom.sum()
    away = logs_z - (weights * logs_z).sum()
    spread = float((weights * away**2).sum())
    if count < FEWEST or spread < 1e-12:
        return None
    residual = np.log(errors.stds_m / gains)
    slope = float((weights * away * residual).sum()) / spread
    left = residual - (weights * residual).sum() - slope * away
    unit_variance = float((freedom * left**2).sum()) / (count - 2)
    reach = _t(count - 2)
    if errors.counts is not None:
        # ln s of n normal values has the variance 1/(2 nu); more scatter than that is taken as it is
        if unit_variance <= 0.5:
            reach = float(stats.norm.ppf((1 + CONFIDENCE) / 2))
        unit_variance = max(unit_variance, 0.5)
    reach *= math.sqrt(unit_variance / (float(freedom.sum()) * spread))
    misfit: dict[Law, float] = {"quadratic": _misfit(residual, weights)}
    logs = np.log(errors.stds_m)
    misfit |= {law: _misfit(logs - power * logs_z, weights) for law, power in _POWERS.items()}
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
