"""Mistakes in what comes out: its frame, its scale, the ends of the range, the rows, the scatter."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from benchmarks.subjects import mutant as declare
from benchmarks.subjects.triangulators import (
    Calibration,
    calibration,
    homogeneous,
    intersect,
    linear,
    midpoint,
    opencv,
    solve_linear,
    unchecked,
    undistort,
)
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig

MUTANTS: list[declare.Mutant] = []
"""In the order below."""

mutant = partial(declare.mutant, MUTANTS)


# where the answer is


@mutant("frame", "points in the right camera's frame", "the answer is in the right camera's frame")
def right_frame(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return linear(rig, uv_left, uv_right) @ rig.right_from_left.R.T + rig.right_from_left.t


@mutant(
    "frame",
    "points counted from the middle of the baseline",
    "the answer is in the rig's frame, not the left camera's",
)
def rig_frame(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return linear(rig, uv_left, uv_right) @ rig.rig_from_left.R.T + rig.rig_from_left.t


@mutant(
    "frame",
    "points in the rectified left camera's frame",
    "the answer is in the rectified frame: R1 was not undone",
)
def rectified_frame(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    along = -c.R.T @ c.t / np.linalg.norm(c.t)
    ahead = np.eye(3)[2] + c.R[2]
    down = np.cross(ahead, along) / np.linalg.norm(np.cross(ahead, along))
    return linear(rig, uv_left, uv_right) @ np.column_stack([along, down, np.cross(along, down)])


@mutant("frame", "axes x forward, y left, z up", "the axes are ROS's: x forward, y left, z up")
def ros_axes(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return linear(rig, uv_left, uv_right)[:, [2, 0, 1]] * (1, -1, -1)


@mutant("frame", "axes x right, y up, z backward", "the axes are OpenGL's: y up, z backward")
def opengl_axes(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return midpoint(rig, uv_left, uv_right) * (1, -1, -1)


@mutant("frame", "y up", "the answer's y axis points up")
def y_up(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return opencv(rig, uv_left, uv_right) * (1, -1, 1)


# how large it is


@mutant("scale", "points in mm", "the answer is in mm: 1000 times too large")
def millimetres(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return opencv(rig, uv_left, uv_right) * 1e3


@mutant(
    "scale",
    "a baseline in m divided by 1000 as if it were mm",
    "the answer is 1000 times too small: m for mm",
)
def metres_for_millimetres(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    return solve_linear(replace(c, t=c.t / 1e3), uv_left, uv_right)


@mutant("scale", "the distance put in the place of Z", "depth is the length of the ray, not Z")
def ray_length(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = linear(rig, uv_left, uv_right)
    points[:, 2] = np.linalg.norm(points, axis=1)
    return points


@mutant("scale", "Z laid off along the unit ray", "Z was taken for the length of the ray")
def depth_along_ray(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = midpoint(rig, uv_left, uv_right)
    return points * (points[:, 2] / np.linalg.norm(points, axis=1))[:, None]


@mutant(
    "scale",
    "depth as uint16 mm, as in a depth picture",
    "depth is whole mm in 16 bits: rounded, and it wraps at 65.5 m",
)
def sixteen_bits(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = linear(rig, uv_left, uv_right)
    z = np.mod(np.round(points[:, 2:] * 1e3), 65536) / 1e3
    return points / points[:, 2:] * z


@mutant("scale", "everything in float32", "digits are lost: single precision")
def single_precision(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    left = undistort(uv_left.astype(np.float32), c.K_left, c.lens_left).astype(np.float32)
    right = undistort(uv_right.astype(np.float32), c.K_right, c.lens_right).astype(np.float32)
    return intersect(c, left.astype(float), right.astype(float)).astype(np.float32)


@mutant(
    "scale",
    "points as float16 mm: 3 digits, and infinite beyond 65.5 m",
    "digits are lost and far points overflow: half precision",
)
def half_precision(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    with np.errstate(over="ignore"):
        return (opencv(rig, uv_left, uv_right) * 1e3).astype(np.float16).astype(float) / 1e3


# at the ends of the range


@mutant(
    "range",
    "disparities under 1 px set to 1 px",
    "small disparities are clamped: nothing is farther than some depth",
)
def clamped_disparity(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = linear(rig, uv_left, uv_right)
    farthest = rig.left.fx * rig.baseline_m
    with np.errstate(all="ignore"):
        return points * np.minimum(1.0, farthest / points[:, 2:])


@mutant(
    "range",
    "the disparity's absolute value",
    "points behind the cameras come out in front: abs() of the disparity",
)
def absolute_disparity(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = unchecked(rig, uv_left, uv_right)
    return points * np.sign(points[:, 2:])


@mutant("range", "points beyond 20 m set to zero", "far points are set to zero")
def zero_beyond_20_m(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = linear(rig, uv_left, uv_right)
    points[points[:, 2] > 20] = 0
    return points


@mutant("range", "0 for NaN", "points that cannot be are returned as zeros: they must be NaN")
def zero_for_nan(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return np.nan_to_num(opencv(rig, uv_left, uv_right))


@mutant(
    "range",
    "1/Z drawn 1 % towards 1/(3 m)",
    "depths are drawn towards a prior: near ones too far, far ones too near",
)
def prior(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = linear(rig, uv_left, uv_right)
    return points / (0.99 + 0.01 * points[:, 2:] / 3)


# which row is which


@mutant("rows", "rows sorted by depth", "rows come back in another order")
def sorted_rows(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = linear(rig, uv_left, uv_right)
    return points[np.argsort(points[:, 2])]


@mutant("rows", "rows with NaN left out", "rows that have no point are left out: the count is wrong")
def dropped_rows(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = midpoint(rig, uv_left, uv_right)
    return points[np.isfinite(points).all(axis=1)]


@mutant("rows", "the first point in every row", "every row has the same point")
def first_row_everywhere(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = linear(rig, uv_left, uv_right)
    points[:] = points[:1]
    return points


@mutant(
    "rows",
    "a left pixel paired with the next row's right one",
    "left and right rows do not correspond: off by one",
)
def next_rows_pixel(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return midpoint(rig, uv_left, np.roll(uv_right, -1, axis=0))


@mutant(
    "rows",
    "good points dropped: more than 1.5 median absolute deviations from the median depth",
    "good points are thrown away by an outlier filter",
)
def eager_filter(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    points = linear(rig, uv_left, uv_right)
    if np.isfinite(points[:, 2]).any():
        off = np.abs(points[:, 2] - np.nanmedian(points[:, 2]))
        points[off > 1.5 * np.nanmedian(off)] = np.nan
    return points


class Stale:
    """Reads the calibration on its first call and never again."""

    def __init__(self) -> None:
        self.c: Calibration | None = None

    def __call__(self, rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        self.c = self.c or calibration(rig)
        return solve_linear(self.c, uv_left, uv_right)


stale = Stale()
MUTANTS.append(
    declare.Mutant(
        "stale", "the first call's rig used ever after", "the rig of another call is used", "rows", stale
    )
)


# how it scatters


@mutant(
    "scatter",
    "noise of 0.05 px added to the pixels",
    "the answer scatters more than the pixels: it is not deterministic",
)
def own_noise(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    rng = np.random.default_rng()
    return linear(rig, uv_left + 0.05 * rng.standard_normal(uv_left.shape), uv_right)


@mutant(
    "scatter",
    "a correction for rays that miss each other, made along u where v was missed",
    "right on average, but it scatters more than the pixels allow",
    only_strict=True,
)
def wasteful(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    c = calibration(rig)
    xy_left = undistort(uv_left, c.K_left, c.lens_left)
    xy_right = undistort(uv_right, c.K_right, c.lens_right)
    points = homogeneous(c, xy_left, xy_right)
    with np.errstate(all="ignore"):
        in_right = points @ c.R.T + c.t
        missed_left = xy_left[:, 1] - points[:, 1] / points[:, 2]
        missed_right = xy_right[:, 1] - in_right[:, 1] / in_right[:, 2]
    xy_right[:, 0] += np.nan_to_num(missed_left - missed_right) * rig.left.fy / rig.left.fx
    return intersect(c, xy_left, xy_right)
