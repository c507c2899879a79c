"""How wrong matches and dense disparities are, where somebody knows the true disparity.

The truth is ``u_left - u_right`` at the pixels of the left picture, as rendered pairs and Middlebury's files
hold it: an offset of the principal points (``doffs``) is no part of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidImage
from rigsim.pixels.dense.metrics import (
    DisparityErrors,
    PhaseErrors,
    disparity_errors,
    errors_by_region,
    phase_errors,
)
from rigsim.pixels.dense.regions import DISPARITY_GAP_PX, regions
from rigsim.pixels.images import grey
from rigsim.rig.arrays import AnyImage, Array
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import rms

OUTLIER_PX = 3.0
"""A disparity further off than this is a wrong match, not an inaccurate one."""
_TRIMMED = 0.005  # at either end, as the Depth Quality Tool does
_LARGEST_GREY = {1: 255, 2: 65535}


@dataclass(frozen=True, slots=True)
class MatchErrors:
    """Errors of single matches; NaN where no match has a truth."""

    errors: DisparityErrors
    """The numbers of stereo benchmarks; here every match has a disparity."""
    outlier_pct: float
    """Share more than 3 px off, percent."""
    inlier_std_px: float
    """Standard deviation of the others' errors, px."""
    within_3_std_pct: float
    """Share within three of their own predicted standard deviations, percent; 99.7 when they are right."""


@dataclass(frozen=True, slots=True)
class DenseDepthErrors:
    """What the disparity errors are as depths, over all pixels with both."""

    z_accuracy_pct: float
    """Median of depth minus true depth as a share of the true depth, percent; positive is too far."""
    rms_mm: float
    """Root mean square depth error, mm; 0.5 % of the errors at either end are left out."""
    rms_pct: float
    """The same for errors as shares of the true depth, percent."""


@dataclass(frozen=True, slots=True, eq=False)
class DenseErrors:
    """Errors of a disparity map."""

    regions: dict[str, DisparityErrors]
    """By Middlebury's region: all, non-occluded, occluded, textureless, near-discontinuity."""
    phase: PhaseErrors
    """Against the fraction of a pixel."""
    depth: DenseDepthErrors
    """As depths."""
    inlier_std_px: float
    """Standard deviation of the errors of at most 3 px, px."""


def truth_at(truth: Array, uv: Array) -> Array:
    """True disparity (N,) px at positions (N, 2) px, between pixels by bilinear interpolation.

    NaN beyond the image, where a pixel next to the position is unknown, or where two of them side by side
    differ by a step of more than 2 px: what lies between is no point of a surface.
    """
    height, width = truth.shape
    u, v = uv[:, 0], uv[:, 1]
    inside = (u >= 0) & (u <= width - 1) & (v >= 0) & (v <= height - 1)
    u, v = np.where(inside, u, 0.0), np.where(inside, v, 0.0)
    left, top = np.floor(u).astype(np.intp), np.floor(v).astype(np.intp)
    share_u, share_v = u - left, v - top
    # a position on a pixel asks that pixel alone
    right, bottom = left + (share_u > 0), top + (share_v > 0)
    corners = np.stack([truth[top, left], truth[top, right], truth[bottom, right], truth[bottom, left]])
    weights = np.stack(
        [
            (1 - share_u) * (1 - share_v),
            share_u * (1 - share_v),
            share_u * share_v,
            (1 - share_u) * share_v,
        ]
    )
    one_surface = inside & (np.abs(corners - np.roll(corners, 1, axis=0)).max(axis=0) <= DISPARITY_GAP_PX)
    return np.where(one_surface, (corners * weights).sum(axis=0), np.nan)


def match_errors(disparity: Array, std_px: Array, truth: Array) -> MatchErrors:
    """Errors of matches with predicted standard deviations; all (N,), px, the truth NaN where unknown."""
    error = (disparity - truth)[np.isfinite(truth)]
    std = std_px[np.isfinite(truth)]
    return MatchErrors(
        errors=disparity_errors(disparity, truth),
        outlier_pct=100.0 * _mean(np.abs(error) > OUTLIER_PX),
        inlier_std_px=_inlier_std(error),
        within_3_std_pct=100.0 * _mean(np.abs(error) <= 3 * std),
    )


def dense_errors(disparity: Array, truth: Array, rig: StereoRig, image_left: AnyImage) -> DenseErrors:
    """Errors of a disparity map (H, W) px of a rectified rig; NaN unknown in both.

    Raises:
        InvalidImage: the sizes differ.
    """
    error = disparity - truth
    return DenseErrors(
        regions=errors_by_region(disparity, truth, regions(truth, _eight_bit(image_left))),
        phase=phase_errors(disparity, truth),
        depth=_depth_errors(disparity, truth, rig),
        inlier_std_px=_inlier_std(error[np.isfinite(error)]),
    )


def check_truth(truth: Array, width: int, height: int) -> None:
    """Check that a truth (H, W) belongs to pictures of `width` x `height` px and says something.

    Raises:
        InvalidImage: it does not.
    """
    if truth.shape != (height, width):
        size = " x ".join(str(side) for side in truth.shape[::-1])
        raise InvalidImage(f"truth of {size} px: the pictures have {width} x {height}; it must be theirs")
    if not np.isfinite(truth).any():
        raise InvalidImage("truth: no disparity is known")


def _depth_errors(disparity: Array, truth: Array, rig: StereoRig) -> DenseDepthErrors:
    with np.errstate(divide="ignore", invalid="ignore"):
        depth, true = (
            rig.left.fx * rig.baseline_m / (values + rig.doffs_px) for values in (disparity, truth)
        )
        known = np.isfinite(depth) & np.isfinite(true) & (depth > 0) & (true > 0)
    error, true = depth[known] - true[known], true[known]
    if not len(error):
        return DenseDepthErrors(math.nan, math.nan, math.nan)
    return DenseDepthErrors(
        z_accuracy_pct=100.0 * float(np.median(error / true)),
        rms_mm=1e3 * _trimmed_rms(error),
        rms_pct=100.0 * _trimmed_rms(error / true),
    )


def _trimmed_rms(values: Array) -> float:
    cut = int(len(values) * _TRIMMED)
    kept = np.sort(values)[cut : len(values) - cut]
    return rms(kept)


def _inlier_std(error: Array) -> float:
    kept = error[np.abs(error) <= OUTLIER_PX]
    return float(kept.std()) if len(kept) else math.nan


def _mean(values: Array | np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> float:
    return float(values.mean()) if len(values) else math.nan


def _eight_bit(image: AnyImage) -> Array:
    """Grey levels of 8 bit, which the textureless region's threshold is meant for."""
    levels = grey(image, "left image")
    largest = _LARGEST_GREY[image.dtype.itemsize] if image.dtype.kind == "u" else max(255.0, levels.max())
    return levels * (255.0 / largest)
