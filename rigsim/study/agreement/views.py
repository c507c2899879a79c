"""Errors as the left camera sees them: ``(1/Z, X/Z, Y/Z)``, in which pixel noise stays Gaussian.

A depth error has no moments: the noise may carry a far point to infinity. ``1/Z``, ``X/Z`` and ``Y/Z``
follow the pixels linearly (exactly so when the rig is rectified, where ``1/Z = d / (f B)``), so their
errors have the predicted mean, spread and shape however far the point lies.

A wide lens sees points whose Z is nothing or less: there each point has axes of its own, Z along its ray
(`rays_ahead`), and ``1/Z`` is one over its distance.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.theory.triangulation import triangulate
from rigsim.theory.uncertainty import predict_bias, predict_covariance

_STEP = 0.1


def rays_ahead(rig: StereoRig, points_left: Array) -> Array | None:
    """Axes (N, 3, 3), as rows, with Z towards each point (N, 3); None where the left camera's own will do."""
    if not rig.left.is_wide:
        return None
    z = points_left / np.linalg.norm(points_left, axis=1)[:, None]
    aside = np.zeros_like(z)
    aside[np.arange(len(z)), np.abs(z).argmin(axis=1)] = 1.0
    x = np.cross(aside, z)
    x /= np.linalg.norm(x, axis=1)[:, None]
    return np.stack([x, np.cross(z, x), z], axis=1)


def turned(points_left: Array, axes: Array | None) -> Array:
    """Points (..., N, 3) in the axes (N, 3, 3) of `rays_ahead`; as they are where there are none."""
    return points_left if axes is None else np.einsum("nij,...nj->...ni", axes, points_left)


def views(points_left: Array, axes: Array | None = None) -> Array:
    """``(1/Z, X/Z, Y/Z)`` of points (..., N, 3) m, in `axes` where there are any."""
    points_left = turned(points_left, axes)
    inverse = 1 / points_left[..., 2]
    return np.stack([inverse, points_left[..., 0] * inverse, points_left[..., 1] * inverse], axis=-1)


def view_jacobian(points_left: Array) -> Array:
    """Derivative (N, 3, 3) of ``views`` with respect to the point (N, 3)."""
    x, y, z = points_left.T
    G = np.zeros((len(points_left), 3, 3))
    G[:, 0, 2] = -1 / z**2
    G[:, 1, 0] = G[:, 2, 1] = 1 / z
    G[:, 1, 2] = -x / z**2
    G[:, 2, 2] = -y / z**2
    return G


def predict_views(
    rig: StereoRig, points_left: Array, noise: PixelNoise, axes: Array | None = None
) -> tuple[Array, Array]:
    """Mean (N, 3) and covariance (N, 3, 3) of the error of ``views``, for the maximum-likelihood point.

    The mean is of second order in the noise: that of the point carried over, and the curvature of
    ``views`` itself; for a rectified rig the two cancel.
    """
    C, shift = predict_covariance(rig, points_left, noise), predict_bias(rig, points_left, noise)
    if axes is not None:
        C, shift = axes @ C @ axes.transpose(0, 2, 1), turned(shift, axes)
        points_left = turned(points_left, axes)
    x, y, z = points_left.T
    G = view_jacobian(points_left)
    bias = np.einsum("nij,nj->ni", G, shift)
    bias[:, 0] += C[:, 2, 2] / z**3
    bias[:, 1] += x * C[:, 2, 2] / z**3 - C[:, 0, 2] / z**2
    bias[:, 2] += y * C[:, 2, 2] / z**3 - C[:, 1, 2] / z**2
    return bias, G @ C @ G.transpose(0, 2, 1)


def expand_views(
    rig: StereoRig,
    points_left: Array,
    noise: PixelNoise,
    method: str | Callable[..., Any],
    axes: Array | None = None,
) -> tuple[Array, Array]:
    """The same as `predict_views` for a method that is not the maximum-likelihood one, by its own expansion.

    Second order in the noise, by differences of a tenth of a standard deviation along the axes of the
    noise's covariance: ``bias = 1/2 sum_k d2 views / dk2``, ``covariance = sum_k (d views / dk)^2``.
    """
    variances, directions = np.linalg.eigh(noise.covariance_px2)
    uv_left, uv_right = rig.project(points_left)
    middle = views(triangulate(rig, uv_left, uv_right, method), axes)
    bias, covariance = np.zeros((len(points_left), 3)), np.zeros((len(points_left), 3, 3))
    for variance, axis in zip(variances, directions.T, strict=True):
        move = _STEP * math.sqrt(max(variance, 0.0)) * axis
        ahead, behind = (
            views(triangulate(rig, uv_left + way * move[:2], uv_right + way * move[2:], method), axes)
            for way in (1, -1)
        )
        bias += 0.5 * (ahead + behind - 2 * middle) / _STEP**2
        slope = (ahead - behind) / (2 * _STEP)
        covariance += slope[:, :, None] * slope[:, None, :]
    return bias, covariance
