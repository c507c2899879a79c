"""Lens models of x/z and y/z: what looks less than 90 degrees off its axis."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.lens import undistortion
from rigsim.rig.lens.lens import Lens, ahead, unit


@dataclass(frozen=True, slots=True)
class PlanarLens(Lens):
    """A lens that maps ideal ``(x/z, y/z)`` to distorted image coordinates."""

    @property
    def fold_radius2(self) -> float:
        """Squared ideal radius at which the image turns back, or ends; infinite if it never does."""
        return float(np.inf)

    def shows(self, normalized: Array) -> Mask:
        """Whether the lens shows ideal coordinates (..., 2); there `distort` is one to one."""
        x, y = normalized[..., 0], normalized[..., 1]
        return np.asarray(x * x + y * y < self.fold_radius2)

    @abstractmethod
    def distort(self, normalized: Array) -> Array:
        """Map ideal (..., 2) to distorted (..., 2) coordinates."""

    @abstractmethod
    def undistort(self, distorted: Array) -> Array:
        """Invert `distort` (..., 2) to rounding; NaN where the lens shows no ideal point."""

    @abstractmethod
    def slope(self, normalized: Array) -> Array:
        """Derivative (..., 2, 2) of `distort` with respect to the ideal coordinates."""

    def sees(self, points: Array) -> Mask:
        """As `Lens.sees`."""
        return np.isfinite(self._seen(points)[..., 0])

    def project(self, points: Array) -> Array:
        """As `Lens.project`."""
        return self.distort(self._seen(points))

    def ray(self, image: Array) -> Array:
        """As `Lens.ray`."""
        return unit(ahead(self.undistort(image)))

    @abstractmethod
    def distort_slopes(self, normalized: Array) -> Array:
        """Derivative (..., 2, p) of `distort` with respect to the coefficients."""

    def slopes(self, points: Array) -> Array:
        """As `Lens.slopes`."""
        return self.distort_slopes(self._seen(points))

    def bent(self, normalized: Array) -> Array:
        """As `Lens.bent`: all of them."""
        return self.distort(normalized)

    def jacobian(self, points: Array) -> Array:
        """As `Lens.jacobian`."""
        normalized = self._seen(points)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            return np.asarray(self.slope(normalized) @ pinhole_jacobian(points, normalized))

    def _seen(self, points: Array) -> Array:
        """x/z and y/z (..., 2) of points (..., 3); NaN where the lens shows none."""
        z = points[..., 2:]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            normalized = np.where(z > 0, points[..., :2] / z, np.nan)
            return np.where(self.shows(normalized)[..., None], normalized, np.nan)


@dataclass(frozen=True, slots=True)
class NearlyRadialLens(PlanarLens):
    """A planar lens that moves points along their radius, and a little aside."""

    @abstractmethod
    def radial(self, radius: Array) -> tuple[Array, Array]:
        """The distorted radius of ideal radii (N,) without what is not radial, and its derivative."""

    @property
    @abstractmethod
    def is_radial(self) -> bool:
        """Whether all that `distort` does is along the radius."""

    def aside(self, radius: float) -> float:
        """The most by which what is not radial moves a point at an ideal radius."""
        return 0.0

    def undistort(self, distorted: Array) -> Array:
        """Invert `distort` (..., 2) to rounding; NaN where the lens shows no ideal point."""
        return undistortion.undistort(self, distorted)


def pinhole_jacobian(points: Array, normalized: Array) -> Array:
    """Derivative (..., 2, 3) of x/z and y/z with respect to the point; NaN where `normalized` (..., 2) is."""
    J = np.zeros((*points.shape[:-1], 2, 3))
    inverse_z = np.where(np.isfinite(normalized[..., 0]), 1 / points[..., 2], np.nan)
    J[..., 0, 0] = inverse_z
    J[..., 0, 1] = J[..., 1, 0] = 0 * inverse_z  # NaN with the others
    J[..., 1, 1] = inverse_z
    J[..., 0, 2] = -normalized[..., 0] * inverse_z
    J[..., 1, 2] = -normalized[..., 1] * inverse_z
    return J
