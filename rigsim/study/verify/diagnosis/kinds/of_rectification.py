"""Mistakes with the matrices of a rectification, which belong to rectified pixels alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.study.saying import saying
from rigsim.study.verify.diagnosis.kinds.of_answer import opencv_rectified
from rigsim.study.verify.diagnosis.mistake import Mistake
from rigsim.study.verify.diagnosis.reenact import Given, Lenses, homogeneous, turned


def rectified_cameras(g: Given) -> tuple[Lenses, Lenses, Array]:
    """Cameras and ``t`` (N, 3) of P1 and P2 as OpenCV 5's stereoRectify makes them, flags 0 and alpha -1.

    One focal length for both, the mean fy; principal points that put each picture's mean corner into its
    middle; rows shared.
    """
    R1 = opencv_rectified(g)
    R2 = np.einsum("nij,nkj->nik", R1, g.R)
    t = turned(R2, g.t)
    sideways = np.abs(t[:, 0]) > np.abs(t[:, 1])
    size = g.left.size
    focal = np.where(sideways, g.left.f[:, 1] + g.right.f[:, 1], g.left.f[:, 0] + g.right.f[:, 0]) / 2
    centres = [
        (size - 1) / 2 - _middle_of_corners(camera, size, R, focal)
        for camera, R in ((g.left, R1), (g.right, R2))
    ]
    shared = (centres[0] + centres[1]) / 2
    axis = np.where(sideways[:, None], (False, True), (True, False))  # the coordinate that corresponds
    cameras = [
        Lenses(
            np.column_stack([focal, focal]),
            np.where(axis, shared, centre),
            size,
            np.zeros_like(camera.bend),
        )
        for camera, centre in ((g.left, centres[0]), (g.right, centres[1]))
    ]
    along = np.where(sideways[:, None], (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)) * t
    return cameras[0], cameras[1], along


def _middle_of_corners(camera: Lenses, size: Array, R: Array, focal: Array) -> Array:
    """Mean (N, 2) of the picture's turned corners, px from the principal point."""
    total = np.zeros_like(size)
    for share in ((0, 0), (1, 0), (0, 1), (1, 1)):
        ray = turned(R, homogeneous(camera.normalize((size - 1) * share)))
        total += focal[:, None] * ray[:, :2] / ray[:, 2:]
    return total / 4


def _raw_pixels(g: Given) -> Given:
    left, right, t = rectified_cameras(g)
    return replace(g, left=left, right=right, R=np.broadcast_to(np.eye(3), g.R.shape), t=t)


def _turned_back(points: Array, g: Given) -> Array:
    R1 = opencv_rectified(g)
    return np.asarray(np.einsum("nji,nj->ni", R1, points))


def _identity(points: Array, g: Given) -> Array:
    return points


_AFTER: tuple[tuple[str, Callable[[Array, Given], Array]], ...] = (
    ("rectified-matrices", _identity),
    ("rectified-matrices: rotated back", _turned_back),
)

RECTIFICATION: tuple[Mistake, ...] = tuple(
    Mistake(
        saying(form),
        _raw_pixels,
        after=after,
        cost=0.002,
    )
    for form, after in _AFTER
)
"""Rectified matrices with raw pixels."""
