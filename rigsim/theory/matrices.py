"""Batches of 3x3 matrices without a loop in Python."""

from __future__ import annotations

import numpy as np

from rigsim.rig.arrays import Array


def inverse_symmetric(M: Array) -> Array:
    """Inverse (N, 3, 3) of symmetric (N, 3, 3) by cofactors; not finite where singular."""
    a, b, c = M[:, 0, 0], M[:, 0, 1], M[:, 0, 2]
    d, e, f = M[:, 1, 1], M[:, 1, 2], M[:, 2, 2]
    inverse = np.empty_like(M)
    inverse[:, 0, 0] = d * f - e * e
    inverse[:, 0, 1] = inverse[:, 1, 0] = c * e - b * f
    inverse[:, 0, 2] = inverse[:, 2, 0] = b * e - c * d
    inverse[:, 1, 1] = a * f - c * c
    inverse[:, 1, 2] = inverse[:, 2, 1] = b * c - a * e
    inverse[:, 2, 2] = a * d - b * b
    with np.errstate(all="ignore"):
        det = a * inverse[:, 0, 0] + b * inverse[:, 0, 1] + c * inverse[:, 0, 2]
        inverse /= det[:, None, None]
    return inverse


def across(directions: Array) -> Array:
    """Two unit vectors (N, 2, 3) at right angles to each other and to unit `directions` (N, 3).

    Continuous but for the sign of z (Duff et al., "Building an orthonormal basis, revisited", 2017).
    """
    x, y, z = directions[:, 0], directions[:, 1], directions[:, 2]
    sign = np.copysign(1.0, z)
    a = -1 / (sign + z)
    b = x * y * a
    return np.stack(
        [
            np.stack([1 + sign * x * x * a, sign * b, -sign * x], axis=1),
            np.stack([b, sign + y * y * a, -y], axis=1),
        ],
        axis=1,
    )
