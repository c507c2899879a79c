"""From depth errors at known distances back to the disparity noise behind them, and on to another rig.

A rig turns a disparity error of one standard deviation ``sigma_d`` into ``K(Z) sigma_d`` of depth, with
``K = Z^2/(f B)`` when rectified (Gallup et al., CVPR 2008) and its numerical equal for any other rig.
Every distance therefore tells ``sigma_d = std/K`` on its own, and stereo noise is what makes them agree.
Mean errors are kept apart: they are calibration, not noise; but a point that is measured too far has
the noise of where it is measured.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import rms
from rigsim.study.infer.bias import BiasPart, Gain, bias_share, split_bias
from rigsim.study.infer.noise import (
    FEWEST,
    FitVerdict,
    IntervalFrom,
    LawFit,
    degrees_of_freedom,
    law_fit,
    noise_fit,
    smoothed_px,
    without_noise,
)
from rigsim.study.infer.random_effects import CONFIDENCE
from rigsim.theory.uncertainty import LEAST_DEPTH_SIGMAS, depth_in_sigmas, parallax_px, predict_depth_std

__all__ = [
    "CONFIDENCE",
    "FEWEST",
    "P95",
    "ErrorsByDistance",
    "Inference",
    "Transfer",
    "depth_gain",
    "disparities_on_axis",
    "disparity_of_bounds",
    "infer_disparity_noise",
    "law_factor",
    "transfer",
]

P95 = 1.959963984540054
"""Standard deviations within which 95 % of a normal error lie."""

_UNIT_DISPARITY = PixelNoise(1 / math.sqrt(2))


@dataclass(frozen=True, slots=True)
class ErrorsByDistance:
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
        for depth, mean in zip(self.depths_m, self.means_m, strict=True):
            if mean <= 0:
                raise InvalidRange(
                    f"distance {depth * 1e3:g} mm with a bias of {(mean - depth) * 1e3:g} mm: the mean"
                    " measured depth must be > 0; a bias is measured minus true, in mm"
                )

    @property
    def means_m(self) -> Array:
        """Mean measured depths (N,), m; the distances where no bias is known."""
        return self.depths_m if self.biases_m is None else self.depths_m + self.biases_m


@dataclass(frozen=True, slots=True)
class Inference:
    """The disparity noise behind some depth errors."""

    rig: StereoRig
    """The rig they are of."""
    errors: ErrorsByDistance
    """The depth errors."""
    gains_m_per_px: Array
    """Depth error per pixel of disparity (N,), m/px: std over the disparity noise that it alone implies."""
    disparity_std_px: float
    """Standard deviation of the disparity, px."""
    low_px: float
    """Lower end of its interval; NaN where nothing says how sure it is."""
    high_px: float
    """Upper end."""
    interval_from: IntervalFrom
    """Chi-square of the counts, scatter between the distances, or no interval."""
    fit: LawFit | None
    """None where too few distances, or equal ones, leave nothing to test."""
    bias: BiasPart | None
    """None where no bias is known."""

    def explained_gain(self, depths_m: Array) -> Array:
        """Depth error per pixel of disparity (N,) m/px where the rig measures `depths_m` (N,), scale and all.

        Raises:
            InvalidRange: a distance at which the rig has no depth.
        """
        scale = 0.0 if self.bias is None or math.isnan(self.bias.scale) else self.bias.scale
        return (1 + scale) * depth_gain(self.rig, depths_m / (1 + scale))

    @property
    def verdict(self) -> FitVerdict:
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
    """Where the depth is at least four of its own standard deviations (N,): elsewhere a std says little."""


def infer_disparity_noise(rig: StereoRig, errors: ErrorsByDistance) -> Inference:
    """The disparity noise, and the disparity offset and scale, that make `rig` err as `errors` say.

    With counts that explain the scatter between the distances, variances are pooled: chi-square. Else, from
    three distances on, the distances have a variance of their own (`random_effects`) and the interval is
    Student's. Measurements (a bias or counts are known) are taken to second order in the noise, claims to
    first.

    Raises:
        InvalidRange: a distance at which the rig has no depth, or biases that nothing explains.
    """
    measured = errors.biases_m is not None or errors.counts is not None
    steady, a = errors.means_m, (errors.stds_m / errors.means_m) ** 2
    if measured:
        steady, a = without_noise(errors.means_m, errors.stds_m, errors.biases_m is not None)
    freedom = None if errors.counts is None else degrees_of_freedom(errors.counts, a)

    def gain(depths: Array) -> Array:
        return depth_gain(rig, depths)

    stds_px = np.sqrt(a) * steady / gain(steady)
    bias, more = None, 0.0
    # a scale changes the noise in px that a depth tells, and that the trust in each mean: so twice
    for _ in range(0 if errors.biases_m is None else 1 if errors.counts is None else 2):
        variances = None
        if freedom is not None and errors.counts is not None:
            variances = smoothed_px(stds_px, freedom) ** 2 * (1 + 8 * a) / errors.counts
        bias = _bias(gain, errors, steady, stds_px, variances)
        if not math.isnan(bias.scale):
            found = steady / (1 + bias.scale)
            stds_px = np.sqrt(a) * found / gain(found)
            more = bias.reach * bias.scale_se / (1 + bias.scale)
    noise = noise_fit(stds_px, freedom, 0.0 if math.isnan(more) else more)
    law = law_fit(errors.means_m, errors.stds_m, stds_px, freedom)
    return Inference(
        rig,
        errors,
        errors.stds_m / stds_px,
        noise.std_px,
        noise.low_px,
        noise.high_px,
        noise.interval_from,
        law,
        bias,
    )


def _bias(
    gain: Gain, errors: ErrorsByDistance, steady: Array, stds_px: Array, variances_px2: Array | None
) -> BiasPart:
    assert errors.biases_m is not None
    fit, left_px = split_bias(gain, errors.depths_m, steady, variances_px2)
    both = len(fit.values) > 1
    return BiasPart(
        disparity_offset_px=float(fit.values[0]),
        disparity_offset_se_px=float(fit.ses[0]),
        scale=float(fit.values[1]) if both else math.nan,
        scale_se=float(fit.ses[1]) if both else math.nan,
        reach=fit.reach,
        left_rms_m=rms(left_px * errors.stds_m / stds_px),
        share=bias_share(errors.depths_m, errors.stds_m, errors.biases_m),
    )


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


def law_factor(errors: ErrorsByDistance, power: float) -> float:
    """Factor, m at 1 m, of the law ``factor x depth^power`` that fits `errors` best, in logarithms."""
    freedom = np.ones(len(errors.depths_m)) if errors.counts is None else errors.counts - 1
    logs = np.log(errors.stds_m) - power * np.log(errors.means_m)
    return math.exp(float((freedom * logs).sum() / freedom.sum()))


def disparity_of_bounds(rig: StereoRig, near_m: float, far_m: float) -> float:
    """Disparity error, px, whose two signs put a point at `near_m` and at `far_m`: half their disparity."""
    near_px, far_px = disparities_on_axis(rig, np.array([near_m, far_m]))
    return float(near_px - far_px) / 2


def disparities_on_axis(rig: StereoRig, depths_m: Array) -> Array:
    """Disparities (N,) px on the left optical axis at `depths_m` (N,); ``f B / Z`` when rectified."""
    return parallax_px(rig, _on_axis(depths_m))


def transfer(inference: Inference, rig: StereoRig, depths_m: Array) -> Transfer:
    """The depth errors of `rig` (N,) at `depths_m` (N,) with the inferred disparity noise, in pixels.

    The noise is carried over in pixels, as it is for the same matcher on pictures of the same quality.

    Raises:
        InvalidRange: a distance at which the rig has no depth.
    """
    gains = depth_gain(rig, depths_m)
    sigma = inference.disparity_std_px
    trusted = depth_in_sigmas(rig, _on_axis(depths_m), PixelNoise(sigma / math.sqrt(2))) >= LEAST_DEPTH_SIGMAS
    return Transfer(
        rig, depths_m, sigma * gains, inference.low_px * gains, inference.high_px * gains, np.asarray(trusted)
    )


def _on_axis(depths_m: Array) -> Array:
    zero = np.zeros_like(depths_m)
    return np.column_stack([zero, zero, depths_m])
