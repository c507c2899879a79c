"""Row misalignment: how far below a point's row in the left image its row in the right one lies, px.

A row matcher looks for a left pixel's partner on the same row of the right image. Rows are those of the pair
that is rectified with the calibration a rig is taken for: both images are turned about their camera's centre
until the rows run along the baseline, at the mean focal length (a rectified rig's are left alone). A ray r
of the left camera's frame then has the row ``f (y . r) / (z . r)``, with the axis y across the rows and the
axis z forward. What the true rig is off by moves its pixels, and with them the rows; in a rectified rig, of
a point at depth Z with the ideal position (x, y) px from the middle of the right image, by

- pitch: ``f (1 + y^2 / f^2)`` px/rad; roll: -x; yaw: ``-x y / f``;
- a right camera that is lower by dy: ``-f dy / Z``; further forward by dz: ``y dz / Z``;
- the right focal length: ``y / f`` px/px; the right principal point's v: 1; k1: ``y r^2 / f^2``.

A baseline that is off, a focal length that both share and a principal point's u leave rows where they are.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRig
from rigsim.rig import given
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.perturbation import NAMES
from rigsim.rig.stereo import StereoRig
from rigsim.theory.sensitivity import MORE, pixel_moves

_FLAT_DEG = 75.0
"""Rows are those of a flat picture, which shows no ray further off its axis."""
LEAST_ANGLE_DEG = 30.0
"""Cameras that look less than this off their baseline have no rows that correspond."""


def row_sensitivity(
    rig: StereoRig, points_left: npt.ArrayLike, *, rectified: bool = True
) -> dict[str, Array]:
    """Row misalignment (N,) px per unit of each of the ten perturbations and of `MORE`; first order.

    Points (N, 3) are metres in the left camera's frame; each value is px per unit of the named quantity of
    `Perturbation`: px/rad, px/m, px/px, or px per unit of k1. NaN behind a camera, and of
    cameras that look along their baseline: no rows of theirs correspond.

    Args:
        rig: the rig as it is taken for.
        points_left: the points.
        rectified: rows of the pair that `rig` rectifies; else rows of the images as they are seen.

    Example:
        >>> import rigsim
        >>> rig = rigsim.StereoRig.rectified(rigsim.Intrinsics.from_focal(1280, 720, 900.0), 0.12)
        >>> rows = rigsim.row_sensitivity(rig, [[0.06, 0, 1.0]])
        >>> round(0.003 * float(rows["vertical_m"][0]), 6)  # 3 mm too low: 900 px x 3 mm / 1 m too high
        -2.7
    """
    given.a(StereoRig, rig, "a StereoRig: the rig", InvalidRig)
    points = given.points(points_left)
    moves = pixel_moves(rig, points)
    gain = row_gain(rig, points) if rectified else np.array([0.0, -1.0, 0.0, 1.0])
    return {name: np.asarray((gain * moves[name]).sum(axis=1)) for name in (*NAMES, *MORE)}


def row_gain(rig: StereoRig, points: Array) -> Array:
    """How rows at points (N, 3) m follow (u_left, v_left, u_right, v_right), (N, 4) px/px."""
    if rig.is_rectified:
        return np.broadcast_to([0.0, -1.0, 0.0, 1.0], (len(points), 4))
    rotation = rig.right_from_left.R
    axes = row_axes(rotation, rig.right_from_left.t)
    focal_px = row_focal_px(rig)
    left = _gain(rig.left, points, axes, focal_px)
    turned = (rotation @ axes[0], rotation @ axes[1])
    return np.hstack([-left, _gain(rig.right, rig.right_from_left.apply(points), turned, focal_px)])


def row_axes(R: Array, t: Array) -> tuple[Array, Array]:
    """Axes (..., 3) across the rows and forward, in the left camera's frame, of rows along the baseline.

    Of any number of rigs at once, by rotations (..., 3, 3) and shifts (..., 3) from left to right. Forward is
    half way between both cameras', as far as that is square to the baseline; NaN where they look less than
    `LEAST_ANGLE_DEG` off the baseline.
    """
    along = -np.einsum("...ji,...j->...i", R, t)
    forward = R[..., 2, :] + (0.0, 0.0, 1.0)
    with np.errstate(all="ignore"):
        along = along / np.linalg.norm(along, axis=-1, keepdims=True)
        forward = forward / np.linalg.norm(forward, axis=-1, keepdims=True)
        across = np.cross(forward, along)
        sine = np.linalg.norm(across, axis=-1, keepdims=True)
        across = across / np.where(sine >= math.sin(math.radians(LEAST_ANGLE_DEG)), sine, np.nan)
    return across, np.cross(along, across)


def row_focal_px(rig: StereoRig) -> float:
    """Focal length of a rectified pair, px: a rectified rig's own, else the mean of all four."""
    left, right = rig.left, rig.right
    return left.fy if rig.is_rectified else (left.fx + left.fy + right.fx + right.fy) / 4


def _gain(camera: Intrinsics, points: Array, axes: tuple[Array, Array], focal_px: float) -> Array:
    """Derivative (N, 2) of the row in the pixel of points (N, 3) m; all in the camera's own frame."""
    across, forward = axes
    with np.errstate(all="ignore"):
        z = np.where(points[:, 2] > 0, points[:, 2], np.nan)
        ray = points / z[:, None]
        ahead = (ray @ forward)[:, None]
        if camera.is_wide:
            sides = np.linalg.norm(ray, axis=1)[:, None] * math.cos(math.radians(_FLAT_DEG))
            ahead = np.where(ahead > sides, ahead, np.nan)
        per_ray = focal_px * (across[:2] * ahead - forward[:2] * (ray @ across)[:, None]) / ahead**2
        # the lens's part of it: pixels per ideal position
        a, b, c, d = camera.jacobian(ray)[:, :, :2].reshape(-1, 4).T
        x, y = per_ray.T
        return np.stack([x * d - y * c, y * a - x * b], axis=1) / (a * d - b * c)[:, None]
