"""What a rig can see at all: search ranges, overlap, blind zone and the size of one step.

Fields of view are compared on the horizontal mid plane: the plane through the middle of the baseline,
spanned by the rig's x and z axes (`StereoRig.rig_from_left`). That means upright cameras side
by side, verged or not; depth is then counted from the baseline along the rig's z axis, which for a rectified
rig is the cameras' Z. The lens's distortion is taken on the row of the principal point.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory.epipolar import epipolar_motion


def depth_range_for_disparities(
    rig: StereoRig, max_disparity_px: float, min_disparity_px: float = 0.0, *, shift_px: float = 0.0
) -> tuple[float, float]:
    """Nearest and farthest depth, m, that a matcher finds which searches these disparities.

    ``fx b / (max + shift + doffs)`` and ``fx b / (min + shift + doffs)``; infinite when the search reaches
    the point at infinity. A search of N px from a shift s: ``max_disparity_px=N, shift_px=s``.

    Raises:
        InvalidRig: the rig is not rectified, so its images have no disparity.
        InvalidRange: the limits are the wrong way round, or end beyond infinity.
    """
    if not rig.is_rectified:
        raise InvalidRig("disparity search: the rig is not rectified: give the rig of the rectified images")
    if not min_disparity_px < max_disparity_px < math.inf:
        raise InvalidRange(
            f"disparities {min_disparity_px:g} to {max_disparity_px:g} px: must grow, and be finite"
        )
    offset = shift_px + rig.doffs_px
    nearest, farthest = max_disparity_px + offset, min_disparity_px + offset
    if not nearest > 0:
        raise InvalidRange(f"largest disparity {nearest:g} px, shift and doffs added: must be > 0")
    fx_b = rig.left.fx * rig.baseline_m
    return fx_b / nearest, fx_b / farthest if farthest > 0 else math.inf


def overlap_fov_deg(rig: StereoRig) -> float:
    """Horizontal angle, deg, that both cameras see far away; 0 when they share nothing there."""
    edges = [_edges(camera, pose) for camera, pose in _cameras(rig)]
    from_rad, to_rad = max(edge.left_rad for edge in edges), min(edge.right_rad for edge in edges)
    return math.degrees(max(to_rad - from_rad, 0.0))


class Overlap(NamedTuple):
    """What both cameras see at a depth."""

    width_m: Array
    """Width of the stretch both see on the mid plane, m; 0 where they share nothing."""
    fraction: Array
    """Share of the left image's columns that show it, 0 to 1."""


def overlap_at_depth(rig: StereoRig, depth_m: npt.ArrayLike) -> Overlap:
    """Width (...) m of what both cameras see at `depth_m` (...), and its share of the left image."""
    depth = np.asarray(depth_m, dtype=np.float64)
    lower, upper = _common_stretch(rig, depth)
    seen = upper > lower
    columns = _left_column(rig, upper, depth) - _left_column(rig, lower, depth)
    unknown = ~(depth > 0)
    with np.errstate(invalid="ignore"):
        width = np.where(unknown, np.nan, np.where(seen, upper - lower, 0.0))
    fraction = np.where(unknown, np.nan, np.where(seen, columns / rig.left.width, 0.0))
    return Overlap(width, fraction)


def dead_band_px(rig: StereoRig, depth_m: npt.ArrayLike) -> Array:
    """Columns (...) px of the left image that the right camera does not see at `depth_m` (...).

    ``f B / Z`` for a rectified rig of two equal cameras.
    """
    return np.asarray(rig.left.width * (1 - overlap_at_depth(rig, depth_m).fraction))


def blind_zone_m(rig: StereoRig) -> float:
    """Depth, m, before which no point of the mid plane is seen by both cameras; infinite if none ever is.

    ``B / (2 tan(hfov / 2))`` for a rectified rig of two equal cameras.
    """
    bounds = [bound for camera, pose in _cameras(rig) for bound in _edges(camera, pose).bounds]
    nearest, farthest = 0.0, math.inf
    # every lower bound must stay left of every upper bound: both are lines in z
    for lower in bounds:
        for upper in bounds:
            if lower.is_lower and not upper.is_lower:
                slope, room = upper.slope - lower.slope, upper.offset - lower.offset
                if slope > 0:
                    nearest = max(nearest, -room / slope)
                elif slope < 0:
                    farthest = min(farthest, -room / slope)
                elif room < 0:
                    return math.inf
    return nearest if nearest < farthest else math.inf


def depth_step_m(rig: StereoRig, depth_m: npt.ArrayLike, disparity_step_px: npt.ArrayLike = 1.0) -> Array:
    """Depth (...) m between two neighbouring disparities at `depth_m` (...) on the left optical axis.

    First order, ``Z^2 step / (f B)`` when rectified; `depth_bounds` is exact. NaN behind a camera.
    """
    depth = np.asarray(depth_m, dtype=np.float64)
    on_axis = np.zeros((depth.size, 3))
    on_axis[:, 2] = depth.ravel()
    motion = epipolar_motion(rig, on_axis)
    with np.errstate(all="ignore"):
        step = (motion.depth_right**2 / motion.speed).reshape(depth.shape)
    return np.asarray(step * np.asarray(disparity_step_px, dtype=np.float64))


def world_per_pixel_m(rig: StereoRig, depth_m: npt.ArrayLike) -> Array:
    """Width (...) m that one column of the left image covers at `depth_m` (...): ``Z / fx``."""
    return np.asarray(np.asarray(depth_m, dtype=np.float64) / rig.left.fx)


class _Bound(NamedTuple):
    """A line ``x = slope z + offset`` of the mid plane, with what the camera sees on one side."""

    slope: float
    offset: float
    is_lower: bool


class _Edges(NamedTuple):
    left_rad: float
    right_rad: float
    bounds: tuple[_Bound, ...]


def _cameras(rig: StereoRig) -> tuple[tuple[Intrinsics, Pose], tuple[Intrinsics, Pose]]:
    """Both cameras with ``camera_from_rig``."""
    left_from_rig = rig.rig_from_left.inverse
    return (rig.left, left_from_rig), (rig.right, rig.right_from_left @ left_from_rig)


def _edge_columns(camera: Intrinsics) -> tuple[float, float]:
    """Normalised x of the image's left and right edge on the row of the principal point."""
    uv = np.array([[-0.5, camera.cy], [camera.width - 0.5, camera.cy]])
    edges = camera.normalize(uv)[:, 0]
    if np.isnan(edges).any():
        raise InvalidRig("lens distortion: the image's edges lie beyond where the lens can be inverted")
    return float(edges[0]), float(edges[1])


def _edges(camera: Intrinsics, camera_from_rig: Pose) -> _Edges:
    """The camera's horizontal field of view as a wedge on the mid plane."""
    R, center = camera_from_rig.R, camera_from_rig.inverse.t
    axis_rad = math.atan2(R[2, 0], R[2, 2])
    angles, bounds = [], []
    for sign, column in zip((1, -1), _edge_columns(camera), strict=True):
        # seen where sign (x_camera - column z_camera) >= 0, a half plane A x + C z >= 0 from the centre
        A, C = (sign * (R[0, axis] - column * R[2, axis]) for axis in (0, 2))
        # the edge is the direction (C, -A) or (-C, A): the one within 90 degrees of the optical axis
        edge_rad = math.atan2(C, -A) if -A * R[2, 2] + C * R[2, 0] > 0 else math.atan2(-C, A)
        angles.append(axis_rad + math.remainder(edge_rad - axis_rad, 2 * math.pi))
        if A != 0:
            slope = -C / A
            bounds.append(_Bound(slope, center[0] - slope * center[2], A > 0))
    return _Edges(min(angles), max(angles), tuple(bounds))


def _common_stretch(rig: StereoRig, depth: Array) -> tuple[Array, Array]:
    """Both ends, x (...) m in the rig's frame, of what both cameras see at `depth` (...) m."""
    lower, upper = np.full(depth.shape, -np.inf), np.full(depth.shape, np.inf)
    for camera, pose in _cameras(rig):
        for bound in _edges(camera, pose).bounds:
            x = bound.slope * depth + bound.offset
            lower, upper = (np.maximum(lower, x), upper) if bound.is_lower else (lower, np.minimum(upper, x))
    return lower, upper


def _left_column(rig: StereoRig, x: Array, depth: Array) -> Array:
    """Column (...) of the left image, clipped to it, where it sees x (...) m of the mid plane."""
    camera, left_from_rig = _cameras(rig)[0]
    far = np.isinf(x)
    points = np.stack([np.where(far, np.sign(x), x), np.zeros_like(x), np.where(far, 0.0, depth)], axis=-1)
    in_left = points @ left_from_rig.R.T + np.where(far[..., None], 0.0, left_from_rig.t)
    u = camera.project(in_left)[..., 0]
    beyond = np.where(x > 0, np.inf, -np.inf)
    return np.asarray(np.clip(np.where(np.isnan(u), beyond, u), -0.5, camera.width - 0.5))
