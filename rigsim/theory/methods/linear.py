"""The two linear triangulators everybody knows, to compare with."""

from __future__ import annotations

import math

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.lens import ahead
from rigsim.rig.stereo import StereoRig
from rigsim.theory.blocks import blocks
from rigsim.theory.matrices import across

_BLOCK = 8192
_FARTHEST = 1 / (16 * np.finfo(np.float64).eps)  # baselines


def triangulate_dlt(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """Points (N, 3) m in the left camera's frame by the homogeneous linear method, in pixels.

    Hartley & Zisserman, "Multiple View Geometry", 12.2: the right singular vector of the four equations
    ``u (P3 X) = P1 X``, ``v (P3 X) = P2 X``. The same as cv2.triangulatePoints. Of a lens that looks past 90
    degrees, the two equations say that the point lies on the ray, in pixels at the image's middle.
    """
    P_left = _projection(rig.left, np.eye(3), np.zeros(3))
    P_right = _projection(rig.right, rig.right_from_left.R, rig.right_from_left.t)
    with np.errstate(all="ignore"):
        rows_left, rows_right = _rows(rig.left, uv_left), _rows(rig.right, uv_right)
    points = np.full((len(uv_left), 3), np.nan)
    # the decomposition refuses NaN, and would take the whole batch with it
    finite = np.flatnonzero(np.isfinite(rows_left).all((1, 2)) & np.isfinite(rows_right).all((1, 2)))
    with np.errstate(all="ignore"):
        for block in blocks(len(finite), _BLOCK):
            which = finite[block]
            equations = np.concatenate([rows_left[which] @ P_left, rows_right[which] @ P_right], axis=1)
            X = np.linalg.svd(equations)[2][:, 3]
            points[which] = X[:, :3] / X[:, 3:]
        points[_against(rig.left, uv_left, points)] = np.nan
        points[_against(rig.right, uv_right, rig.right_from_left.apply(points))] = np.nan
        return in_front(rig, points)


def triangulate_midpoint(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """Points (N, 3) m in the left camera's frame halfway between the two rays where they pass closest."""
    center = rig.right_from_left.inverse.t
    with np.errstate(all="ignore"):
        left = _rays(rig.left, uv_left)
        right = _rays(rig.right, uv_right) @ rig.right_from_left.R
        normal = np.cross(left, right)
        normal /= np.einsum("ij,ij->i", normal, normal)[:, None]
        along_left = np.einsum("ij,ij->i", np.cross(center, right), normal)
        along_right = np.einsum("ij,ij->i", np.cross(center, left), normal)
        points = 0.5 * (along_left[:, None] * left + center + along_right[:, None] * right)
        points[~((along_left > 0) & (along_right > 0))] = np.nan
        return in_front(rig, points)


def in_front(rig: StereoRig, points_left: Array) -> Array:
    """`points_left` (N, 3) with NaN in place of those that are not in front of both cameras, or so far that
    rounding makes all their parallax."""
    near = np.abs(points_left).max(axis=1, initial=0.0) < _FARTHEST * rig.baseline_m
    good = rig.left.faces(points_left) & rig.right.faces(rig.right_from_left.apply(points_left)) & near
    return np.where(good[:, None], points_left, np.nan)


def _against(camera: Intrinsics, uv: Array, points: Array) -> Mask:
    """Which points (N, 3) a lens that shows both ways saw the other way."""
    if not camera.is_wide:
        return np.zeros(len(points), dtype=np.bool_)
    return np.asarray(np.einsum("ni,ni->n", camera.ray(uv), points) <= 0)


def _projection(camera: Intrinsics, R: Array, t: Array) -> Array:
    """Projection matrix (3, 4) to pixels counted from the principal point."""
    return np.array([[camera.fx], [camera.fy], [1.0]]) * np.column_stack([R, t])


def _rows(camera: Intrinsics, uv: Array) -> Array:
    """What (N, 2, 3) makes two equations of a projection to pixels counted from the principal point."""
    rows = np.zeros((len(uv), 2, 3))
    if camera.is_wide:
        rows[:] = across(camera.ray(uv)) / (camera.fx, camera.fy, 1.0)
        rows *= math.sqrt(camera.fx * camera.fy)
        return rows
    rows[:, 0, 0] = rows[:, 1, 1] = -1.0
    rows[:, :, 2] = camera.normalize(uv) * (camera.fx, camera.fy)
    return rows


def _rays(camera: Intrinsics, uv: Array) -> Array:
    """Directions (N, 3) in the camera's frame, with z = 1 where its lens shows only what lies ahead."""
    return camera.ray(uv) if camera.is_wide else ahead(camera.normalize(uv))
