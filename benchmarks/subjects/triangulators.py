"""Triangulators as a textbook or a tutorial has them: nothing of rigsim.theory, correct for every rig."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig

_FARTHEST_M = 1e9  # double precision knows nothing of a point beyond


@dataclass(frozen=True)
class Calibration:
    """A rig as a calibration file has it: ``x_right = R x_left + t``, lens as (k1, k2, p1, p2, k3)."""

    K_left: Array
    K_right: Array
    lens_left: Array
    lens_right: Array
    R: Array
    t: Array
    size: tuple[int, int]


def calibration(rig: StereoRig) -> Calibration:
    pose = rig.right_from_left
    size = (rig.left.width, rig.left.height)
    return Calibration(
        rig.left.K,
        rig.right.K,
        coefficients(rig.left),
        coefficients(rig.right),
        pose.R.copy(),
        pose.t.copy(),
        size,
    )


def coefficients(camera: Intrinsics) -> Array:
    lens = camera.lens
    return np.zeros(5) if lens is None else np.array([lens.k1, lens.k2, lens.p1, lens.p2, lens.k3])


def linear(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """Undistort, then the homogeneous linear equations by singular values."""
    return solve_linear(calibration(rig), uv_left, uv_right)


def unchecked(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """The same with points behind the cameras as they come, as cv2.triangulatePoints leaves them."""
    c = calibration(rig)
    left = undistort(uv_left, c.K_left, c.lens_left)
    return homogeneous(c, left, undistort(uv_right, c.K_right, c.lens_right))


def solve_linear(c: Calibration, uv_left: Array, uv_right: Array) -> Array:
    return intersect(
        c, undistort(uv_left, c.K_left, c.lens_left), undistort(uv_right, c.K_right, c.lens_right)
    )


def intersect(c: Calibration, xy_left: Array, xy_right: Array) -> Array:
    """Points (N, 3) of normalised coordinates; NaN where they are not in front of both cameras."""
    return in_front(c, homogeneous(c, xy_left, xy_right))


def homogeneous(c: Calibration, xy_left: Array, xy_right: Array) -> Array:
    """Points (N, 3) of normalised coordinates, on whichever side of the cameras."""
    P_left, P_right = np.eye(3, 4), np.column_stack([c.R, c.t])
    points = np.full((len(xy_left), 3), np.nan)
    known = np.flatnonzero(np.isfinite(np.hstack([xy_left, xy_right])).all(axis=1))
    left, right = xy_left[known, :, None], xy_right[known, :, None]
    A = np.concatenate([left * P_left[2] - P_left[:2], right * P_right[2] - P_right[:2]], axis=1)
    X = np.linalg.svd(A)[2][:, 3]
    with np.errstate(all="ignore"):
        points[known] = X[:, :3] / X[:, 3:]
    return points


def midpoint(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """The middle of the shortest line between the two rays."""
    c = calibration(rig)
    ray_left = rays(undistort(uv_left, c.K_left, c.lens_left))
    ray_right = rays(undistort(uv_right, c.K_right, c.lens_right)) @ c.R
    center = -c.R.T @ c.t
    # by cross products: dot products lose half the digits where the rays are all but parallel
    with np.errstate(all="ignore"):
        normal = np.cross(ray_left, ray_right)
        square = np.sum(normal**2, axis=1)
        along_left = np.sum(np.cross(center, ray_right) * normal, axis=1) / square
        along_right = np.sum(np.cross(center, ray_left) * normal, axis=1) / square
        points = (along_left[:, None] * ray_left + center + along_right[:, None] * ray_right) / 2
    points[~((along_left > 0) & (along_right > 0))] = np.nan
    return in_front(c, points)


def rays(xy: Array) -> Array:
    return np.column_stack([xy, np.ones(len(xy))])


def opencv(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """stereoRectify and disparity to depth; triangulatePoints where the baseline is not sideways."""
    return solve_opencv(calibration(rig), uv_left, uv_right)


def solve_opencv(c: Calibration, uv_left: Array, uv_right: Array) -> Array:
    points = np.full((len(uv_left), 3), np.nan)
    known = np.isfinite(np.hstack([uv_left, uv_right])).all(axis=1)
    known &= invertible(uv_left, c.K_left, c.lens_left) & invertible(uv_right, c.K_right, c.lens_right)
    if not known.any():
        return points
    uv = uv_left[known], uv_right[known]
    # stereoRectify is for cameras that look the same way, side by side
    sideways = abs(c.t[0]) > 2 * np.linalg.norm(c.t[1:]) and np.trace(c.R) > 1 + 2 * np.cos(np.pi / 6)
    points[known] = rectify(c, *uv) if sideways else project(c, *uv)
    return in_front(c, points)


def rectify(c: Calibration, uv_left: Array, uv_right: Array) -> Array:
    R_left, R_right, P_left, P_right, *_ = cv2.stereoRectify(
        c.K_left, c.lens_left, c.K_right, c.lens_right, c.size, c.R, c.t.reshape(3, 1), flags=0
    )
    left = cv2_undistort(uv_left, c.K_left, c.lens_left, R_left, P_left)
    right = cv2_undistort(uv_right, c.K_right, c.lens_right, R_right, P_right)
    with np.errstate(all="ignore"):
        z = -P_right[0, 3] / (left[:, 0] - P_left[0, 2] - right[:, 0] + P_right[0, 2])
        v = (left[:, 1] + right[:, 1]) / 2
        x, y = (left[:, 0] - P_left[0, 2]) / P_left[0, 0], (v - P_left[1, 2]) / P_left[1, 1]
        return np.column_stack([x * z, y * z, z]) @ R_left


def project(c: Calibration, uv_left: Array, uv_right: Array) -> Array:
    left = cv2_undistort(uv_left, c.K_left, c.lens_left)
    right = cv2_undistort(uv_right, c.K_right, c.lens_right)
    X = cv2.triangulatePoints(np.eye(3, 4), np.column_stack([c.R, c.t]), left.T, right.T)
    with np.errstate(all="ignore"):
        return np.asarray((X[:3] / X[3]).T)


def cv2_undistort(uv: Array, K: Array, lens: Array, R: Array | None = None, P: Array | None = None) -> Array:
    done = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 500, 1e-15)
    return np.asarray(cv2.undistortPoints(uv.reshape(-1, 1, 2), K, lens, R=R, P=P, criteria=done)).reshape(
        -1, 2
    )


def in_front(c: Calibration, points: Array) -> Array:
    """`points` with NaN in place of those behind a camera or as good as at infinity."""
    with np.errstate(all="ignore"):
        right = points @ c.R.T + c.t
        good = (points[:, 2] > 0) & (right[:, 2] > 0) & (np.linalg.norm(points, axis=1) < _FARTHEST_M)
    return np.where(good[:, None], points, np.nan)


def invertible(uv: Array, K: Array, lens: Array) -> Mask:
    return np.isfinite(undistort(uv, K, lens)).all(axis=1)


def normalised(uv: Array, K: Array) -> Array:
    return np.asarray((uv - K[:2, 2]) / (K[0, 0], K[1, 1]))


def undistort(uv: Array, K: Array, lens: Array, steps: int = 50) -> Array:
    """Ideal normalised coordinates of pixels (N, 2) by Newton's method."""
    seen = normalised(np.where(np.isfinite(uv), uv, np.nan), K)
    if not lens.any():
        return seen
    xy = seen.copy()
    with np.errstate(all="ignore"):
        for _ in range(steps):
            J = distortion_slopes(xy, lens)
            residual = distort(xy, lens) - seen
            det = J[0] * J[3] - J[1] * J[2]
            xy[:, 0] -= (J[3] * residual[:, 0] - J[1] * residual[:, 1]) / det
            xy[:, 1] -= (J[0] * residual[:, 1] - J[2] * residual[:, 0]) / det
        good = (np.sum(xy**2, axis=1) < last_radius2(lens)) & (
            np.abs(distort(xy, lens) - seen).max(axis=1) < 1e-9 if steps > 10 else True
        )
    return np.where(good[:, None], xy, np.nan)


def distort(xy: Array, lens: Array) -> Array:
    k1, k2, p1, p2, k3 = lens
    x, y = xy.T
    s = x * x + y * y
    radial = 1 + k1 * s + k2 * s**2 + k3 * s**3
    dx = 2 * p1 * x * y + p2 * (s + 2 * x * x)
    dy = p1 * (s + 2 * y * y) + 2 * p2 * x * y
    return np.column_stack([x * radial + dx, y * radial + dy])


def distortion_slopes(xy: Array, lens: Array) -> tuple[Array, Array, Array, Array]:
    """dx'/dx, dx'/dy, dy'/dx, dy'/dy of `distort`."""
    k1, k2, p1, p2, k3 = lens
    x, y = xy.T
    s = x * x + y * y
    radial = 1 + k1 * s + k2 * s**2 + k3 * s**3
    bend = k1 + 2 * k2 * s + 3 * k3 * s**2
    mixed = 2 * x * y * bend + 2 * p1 * x + 2 * p2 * y
    return (
        radial + 2 * x * x * bend + 2 * p1 * y + 6 * p2 * x,
        mixed,
        mixed,
        radial + 2 * y * y * bend + 6 * p1 * y + 2 * p2 * x,
    )


def last_radius2(lens: Array) -> float:
    """Squared ideal radius from which on the radial terms fold the picture over itself."""
    k1, k2, _, _, k3 = lens
    roots = np.roots(np.trim_zeros([7 * k3, 5 * k2, 3 * k1, 1.0], "f"))
    real = roots.real[(np.abs(roots.imag) < 1e-9) & (roots.real > 0)]
    return float(real.min()) if len(real) else np.inf
