"""Depth error per unit of miscalibration: the true rig is ``perturbation.apply(assumed)``.

Points are metres in the left camera's frame; each value is dZ per unit of the named field of
`Perturbation`: m/rad, m/m, m/px, or m per unit of k1.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRig
from rigsim.rig import given
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady, are_brown
from rigsim.rig.perturbation import NAMES
from rigsim.rig.stereo import StereoRig
from rigsim.theory.uncertainty import pixel_gain


def depth_sensitivity(rig: StereoRig, points_left: npt.ArrayLike) -> dict[str, Array]:
    """Depth error (N,) m per unit of each of the ten perturbations, in the order of their fields.

    First order and analytic for any rig, `optimal` triangulating with the assumed `rig`: the pixels
    move by their derivative in the perturbation, the depth follows through ``(J^T J)^-1 J^T``.
    NaN behind a camera, and for k1 of a lens that has none.

    Example:
        >>> import rigsim
        >>> table = rigsim.depth_sensitivity(rigsim.preset("bin").rig, [[0, 0, 2.0]])
        >>> round(float(table["baseline_m"][0]), 3)  # too long a baseline: Z / B too short, m per m
        -33.333
    """
    given.a(StereoRig, rig, "a StereoRig: the rig", InvalidRig)
    points = given.points(points_left)
    right, right_from_left = rig.right, rig.right_from_left
    points_right = right_from_left.apply(points)
    gain = pixel_gain(rig, points)[:, 2]
    gain_left, gain_right = gain[:, :2], gain[:, 2:]
    # a turn w of the camera's body moves the point by -w x P in its frame
    turns = {
        name: -np.cross(axis, points_right)
        for name, axis in zip(("pitch_rad", "yaw_rad", "roll_rad"), np.eye(3), strict=True)
    }
    along_baseline = right_from_left.inverse.t / rig.baseline_m
    shifts = {
        name: np.broadcast_to(-right_from_left.R @ direction, points.shape)
        for name, direction in (
            ("baseline_m", along_baseline),
            ("axial_m", np.array([0.0, 0.0, 1.0])),
            ("vertical_m", np.array([0.0, 1.0, 0.0])),
        )
    }
    depth_per_move = np.einsum("ni,nij->nj", gain_right, right.jacobian(points_right))
    result = {name: np.einsum("nj,nj->n", depth_per_move, move) for name, move in (turns | shifts).items()}

    distorted = (right.project(points_right) - (right.cx, right.cy)) / (right.fx, right.fy)
    result["right_focal_px"] = np.einsum("ni,ni->n", gain_right, distorted)
    result["right_cx_px"] = gain_right[:, 0].copy()
    result["right_k1"] = np.einsum("ni,ni->n", gain_right, _k1_motion(right, points_right))
    result["both_k1"] = result["right_k1"] + np.einsum("ni,ni->n", gain_left, _k1_motion(rig.left, points))
    return {name: result[name] for name in NAMES}


def _k1_motion(camera: Intrinsics, points_camera: Array) -> Array:
    """Derivative (N, 2) px of the projection in k1, ``f x r^2``; NaN for a lens that has none."""
    if not are_brown(camera.distortion):
        return np.full((len(points_camera), 2), np.nan)
    ideal = Intrinsics(1, 1, 1.0, 1.0, 0.0, 0.0).project(points_camera)
    unit = BrownConrady(k1=1.0).distort(ideal) - ideal
    return np.asarray(unit * (camera.fx, camera.fy))
