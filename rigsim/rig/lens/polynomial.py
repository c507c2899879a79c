"""The Brown-Conrady polynomial and its slope, for one lens or for one lens a row."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from rigsim.rig.arrays import Array, Mask

Coefficients: TypeAlias = (
    "tuple[float, float, float, float, float] | tuple[Array, Array, Array, Array, Array]"
)
"""k1, k2, p1, p2, k3: numbers, or arrays (N,) with a value for each row."""


def distort(coefficients: Coefficients, normalized: Array) -> Array:
    """Distorted (..., 2) of ideal (..., 2) normalised coordinates."""
    k1, k2, p1, p2, k3 = coefficients
    x, y = normalized[..., 0], normalized[..., 1]
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return np.stack(
        [
            x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
        ],
        axis=-1,
    )


def jacobian(coefficients: Coefficients, normalized: Array) -> Array:
    """Derivative (..., 2, 2) of `distort` with respect to the ideal coordinates; it is symmetric."""
    k1, k2, p1, p2, k3 = coefficients
    x, y = normalized[..., 0], normalized[..., 1]
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = 2 * (k1 + r2 * (2 * k2 + 3 * r2 * k3))  # d radial / d x = x * slope
    cross = x * y * slope + 2 * p1 * x + 2 * p2 * y
    J = np.empty((*normalized.shape, 2))
    J[..., 0, 0] = radial + x * x * slope + 2 * p1 * y + 6 * p2 * x
    J[..., 0, 1] = cross
    J[..., 1, 0] = cross
    J[..., 1, 1] = radial + y * y * slope + 6 * p1 * y + 2 * p2 * x
    return J


def slopes(normalized: Array) -> Array:
    """Derivative (..., 2, 5) of `distort` with respect to the coefficients, whose values do not matter."""
    x, y = normalized[..., 0], normalized[..., 1]
    r2 = x * x + y * y
    J = np.empty((*normalized.shape, 5))
    for place, power in ((0, r2), (1, r2 * r2), (4, r2 * r2 * r2)):
        J[..., 0, place] = x * power
        J[..., 1, place] = y * power
    J[..., 0, 2] = J[..., 1, 3] = 2 * x * y
    J[..., 1, 2] = r2 + 2 * y * y
    J[..., 0, 3] = r2 + 2 * x * x
    return J


def is_one_to_one(coefficients: Coefficients, normalized: Array) -> Mask:
    """Whether the Jacobian (..., 2, 2) is positive definite."""
    J = jacobian(coefficients, normalized)
    a, b, c = J[..., 0, 0], J[..., 1, 1], J[..., 0, 1]
    return np.asarray((a * b > c * c) & (a + b > 0))


def radial(coefficients: Coefficients, radius: Array) -> tuple[Array, Array]:
    """The radial polynomial of radii (N,), and its derivative."""
    k1, k2, _, _, k3 = coefficients
    s = radius * radius
    return radius * (1 + s * (k1 + s * (k2 + s * k3))), 1 + s * (3 * k1 + s * (5 * k2 + s * 7 * k3))
