"""Errors as the left camera sees them: ``(1/Z, X/Z, Y/Z)``, in which pixel noise stays Gaussian.

A depth error has no moments: the noise may carry a far point to infinity. ``1/Z``, ``X/Z`` and ``Y/Z``
follow the pixels linearly (exactly so when the rig is rectified, where ``1/Z = d / (f B)``), so their
errors have the predicted mean, spread and shape however far the point lies.
"""

from __future__ import annotations

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.theory.uncertainty import predict_bias, predict_covariance


def views(points_left: Array) -> Array:
    """``(1/Z, X/Z, Y/Z)`` of points (..., 3) m."""
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


def predict_views(rig: StereoRig, points_left: Array, noise: PixelNoise) -> tuple[Array, Array]:
    """Mean (N, 3) and covariance (N, 3, 3) of the error of ``views``, for the maximum-likelihood point.

    The mean is of second order in the noise: that of the point carried over, and the curvature of
    ``views`` itself; for a rectified rig the two cancel.
    """
    x, y, z = points_left.T
    G = view_jacobian(points_left)
    C = predict_covariance(rig, points_left, noise)
    bias = np.einsum("nij,nj->ni", G, predict_bias(rig, points_left, noise))
    bias[:, 0] += C[:, 2, 2] / z**3
    bias[:, 1] += x * C[:, 2, 2] / z**3 - C[:, 0, 2] / z**2
    bias[:, 2] += y * C[:, 2, 2] / z**3 - C[:, 1, 2] / z**2
    return bias, G @ C @ G.transpose(0, 2, 1)
