"""Covariances as ellipsoids: half axes, and which way they point."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rigsim.rig.arrays import Array


class Ellipsoids(NamedTuple):
    """One ellipsoid a covariance, of one standard deviation."""

    half_axes: Array
    """Half axes (N, 3), the longest last, in the unit whose square the covariance has; NaN for none."""
    turns: Array
    """Rotations (N, 3, 3): column k is the direction of half axis k; right-handed."""


def ellipsoids(covariances: npt.ArrayLike) -> Ellipsoids:
    """The ellipsoids ``x^T S^-1 x = 1`` of covariances (N, 3, 3); NaN where one is not finite.

    Example:
        >>> from rigsim.theory.ellipsoids import ellipsoids
        >>> half_axes, turns = ellipsoids([[[4.0, 0, 0], [0, 1, 0], [0, 0, 9]]])
        >>> half_axes[0].tolist(), float(abs(turns[0, 2, 2]))
        ([1.0, 2.0, 3.0], 1.0)
    """
    given = np.asarray(covariances, dtype=np.float64)
    known = np.isfinite(given).all(axis=(1, 2))
    half_axes = np.full((len(given), 3), np.nan)
    turns = np.tile(np.eye(3), (len(given), 1, 1))
    if known.any():
        variances, vectors = np.linalg.eigh(given[known])
        # a mirror image is no rotation: its last column is turned round
        vectors[:, :, 2] *= np.sign(np.linalg.det(vectors))[:, None]
        half_axes[known], turns[known] = np.sqrt(np.maximum(variances, 0.0)), vectors
    return Ellipsoids(half_axes, turns)
