"""Epipolar geometry of any rig: where a point on a left ray moves in the right image as its depth changes,
and how far two pixels are from belonging together."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.lens import ahead
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


class PairGap(NamedTuple):
    """How two pixels (N,) of a pair lie to each other; NaN where a lens shows nothing there."""

    off_px: Array
    """Least change of the four coordinates, px in all, after which their rays meet; to first order, signed:
    positive where the right pixel lies too low. ``(v_right - v_left) / sqrt(2)`` when rectified."""
    off_std_px: Array
    """Its standard deviation for the noise of a right pair, px; the coordinate's own where noise is equal."""
    disparity_px: Array
    """Disparity that is left at infinity, px: positive where rays meet in front of the cameras, negative
    where they part. To first order; ``u_left - u_right + doffs`` when rectified."""


def pair_gap(
    rig: StereoRig, uv_left: npt.ArrayLike, uv_right: npt.ArrayLike, covariance_px2: npt.ArrayLike
) -> PairGap:
    """How far pixels (N, 2) of both images are from being those of one point; lens distortion undone.

    With left and right rays r and q in one frame and C the right camera's centre, ``e = r . (C x q)`` is zero
    for a right pair; ``e / |de/duv|`` is its distance to that in pixels (Sampson's). Its square over its
    variance is a chi squared with one degree of freedom. Source: Hartley and Zisserman, "Multiple View
    Geometry", 2nd ed., section 11.4.3.

    Args:
        rig: the rig.
        uv_left: pixels (N, 2) as seen.
        uv_right: the same of the right image.
        covariance_px2: covariance (4, 4) of (u_left, v_left, u_right, v_right).
    """
    left, pose = rig.left, rig.right_from_left
    centre = -pose.R.T @ pose.t
    with np.errstate(all="ignore"):
        r, slope_r = _ray(rig.left, np.asarray(uv_left, dtype=np.float64))
        q, slope_q = _ray(rig.right, np.asarray(uv_right, dtype=np.float64))
        q = q @ pose.R
        across = np.cross(centre, q)
        gradient = np.hstack(
            [
                np.einsum("nij,ni->nj", slope_r, across),
                np.einsum("nij,ni->nj", slope_q, np.cross(r, centre) @ pose.R.T),
            ]
        )
        steep = np.linalg.norm(gradient, axis=1)
        off = (r * across).sum(axis=1) / steep
        variance = np.einsum("ni,ij,nj->n", gradient, np.asarray(covariance_px2), gradient)
        plane = np.cross(centre, r + q)
        turned = (np.cross(r, q) * plane).sum(axis=1) / (plane**2).sum(axis=1)
        disparity = 2 * left.fx * np.linalg.norm(centre) * turned
    return PairGap(off, np.sqrt(variance) / steep, disparity)


def _ray(camera: Intrinsics, uv: Array) -> tuple[Array, Array]:
    """Rays (N, 3) of pixels, and how they follow the pixel, (N, 3, 2); with z = 1, but unit ones of a lens
    that looks past 90 degrees."""
    if camera.is_wide:
        ray = camera.ray(uv)
        J = camera.jacobian(ray)
        return ray, J.transpose(0, 2, 1) @ _inverse(J @ J.transpose(0, 2, 1))
    ray = ahead(camera.normalize(uv))
    slope = np.zeros((len(ray), 3, 2))
    slope[:, :2] = _inverse(camera.jacobian(ray)[:, :, :2])
    return ray, slope


def _inverse(M: Array) -> Array:
    """Inverse of (N, 2, 2)."""
    a, b, c, d = M.reshape(-1, 4).T
    inverse = np.stack([d, -b, -c, a], axis=1) / (a * d - b * c)[:, None]
    return inverse.reshape(-1, 2, 2)
