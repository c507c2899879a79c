"""What is known about the depth of one point."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from rigsim.api.calc.fact import Fact
from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig


class About(NamedTuple):
    """What is known about one point's depth."""

    facts: list[Fact]
    errors_mm: tuple[float, float, float]
    """How far X, Y and Z may be off, mm."""
    remarks: list[Remark]


def about(
    rig: StereoRig, point_left: Array, noise: PixelNoise, disparity_error_px: float | None, seen: bool
) -> About:
    """Errors of a point (3,) m; NaN unless both cameras see it."""
    from rigsim.study.calc.sight import noise_remarks
    from rigsim.theory.limits import world_per_pixel_m
    from rigsim.theory.uncertainty import depth_bounds, predict_covariance

    at = point_left[None]
    error_px = noise.disparity_std_px if disparity_error_px is None else disparity_error_px
    per_pixel_mm = float(world_per_pixel_m(rig, point_left[2])) * 1e3
    stds = near = far = math.nan
    errors_mm = (math.nan, math.nan, math.nan)
    if seen:
        near, far = (float(bound[0]) * 1e3 for bound in depth_bounds(rig, at, error_px))
        x, y, std_mm = (
            float(value) for value in np.sqrt(np.diag(predict_covariance(rig, at, noise)[0])) * 1e3
        )
        stds = std_mm
        gap = point_left[2] * 1e3 - near
        errors_mm = (x, y, min((size for size in (std_mm, gap) if size > 0), default=math.nan))
    off = f"when the disparity is off by {error_px:.4g} px"
    if not rig.is_rectified:
        off = f"when both pixels are off by {error_px / math.sqrt(2):.4g} px in all"
    facts = [
        Fact("world_per_pixel", "width of a pixel", per_pixel_mm, "mm", "at this depth"),
        Fact("depth_std", "depth std", stds, "mm", f"for {noise.std_px:g} px of noise per coordinate", stds),
        Fact("depth_near", "nearest depth", near, "mm", off, errors_mm[2]),
        Fact("depth_far", "farthest depth", far, "mm", off, errors_mm[2]),
    ]
    return About(facts, errors_mm, list(noise_remarks(rig, point_left, noise)) if seen else [])
