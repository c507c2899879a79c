"""The unified model with distortion of Mei and Rives (2007): OpenCV's omnidir, Kalibr's omni with radtan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.quotient import QuotientLens


@dataclass(frozen=True, slots=True)
class UnitSphere(QuotientLens):
    """A unit sphere seen from `xi` behind its centre: a point divided by ``xi |point| + z``."""

    model: ClassVar[str] = "unit_sphere"
    title: ClassVar[str] = "unified"

    xi: float = 0.0

    def divisor(self, r2: Array, z: Array) -> Array:
        """As `QuotientLens.divisor`."""
        return np.asarray(self.xi * np.sqrt(r2 + z * z) + z)

    def divisor_slope(self, r2: Array, z: Array) -> tuple[Array, Array]:
        """As `QuotientLens.divisor_slope`."""
        distance = np.sqrt(r2 + z * z)
        return self.xi / distance, self.xi * z / distance + 1

    def divisor_slopes(self, r2: Array, z: Array) -> Array:
        """As `QuotientLens.divisor_slopes`."""
        return np.asarray(np.sqrt(r2 + z * z)[..., None])

    def sees(self, points: Array) -> Mask:
        """As `Lens.sees`: what lies before the sphere's rim, as seen from the shifted centre."""
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        rim = self.xi if self.xi <= 1 else 1 / self.xi
        return np.asarray(z > -rim * np.sqrt(x * x + y * y + z * z))

    def ray(self, image: Array) -> Array:
        """As `Lens.ray`."""
        xi = self.xi
        x, y = image[..., 0], image[..., 1]
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            r2 = x * x + y * y
            scale = (xi + np.sqrt(1 + (1 - xi * xi) * r2)) / (r2 + 1)
            rays = np.stack([x * scale, y * scale, scale - xi], axis=-1)
            rays[~self.sees(rays)] = np.nan
        return rays


@dataclass(frozen=True, slots=True)
class Mei(Lens):
    """A unit sphere seen from `xi` behind its centre, then Brown-Conrady's k1, k2, p1, p2 in the plane.

    Example:
        >>> import numpy as np, rigsim
        >>> lens = rigsim.Mei(xi=1.0)
        >>> lens.project(np.array([3.0, 0, 4.0])).tolist()  # 3 / (5 + 4)
        [0.3333333333333333, 0.0]
    """

    model: ClassVar[str] = "mei"
    title: ClassVar[str] = "Mei"

    xi: float = 0.0
    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0

    def fault(self) -> str:
        """As `Lens.fault`."""
        if not self.xi >= 0:
            return f"xi {self.xi:g}: must be >= 0"
        return ""

    @property
    def is_ideal(self) -> bool:
        """As `Lens.is_ideal`."""
        return self.xi == 0 and self._plane.is_ideal

    @property
    def _sphere(self) -> UnitSphere:
        return UnitSphere(self.xi)

    @property
    def _plane(self) -> BrownConrady:
        return BrownConrady(self.k1, self.k2, self.p1, self.p2)

    def sees(self, points: Array) -> Mask:
        """As `Lens.sees`."""
        return np.isfinite(self._shown(points)[..., 0])

    def project(self, points: Array) -> Array:
        """As `Lens.project`."""
        return self._plane.distort(self._shown(points))

    def ray(self, image: Array) -> Array:
        """As `Lens.ray`."""
        return self._sphere.ray(self._plane.undistort(image))

    def jacobian(self, points: Array) -> Array:
        """As `Lens.jacobian`."""
        return np.asarray(self._plane.slope(self._shown(points)) @ self._sphere.jacobian(points))

    def slopes(self, points: Array) -> Array:
        """As `Lens.slopes`."""
        shown = self._shown(points)
        by_xi = self._plane.slope(shown) @ self._sphere.slopes(points)
        return np.concatenate([by_xi, self._plane.distort_slopes(shown)[..., :4]], axis=-1)

    def _shown(self, points: Array) -> Array:
        """Coordinates (..., 2) in the plane before its distortion; NaN where the lens shows nothing."""
        plane = self._plane
        image = self._sphere.project(points)
        if plane.is_ideal:
            return image
        with np.errstate(invalid="ignore"):
            return np.where(plane.shows(image)[..., None], image, np.nan)
