"""Poses as other programs write them: a matrix [R | t], or two rectifying turns and two projections."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.values import matrix, member, reals, rotation
from rigsim.rig.arrays import Array
from rigsim.rig.pose import Pose

_ROUNDED = 1e-6


def rigid(value: object, name: str) -> Pose:
    """The pose of a matrix (4, 4) or (3, 4), a list of rows or of all its numbers, or under ``data``.

    Raises:
        InvalidRig: it is none; the message calls it `name`.
    """
    if isinstance(value, Mapping):
        value = member(value, "data", name)
    rows = 3 if isinstance(value, list) and len(value) in (3, 12) else 4
    T = matrix(value, name, rows, 4)
    if rows == 4 and np.abs(T[3] - (0, 0, 0, 1)).max() > _ROUNDED:
        raise InvalidRig(f"{name}: its last row is {reals(T[3])}, must be 0, 0, 0, 1")
    return Pose(rotation(T[:3, :3], name), T[:3, 3])


def offset(P: Array, name: str) -> Array:
    """``t`` (3,) of a projection ``P = K [1 | t]`` (3, 4), in the unit of its last column over px.

    Raises:
        InvalidRig: its K has skew, or no focal length.
    """
    fx, fy = float(P[0, 0]), float(P[1, 1])
    if not (fx > 0 and fy > 0):
        raise InvalidRig(f"{name}: focal lengths {fx:g} and {fy:g}: must be > 0")
    if not (P[0, 1] == P[1, 0] == 0 and (P[2, :3] == (0, 0, 1)).all()):
        row = " ".join(f"{item:g}" for item in (P[0, 1], P[1, 0], *P[2, :3]))
        raise InvalidRig(f"{name}: must be [fx 0 cx ..; 0 fy cy ..; 0 0 1 ..], without skew (found {row})")
    x, y, z = (float(value) for value in P[:, 3])
    return np.array([(x - P[0, 2] * z) / fx, (y - P[1, 2] * z) / fy, z])


def rectified_pose(turns: tuple[Array, Array], projections: tuple[Array, Array], name: str) -> Pose:
    """Right from left of two cameras whose `turns` (3, 3) make them parallel, seen by (3, 4) after that.

    Raises:
        InvalidRig: as `offset`.
    """
    left, right = (offset(P, name) for P in projections)
    return Pose(turns[1].T @ turns[0], turns[1].T @ (right - left))
