"""One row of a comparison: how far a triangulator's points are from the true ones, beside what must be.

Errors are judged in pixels and in 1/Z, as `rigsim.study.verify.checks` does and for its reasons: both stay
Gaussian where depth does not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.compare import columns as col
from rigsim.study.verify.bound import NoiseBound
from rigsim.theory.uncertainty import pixel_gain


@dataclass(frozen=True, slots=True, eq=False)
class Errors:
    """The errors of one triangulator for one set of noisy pixels."""

    squares: Array
    """Squared pixel error of each point, a third of the sum over coordinates, noise variances; NaN where
    none came back."""
    inverse_depth: Array
    """Error of 1/Z, standard deviations, positive when too far; NaN where none came back."""
    depth_m: Array
    """Error of Z, m, positive when too far."""


def errors(rig: StereoRig, points_left: Array, found_left: Array, noise_px: float) -> Errors:
    """Errors of the found points (N, 3) m, in the left camera's frame as the true ones."""
    error_px = np.hstack(rig.project(found_left)) - np.hstack(rig.project(points_left))
    back = np.isfinite(error_px).all(axis=1)
    true_m, found_m = points_left[:, 2], np.where(back, found_left[:, 2], np.nan)
    std_m = noise_px * np.linalg.norm(pixel_gain(rig, points_left)[:, 2], axis=1)
    return Errors(
        np.where(back, (error_px**2).sum(axis=1) / (3 * noise_px**2), np.nan),
        # 1/Z follows the disparity in a straight line
        (1 / true_m - 1 / found_m) * true_m**2 / std_m,
        found_m - true_m,
    )


def figures(mine: Errors, first: Errors | None, must: NoiseBound, noise_px: float) -> dict[str, float]:
    """The figures of one row.

    Args:
        mine: its errors.
        first: those of the first triangulator, for the same pixels; None when it has none here.
        must: the bound.
        noise_px: standard deviation of a coordinate, px.
    """
    back = np.isfinite(mine.squares)
    n = int(back.sum())
    row = {
        col.N: len(back),
        col.FAILED_SHARE: 1 - n / len(back),
        col.EXPECTED_FAILED_SHARE: must.failed_share,
        col.EXPECTED_FAILED_SHARE_SE: must.failed_share_se,
        col.PIXEL_ERROR: math.nan,
        col.PIXEL_BOUND: noise_px * math.sqrt(3 * must.squares),
        col.PIXEL_ERROR_OVER_BOUND: math.nan,
        col.PIXEL_ERROR_OVER_BOUND_SE: math.nan,
        col.BOUND_SE: must.squares_std / (2 * must.squares * math.sqrt(max(n, 1))),
        col.PIXEL_ERROR_OVER_FIRST: math.nan,
        col.PIXEL_ERROR_OVER_FIRST_SE: math.nan,
        col.DEPTH_ERROR_OVER_BOUND: math.nan,
        col.DEPTH_BIAS: math.nan,
        col.DEPTH_BIAS_SE: math.nan,
        col.EXPECTED_DEPTH_BIAS: must.bias,
        col.DEPTH_MEDIAN_ABS: math.nan,
    }
    if n < 2:
        return row
    squares, inverse_depth = mine.squares[back], mine.inverse_depth[back]
    mean = float(squares.mean())
    ratio = math.sqrt(mean / must.squares)
    over_first, over_first_se = (
        (math.nan, math.nan) if first is None else _paired(mine.squares, first.squares)
    )
    return row | {
        col.PIXEL_ERROR: noise_px * math.sqrt(3 * mean),
        col.PIXEL_ERROR_OVER_BOUND: ratio,
        col.PIXEL_ERROR_OVER_BOUND_SE: ratio * float(squares.std()) / (2 * mean * math.sqrt(n))
        if mean
        else 0.0,
        col.PIXEL_ERROR_OVER_FIRST: over_first,
        col.PIXEL_ERROR_OVER_FIRST_SE: over_first_se,
        col.DEPTH_ERROR_OVER_BOUND: math.sqrt(float((inverse_depth**2).mean()) / must.depth_squares),
        col.DEPTH_BIAS: float(inverse_depth.mean()),
        col.DEPTH_BIAS_SE: float(inverse_depth.std()) / math.sqrt(n),
        col.DEPTH_MEDIAN_ABS: float(np.median(np.abs(mine.depth_m[back]))) * 1e3,
    }


def _paired(mine: Array, first: Array) -> tuple[float, float]:
    """Ratio of two RMS errors for the same noise, and its standard error, over points both found."""
    both = np.isfinite(mine) & np.isfinite(first)
    if both.sum() < 2 or not first[both].any():
        return math.nan, math.nan
    mine, first = mine[both], first[both]
    square = float(mine.mean() / first.mean())
    # what is left of the noise after the pairs' common part
    rest = float((mine - square * first).std()) / float(first.mean()) / math.sqrt(len(mine))
    ratio = math.sqrt(square)
    return ratio, rest / (2 * ratio) if ratio else 0.0
