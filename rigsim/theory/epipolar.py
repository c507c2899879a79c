"""Where a point on a left ray moves in the right image as its depth changes; any rig."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig


class EpipolarMotion(NamedTuple):
    """At depth Z on the left ray the right camera sees homogeneous ``Z a + b``, ideal pixels.

    Along its epipolar line the image therefore moves ``speed (Z - Z0) / (w w0)`` px between two depths.
    """

    speed: Array
    """``|a_xy b_z - b_xy a_z|``, (N,), px m; f B when rectified."""
    infinity_depth: Array
    """a_z, (N,): gain of depth in the right camera per depth in the left one."""
    depth_right: Array
    """w0, depth of the point in the right camera, (N,), m."""


def epipolar_motion(rig: StereoRig, points_left: npt.ArrayLike) -> EpipolarMotion:
    """Motion of points (N, 3) m of the left camera's frame; NaN behind a camera."""
    points = np.asarray(points_left, dtype=np.float64)
    right, pose = rig.right, rig.right_from_left
    z = points[:, 2]
    with np.errstate(all="ignore"):
        ray = points / np.where(z > 0, z, np.nan)[:, None]
        a = ray @ pose.R.T * (right.fx, right.fy, 1.0)
        b = pose.t * (right.fx, right.fy, 1.0)
        speed = np.hypot(*(a[:, :2] * b[2] - b[:2] * a[:, 2:]).T)
        depth_right = z * a[:, 2] + b[2]
        depth_right = np.where(depth_right > 0, depth_right, np.nan)
    return EpipolarMotion(speed + 0 * depth_right, a[:, 2] + 0 * depth_right, depth_right)
