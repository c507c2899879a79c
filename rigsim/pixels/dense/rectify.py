"""Any pair made into one whose rows correspond.

Both images are turned about their camera's centre until the rows run along the baseline (Fusiello,
Trucco & Verri, "A compact algorithm for rectification of stereo pairs", 2000) and resampled once
with a spline. A rectified rig's images are left alone. Where perspective pictures would need over 120
degrees, rows are half planes about the baseline instead (`rigsim.pixels.dense.views`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from rigsim.errors import MeasurementFailed
from rigsim.pixels.dense.views import AxialView, Cylinder, LatLong, RowView
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.lens import ahead
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

_LEAST_ANGLE_DEG = 30.0
_LARGEST_GROWTH = 2.0
_MOST_PERSPECTIVE_DEG = 120.0
_MOST_LATLONG_DEG = 160.0  # towards the baseline itself nothing has a distance
_SEEN_ALONG_DEG = 60.0  # how far along the rows those are told by which both cameras show
_GRID = 97


@dataclass(frozen=True, slots=True, eq=False)
class Rectification:
    """A rectified rig in the place of another one."""

    rig: StereoRig
    """The rectified rig: same centres, parallel axes."""
    source: StereoRig
    """The rig it stands for."""
    rectified_from_left: Array
    """Rotation (3, 3) of the left camera."""
    rectified_from_right: Array
    """Rotation (3, 3) of the right camera."""

    @property
    def view(self) -> RowView:
        """What the rectified pictures are."""
        lens = self.rig.left.lens
        if isinstance(lens, AxialView):
            return "cylinder" if isinstance(lens, Cylinder) else "latlong"
        return "perspective"

    def right_scale(self, uv: Array) -> Array:
        """How many px of the original right image one px along a rectified row is, (N,), at (N, 2)."""
        half = np.array([0.5, 0.0])
        ends = self.right_pixels(uv + half) - self.right_pixels(uv - half)
        return np.asarray(np.linalg.norm(ends, axis=-1))

    def left_pixels(self, uv: Array) -> Array:
        """Positions (..., 2) of the rectified left image in the original one, px."""
        return _turn(uv, self.rig.left, self.rectified_from_left.T, self.source.left)

    def right_pixels(self, uv: Array) -> Array:
        """Positions (..., 2) of the rectified right image in the original one, px."""
        return _turn(uv, self.rig.right, self.rectified_from_right.T, self.source.right)

    def warp(self, image_left: Array, image_right: Array) -> tuple[Array, Array, Mask, Mask]:
        """The rectified images (H, W), and where each lies on its original."""
        if self.rig is self.source:
            everywhere = np.ones(image_left.shape, dtype=bool)
            return image_left, image_right, everywhere, everywhere
        lens = self.rig.left
        v, u = np.mgrid[: lens.height, : lens.width]
        grid = np.stack([u, v], axis=-1).astype(np.float64)
        left, on_left = _resample(image_left, self.left_pixels(grid))
        right, on_right = _resample(image_right, self.right_pixels(grid))
        return left, right, on_left, on_right


def rectify(rig: StereoRig, view: RowView | None = None) -> Rectification:
    """Find the rectified rig nearest to `rig`; `rig` itself when it is rectified.

    The rows kept are those both cameras see, at the focal length of the original.

    Args:
        rig: the rig.
        view: what the pictures become; by default perspective where that needs no more than 120 degrees,
            else a cylinder where the rows do not, else longitude and latitude. A perspective view of a lens
            that sees more keeps its middle 120 degrees.

    Raises:
        MeasurementFailed: the cameras look along the baseline, or away from each other, so that no
            rectified image holds what they see.
    """
    if isinstance(rig.left.lens, AxialView) or (rig.is_rectified and view in (None, "perspective")):
        return Rectification(rig, rig, np.eye(3), np.eye(3))
    turns = row_rotations(rig)
    wide = rig.left.is_wide or rig.right.is_wide
    chosen = view or (_needed(rig, turns) if wide else "perspective")
    if wide or chosen != "perspective":
        return Rectification(_in_view(rig, turns, chosen), rig, *turns)
    return _of_planar(rig, *turns)


def _needed(rig: StereoRig, turns: tuple[Array, Array]) -> RowView:
    """The plainest view that holds what both cameras see."""
    along, about = _seen_deg(rig, turns)
    if np.ptp(along) <= _MOST_PERSPECTIVE_DEG:
        return "perspective" if np.ptp(about) <= _MOST_PERSPECTIVE_DEG else "cylinder"
    return "latlong"


def _seen_deg(rig: StereoRig, turns: tuple[Array, Array]) -> tuple[Array, Array]:
    """First and last angle, deg, along the rows that one camera sees, and about the baseline that both do."""
    ends = []
    for camera, turn in zip((rig.left, rig.right), turns, strict=True):
        u, v = np.meshgrid(
            np.linspace(-0.5, camera.width - 0.5, _GRID), np.linspace(-0.5, camera.height - 0.5, _GRID)
        )
        rays = camera.ray(np.column_stack([u.ravel(), v.ravel()]))
        x, y, z = (rays[np.isfinite(rays[:, 2])] @ turn.T).T
        along, about = np.degrees(np.arctan2(x, np.hypot(y, z))), np.degrees(np.arctan2(y, z))
        middle = np.abs(along) < _SEEN_ALONG_DEG
        if not middle.any():
            raise MeasurementFailed("the cameras see nothing across their baseline: no rows correspond")
        ends.append((along.min(), along.max(), about[middle].min(), about[middle].max()))
    low, high = np.min(ends, axis=0), np.max(ends, axis=0)
    if not high[2] < low[3]:
        raise MeasurementFailed("the two cameras' views are too far apart: no rows are seen by both")
    return np.array([low[0], high[1]]), np.array([high[2], low[3]])


def _in_view(rig: StereoRig, turns: tuple[Array, Array], view: RowView) -> StereoRig:
    """Two equal cameras of a view, in the places of a rig's."""
    along, about = (np.radians(ends) for ends in _seen_deg(rig, turns))
    most = math.radians(_MOST_LATLONG_DEG if view == "latlong" else _MOST_PERSPECTIVE_DEG) / 2
    along = along.clip(-most, most)
    lens = {"perspective": None, "cylinder": Cylinder(), "latlong": LatLong()}[view]
    axis = np.array([0.0, 0.0, 1.0])
    scales = [abs(np.linalg.det(camera.jacobian(axis)[:, :2])) ** 0.5 for camera in (rig.left, rig.right)]
    focal = float(np.mean(scales))
    if view != "latlong":
        along = np.tan(along)
    if view == "perspective":
        about = np.tan(about.clip(-most, most))
    width, height = math.floor(focal * float(np.ptp(along))), math.floor(focal * float(np.ptp(about)))
    if min(width, height) < 1:
        raise MeasurementFailed(f"a rectified pair would be {width} x {height} px: nothing is seen by both")
    cx, cy = -0.5 - focal * float(along[0]), -0.5 - focal * float(about[0])
    camera = Intrinsics(width, height, focal, focal, cx, cy, lens)
    return StereoRig(camera, camera, Pose(np.eye(3), np.array([-rig.baseline_m, 0.0, 0.0])))


def _of_planar(rig: StereoRig, rectified_from_left: Array, rectified_from_right: Array) -> Rectification:
    focal = (rig.left.fx + rig.left.fy + rig.right.fx + rig.right.fy) / 4
    left = _outline(rig.left, rectified_from_left)
    right = _outline(rig.right, rectified_from_right)
    top, bottom = max(left[:, 1].min(), right[:, 1].min()), min(left[:, 1].max(), right[:, 1].max())
    width = math.ceil(focal * max(np.ptp(left[:, 0]), np.ptp(right[:, 0])))
    height = math.ceil(focal * (bottom - top))
    area, source_area = width * height, rig.left.width * rig.left.height
    if not (height > 0 and area < _LARGEST_GROWTH**2 * source_area):
        raise MeasurementFailed(
            f"a rectified pair would be {width} x {height} px: the two cameras' views are too far apart"
        )

    def lens(outline: Array) -> Intrinsics:
        return Intrinsics(
            width, height, focal, focal, -0.5 - focal * float(outline[:, 0].min()), -0.5 - focal * float(top)
        )

    rectified = StereoRig(lens(left), lens(right), Pose(np.eye(3), np.array([-rig.baseline_m, 0.0, 0.0])))
    return Rectification(rectified, rig, rectified_from_left, rectified_from_right)


def row_rotations(rig: StereoRig) -> tuple[Array, Array]:
    """Rotations (3, 3) of the left and the right camera after which their rows run along the baseline.

    Raises:
        MeasurementFailed: the cameras look along the baseline, or away from each other.
    """
    left_from_right = rig.right_from_left.inverse
    x = left_from_right.t / rig.baseline_m
    forward = np.array([0.0, 0.0, 1.0]) + left_from_right.R[:, 2]
    across = np.cross(forward, x)
    norm, length = float(np.linalg.norm(across)), float(np.linalg.norm(forward))
    angle_deg = math.degrees(math.atan2(norm, abs(float(forward @ x))))
    if length < 1.0 or angle_deg < _LEAST_ANGLE_DEG:
        raise MeasurementFailed(
            f"the cameras look {angle_deg:.0f} deg off their baseline: rows can correspond only from "
            f"{_LEAST_ANGLE_DEG:g} deg on"
        )
    y = across / norm
    rectified_from_left = np.stack([x, y, np.cross(x, y)])
    return rectified_from_left, rectified_from_left @ left_from_right.R


def _turn(uv: Array, lens_a: Intrinsics, b_from_a: Array, lens_b: Intrinsics) -> Array:
    rays = lens_a.ray(uv) if lens_a.is_wide else ahead(lens_a.normalize(uv))
    return lens_b.project(rays @ b_from_a.T)


def _outline(lens: Intrinsics, rectified_from_camera: Array) -> Array:
    """Normalised rectified coordinates (N, 2) of the image's border."""
    u = np.linspace(-0.5, lens.width - 0.5, 65)
    v = np.linspace(-0.5, lens.height - 0.5, 65)
    border = [np.stack([u, np.full_like(u, end)], axis=-1) for end in (v[0], v[-1])]
    border += [np.stack([np.full_like(v, end), v], axis=-1) for end in (u[0], u[-1])]
    xy = lens.normalize(np.concatenate(border))
    rays = np.concatenate([xy, np.ones((len(xy), 1))], axis=-1) @ rectified_from_camera.T
    if not (rays[:, 2] > 0.1).all():
        raise MeasurementFailed("the cameras are turned too far from each other to be rectified")
    return np.asarray(rays[:, :2] / rays[:, 2:])


def _resample(image: Array, uv: Array) -> tuple[Array, Mask]:
    height, width = image.shape
    inside = (uv >= 0).all(axis=-1) & (uv[..., 0] <= width - 1) & (uv[..., 1] <= height - 1)
    at = np.where(inside[..., None], uv, 0.0)
    values = ndimage.map_coordinates(image, [at[..., 1], at[..., 0]], order=5, mode="mirror")
    return np.where(inside, values, image.mean()), inside
