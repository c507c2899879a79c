"""Lens models that divide x and y by one number: spheres and spheroids, looked at from a shifted centre."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.lens.lens import Lens


@dataclass(frozen=True, slots=True)
class QuotientLens(Lens):
    """A lens with ``(x, y) / D(x^2 + y^2, z)`` for its image."""

    @abstractmethod
    def divisor(self, r2: Array, z: Array) -> Array:
        """``D`` for x^2 + y^2 and z."""

    @abstractmethod
    def divisor_slope(self, r2: Array, z: Array) -> tuple[Array, Array]:
        """``c`` and ``g`` of its gradient ``(c x, c y, g)``."""

    @abstractmethod
    def divisor_slopes(self, r2: Array, z: Array) -> Array:
        """Derivative (..., p) of ``D`` with respect to the coefficients."""

    def project(self, points: Array) -> Array:
        """As `Lens.project`."""
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            scale = np.where(self.sees(points), 1 / self.divisor(x * x + y * y, z), np.nan)
            return points[..., :2] * scale[..., None]

    def jacobian(self, points: Array) -> Array:
        """As `Lens.jacobian`."""
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            r2 = x * x + y * y
            scale = np.where(self.sees(points), 1 / self.divisor(r2, z), np.nan)
            c, g = self.divisor_slope(r2, z)
            c, g = c * scale * scale, g * scale * scale
            J = np.empty((*points.shape[:-1], 2, 3))
            J[..., 0, 0] = scale - x * x * c
            J[..., 0, 1] = -x * y * c
            J[..., 1, 0] = J[..., 0, 1]
            J[..., 1, 1] = scale - y * y * c
            J[..., 0, 2] = -x * g
            J[..., 1, 2] = -y * g
        return J

    def slopes(self, points: Array) -> Array:
        """As `Lens.slopes`."""
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            r2 = x * x + y * y
            scale = np.where(self.sees(points), 1 / self.divisor(r2, z), np.nan)
            by = -(scale * scale)[..., None] * self.divisor_slopes(r2, z)
            return np.asarray(points[..., :2, None] * by[..., None, :])
