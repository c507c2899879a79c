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
        "n": len(back),
        "failed_share": 1 - n / len(back),
        "expected_failed_share": must.failed_share,
        "expected_failed_share_se": must.failed_share_se,
        "pixel_error_px": math.nan,
        "pixel_bound_px": noise_px * math.sqrt(3 * must.squares),
        "pixel_error_over_bound": math.nan,
        "pixel_error_over_bound_se": math.nan,
        "bound_se": must.squares_std / (2 * must.squares * math.sqrt(max(n, 1))),
        "pixel_error_over_first": math.nan,
        "pixel_error_over_first_se": math.nan,
        "depth_error_over_bound": math.nan,
        "depth_bias_over_std": math.nan,
        "depth_bias_over_std_se": math.nan,
        "expected_depth_bias_over_std": must.bias,
        "depth_median_abs_mm": math.nan,
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
        "pixel_error_px": noise_px * math.sqrt(3 * mean),
        "pixel_error_over_bound": ratio,
        "pixel_error_over_bound_se": ratio * float(squares.std()) / (2 * mean * math.sqrt(n))
        if mean
        else 0.0,
        "pixel_error_over_first": over_first,
        "pixel_error_over_first_se": over_first_se,
        "depth_error_over_bound": math.sqrt(float((inverse_depth**2).mean()) / must.depth_squares),
        "depth_bias_over_std": float(inverse_depth.mean()),
        "depth_bias_over_std_se": float(inverse_depth.std()) / math.sqrt(n),
        "depth_median_abs_mm": float(np.median(np.abs(mine.depth_m[back]))) * 1e3,
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
