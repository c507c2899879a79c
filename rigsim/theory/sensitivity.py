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

MORE = ("right_cy_px", "both_focal_px", "left_focal_px", "left_cx_px", "left_cy_px")
"""Quantities of `pixel_moves` that `Perturbation` has not; `left_focal_px` and `both_focal_px` are px
of the left fx, and the other focal lengths grow in proportion."""


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
    gain, moves = pixel_gain(rig, points)[:, 2], pixel_moves(rig, points)
    return {name: np.einsum("ni,ni->n", gain, moves[name]) for name in NAMES}


def pixel_moves(rig: StereoRig, points: Array) -> dict[str, Array]:
    """Move (N, 4) px of (u_left, v_left, u_right, v_right) per unit of each of `NAMES`, and of `MORE`.

    NaN behind a camera.
    """
    right, right_from_left = rig.right, rig.right_from_left
    points_right = right_from_left.apply(points)
    # a turn w of the camera's body moves the point by -w x P in its frame
    in_space = {
        name: -np.cross(axis, points_right)
        for name, axis in zip(("pitch_rad", "yaw_rad", "roll_rad"), np.eye(3), strict=True)
    }
    along_baseline = right_from_left.inverse.t / rig.baseline_m
    for name, direction in (
        ("baseline_m", along_baseline),
        ("axial_m", np.array([0.0, 0.0, 1.0])),
        ("vertical_m", np.array([0.0, 1.0, 0.0])),
    ):
        in_space[name] = np.broadcast_to(-right_from_left.R @ direction, points.shape)
    jacobian = right.jacobian(points_right)
    seen = {name: np.einsum("nij,nj->ni", jacobian, move) for name, move in in_space.items()}
    along_u, along_v = (np.broadcast_to(axis, (len(points), 2)) for axis in np.eye(2))
    from_centre = right.project(points_right) - (right.cx, right.cy)
    from_centre_left = rig.left.project(points) - (rig.left.cx, rig.left.cy)
    k1_left, k1_right = _k1_motion(rig.left, points), _k1_motion(right, points_right)
    seen |= {
        "right_focal_px": from_centre / (right.fx, right.fy),
        "right_cx_px": along_u,
        "right_cy_px": along_v,
        "right_k1": k1_right,
    }
    still = np.zeros((len(points), 2))
    found = {name: np.hstack([still, move]) for name, move in seen.items()}
    found["both_k1"] = np.hstack([k1_left, k1_right])
    found["both_focal_px"] = np.hstack([from_centre_left, from_centre]) / rig.left.fx
    found["left_focal_px"] = np.hstack([from_centre_left, still]) / rig.left.fx
    found["left_cx_px"], found["left_cy_px"] = np.hstack([along_u, still]), np.hstack([along_v, still])
    return found


def _k1_motion(camera: Intrinsics, points_camera: Array) -> Array:
    """Derivative (N, 2) px of the projection in k1, ``f x r^2``; NaN for a lens that has none."""
    if not are_brown(camera.lens):
        return np.full((len(points_camera), 2), np.nan)
    ideal = Intrinsics(1, 1, 1.0, 1.0, 0.0, 0.0).project(points_camera)
    unit = BrownConrady(k1=1.0).distort(ideal) - ideal
    return np.asarray(unit * (camera.fx, camera.fy))
