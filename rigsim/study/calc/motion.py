"""What becomes of a distance when the two pictures are not taken at the same time."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.motion import Motion
from rigsim.rig.noise import PixelNoise
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.study.calc.plane import shared_plane
from rigsim.theory.triangulation import triangulate

ODD_ROWS_PX = 1.0
"""A matcher that searches along rows loses points that lie further off theirs."""
KEPT_ROWS_PX = 0.5
"""A matcher that searches along rows finds all points that lie no further off theirs."""
_ROUNDING_PX = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class LateShift:
    """What the right picture's delay does to points (N, 3); NaN where a camera does not see one."""

    along_px: Array
    """How far the point moves along the rows of the right picture, px; positive is right."""
    across_px: Array
    """How far it moves across them, px; positive is down."""
    depth_error_m: Array
    """Depth that the calibrated rig finds, minus the true one when the left picture is taken, m."""


@dataclass(frozen=True, slots=True)
class MotionAt:
    """What a delay does at one distance."""

    along_px: float
    """On the left optical axis, px."""
    across_px: float
    """On the left optical axis, px."""
    depth_error_m: float
    """On the left optical axis, m."""
    most_along_px: float
    """Over the part of the image that both see, the one that is largest, px; NaN without image size."""
    most_across_px: float
    """The same across the rows, px."""
    most_depth_error_m: float
    """The same of the depth, m."""
    allowed_s: float
    """Time offset with which the largest of these shifts along the rows is a disparity's noise, s."""
    allowed_rows_s: float
    """Time offset with which the largest of them across the rows is `KEPT_ROWS_PX`, s."""


def shift_of(rig: StereoRig, motion: Motion, points_left: Array) -> LateShift:
    """What `motion` does to points (N, 3) m, placed where they are when the left picture is taken."""
    seen_left, seen_late = motion.apply(rig).project(points_left)
    moved = seen_late - rig.project(points_left)[1]
    found = triangulate(rig, seen_left, seen_late)[:, 2]
    error = np.where(found > 0, found, np.nan) - points_left[:, 2]
    return LateShift(moved[:, 0], moved[:, 1], error)


def motion_at(rig: StereoRig, motion: Motion, depth_m: float, noise: PixelNoise, *, sized: bool) -> MotionAt:
    """What `motion` does at a distance on the left optical axis and, where images are `sized`, around it."""
    there = shift_of(rig, motion, np.array([[0.0, 0.0, depth_m]]))
    nothing = np.full(1, np.nan)
    whole = (
        shift_of(rig, motion, shared_plane(rig, depth_m)) if sized else LateShift(nothing, nothing, nothing)
    )
    along_px, most_along_px = float(there.along_px[0]), _largest(whole.along_px)
    across_px, most_across_px = float(there.across_px[0]), _largest(whole.across_px)
    shift_px = abs(along_px if math.isnan(most_along_px) else most_along_px)
    rows_px = abs(across_px if math.isnan(most_across_px) else most_across_px)
    return MotionAt(
        along_px,
        across_px,
        float(there.depth_error_m[0]),
        most_along_px,
        most_across_px,
        _largest(whole.depth_error_m),
        _time_for(noise.disparity_std_px, shift_px, motion),
        _time_for(KEPT_ROWS_PX, rows_px, motion),
    )


def motion_remarks(found: MotionAt, depth_m: float) -> Iterator[Remark]:
    """Whether a matcher would still find the points, and whether they have a depth at all."""
    across_px = found.across_px if math.isnan(found.most_across_px) else found.most_across_px
    if abs(across_px) > ODD_ROWS_PX:
        yield Remark(
            "rows",
            f"points move up to {abs(across_px):.3g} px off their rows: a matcher that searches along rows "
            "loses them; trigger both cameras at once",
        )
    if math.isnan(found.depth_error_m) and not math.isnan(found.along_px):
        yield Remark(
            "no_depth",
            f"at Z = {depth_m * 1e3:g} mm the shift of {found.along_px:.4g} px leaves no disparity, and no "
            "depth",
        )


def _time_for(kept_px: float, shift_px: float, motion: Motion) -> float:
    """The time offset, s, with which a shift is `kept_px`: it grows with the time; infinite without one."""
    return abs(motion.time_offset_s) * kept_px / shift_px if shift_px > _ROUNDING_PX else math.inf


def _largest(values: Array) -> float:
    """The value that is furthest from 0."""
    known = values[np.isfinite(values)]
    return float(known[np.abs(known).argmax()]) if known.size else math.nan
