"""Any pair made into one whose rows correspond.

Both images are turned about their camera's centre until the rows run along the baseline (Fusiello,
Trucco & Verri, "A compact algorithm for rectification of stereo pairs", 2000) and resampled once
with a spline. A rectified rig's images are left alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from rigsim.errors import MeasurementFailed
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

_LEAST_ANGLE_DEG = 30.0
_LARGEST_GROWTH = 2.0


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


def rectify(rig: StereoRig) -> Rectification:
    """Find the rectified rig nearest to `rig`; `rig` itself when it is rectified.

    The rows kept are those both cameras see, at the focal length of the original.

    Raises:
        MeasurementFailed: the cameras look along the baseline, or away from each other, so that no
            rectified image holds what they see.
    """
    if rig.is_rectified:
        return Rectification(rig, rig, np.eye(3), np.eye(3))
    rectified_from_left, rectified_from_right = row_rotations(rig)

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
    rays = np.concatenate([lens_a.normalize(uv), np.ones((*uv.shape[:-1], 1))], axis=-1)
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
