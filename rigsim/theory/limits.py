"""What a rig can see at all: search ranges, overlap, blind zone and the size of one step.

Z is the left camera's, along its optical axis, as everywhere. Fields of view are compared as the true
frusta (`rigsim.theory.frusta`): any pose, any lens.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.theory.frusta import Shared, nearest_common_depth, outline, shared_view
from rigsim.theory.uncertainty import predict_depth_std

_ALONG = 4097
_LINES = 33
_ENDLESS = 1e3
"""Extents in depths beyond which a lens shows the plane's points next to 90 degrees off its axis."""


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


class Shift(NamedTuple):
    """Disparity shifts, px, with which a search reaches what was asked for."""

    least_px: float
    """Least shift that reaches the near end."""
    most_px: float
    """Greatest shift that still reaches the far end; infinite when no far end was asked for."""


def shifts_for_range(
    rig: StereoRig,
    near_m: float,
    far_m: float | None,
    max_disparity_px: float,
    min_disparity_px: float = 0.0,
) -> Shift:
    """Shifts with which a search of these disparities reaches from `near_m` to `far_m`.

    ``fx b / near - doffs - max`` and ``fx b / far - doffs - min``; none will do where the first is the
    greater one: the search is too short for the range.

    Raises:
        InvalidRig: the rig is not rectified.
    """
    if not rig.is_rectified:
        raise InvalidRig("disparity shift: the rig is not rectified: give the rig of the rectified images")
    fx_b, doffs = rig.left.fx * rig.baseline_m, rig.doffs_px
    least = fx_b / near_m - doffs - max_disparity_px
    return Shift(least, math.inf if far_m is None else fx_b / far_m - doffs - min_disparity_px)


def field_of_view_deg(camera: Intrinsics) -> tuple[float, float]:
    """Horizontal and vertical angle, deg, that the camera sees, where it is widest; distortion included.

    Of a lens that may show more than a half space, in the row and the column of its principal point.
    """
    if camera.is_wide:
        return camera.hfov_deg, camera.vfov_deg
    x, y = np.arctan(outline(camera)[:, :2]).T
    return math.degrees(x.max() - x.min()), math.degrees(y.max() - y.min())


def overlap_fov_deg(rig: StereoRig) -> tuple[float, float]:
    """Horizontal and vertical angle, deg, in the left camera's frame, of what both cameras see far away;
    0 and 0 when they share nothing there."""
    if rig.left.is_wide:
        return _shared_far_deg(rig, 0), _shared_far_deg(rig, 1)
    shared = shared_view(rig, 0.0)
    if not shared.share:
        return 0.0, 0.0
    x, y = np.arctan(_rays(rig, shared)).T
    return math.degrees(x.max() - x.min()), math.degrees(y.max() - y.min())


def _shared_far_deg(rig: StereoRig, axis: int) -> float:
    """Angle, deg, that both cameras see far away along the left principal point's row (0) or column (1), or
    along the nearest that shows something to both."""
    camera = rig.left
    size, center = (camera.width, camera.height), (camera.cx, camera.cy)
    lines = np.append(np.linspace(0, size[1 - axis] - 1, _LINES), center[1 - axis])
    lines = lines[(lines >= -0.5) & (lines <= size[1 - axis] - 0.5)]
    for line in lines[np.argsort(np.abs(lines - center[1 - axis]))]:
        uv = np.full((_ALONG, 2), line)
        uv[:, axis] = np.linspace(-0.5, size[axis] - 0.5, _ALONG)
        rays = camera.ray(uv)
        shown = rig.right.contains(rig.right.project(rays @ rig.right_from_left.R.T))
        angles = np.degrees(np.arctan2(rays[:, axis], rays[:, 2]))[shown]
        if angles.size:
            return float(np.ptp(angles))
    return 0.0


class Overlap(NamedTuple):
    """What both cameras see at a depth; extents are those of its bounding box."""

    width_m: Array
    """Extent along the left image's rows, m; 0 where they share nothing."""
    fraction: Array
    """Share of the left image's pixels that show it, 0 to 1."""
    height_m: Array
    """Extent along the left image's columns, m."""
    columns_px: Array
    """Columns of the left image that show any of it, px; NaN where it goes on beside the camera."""
    rows_px: Array
    """Rows of the left image that show any of it, px."""


def overlap_at_depth(rig: StereoRig, depth_m: npt.ArrayLike) -> Overlap:
    """What both cameras see of the plane at the left camera's Z = `depth_m` (...); NaN unless it is > 0."""
    depth = np.asarray(depth_m, dtype=np.float64)
    found = np.full((5, depth.size), np.nan)
    for place, z in enumerate(depth.ravel()):
        if z > 0:
            shared = shared_view(rig, 1 / z)
            found[:, place] = 0.0
            if shared.share:
                width, height = _extents(rig, shared) * z
                columns, rows = np.ptp(shared.corners_uv, axis=0)
                if not np.isfinite(width):  # the image has columns that show no plane ahead
                    columns = np.nan
                if not np.isfinite(height):
                    rows = np.nan
                found[:, place] = width, shared.share, height, columns, rows
    return Overlap(*found.reshape(5, *depth.shape))


def dead_band_px(rig: StereoRig, depth_m: npt.ArrayLike) -> Array:
    """Columns (...) px of the left image in which the right camera sees nothing at `depth_m` (...).

    ``f B / Z`` for a rectified rig of two equal cameras.
    """
    return np.asarray(rig.left.width - overlap_at_depth(rig, depth_m).columns_px)


def blind_zone_m(rig: StereoRig) -> float:
    """Depth Z, m, before which no point at all is seen by both cameras; infinite if none ever is.

    ``f B / W`` for a rectified rig of two equal cameras.
    """
    return nearest_common_depth(rig)


def depth_step_m(rig: StereoRig, depth_m: npt.ArrayLike, disparity_step_px: npt.ArrayLike = 1.0) -> Array:
    """Depth (...) m between two neighbouring disparities at `depth_m` (...) on the left optical axis.

    First order, ``Z^2 step / (f B)`` when rectified, and for any rig the standard deviation of the depth
    for a disparity noise of one step; `depth_bounds` is exact. NaN behind a camera.
    """
    depth = np.asarray(depth_m, dtype=np.float64)
    on_axis = np.zeros((depth.size, 3))
    on_axis[:, 2] = depth.ravel()
    with np.errstate(all="ignore"):
        step = predict_depth_std(rig, on_axis, PixelNoise(math.sqrt(0.5))).reshape(depth.shape)
    return np.asarray(step * np.asarray(disparity_step_px, dtype=np.float64))


def world_per_pixel_m(rig: StereoRig, depth_m: npt.ArrayLike) -> Array:
    """Width (...) m that one column covers in the middle of the left image at `depth_m` (...): ``Z / fx``."""
    return np.asarray(np.asarray(depth_m, dtype=np.float64) / rig.left.axial_focal_px[0])


def _extents(rig: StereoRig, shared: Shared) -> Array:
    """Width and height (2,) of what is shared, in depths; infinite where it goes on beside the camera."""
    extents = np.ptp(_rays(rig, shared), axis=0)
    return np.where(extents < _ENDLESS, extents, np.inf) if rig.left.is_wide else extents


def _rays(rig: StereoRig, shared: Shared) -> Array:
    """x/z and y/z (K, 2) of its corners; those a lens does not show are left out."""
    xy = rig.left.normalize(shared.corners_uv)
    return np.asarray(xy[np.isfinite(xy).all(axis=1)])
