"""Lens models of the angle to the axis: the image's radius is a function of it, and its direction stays."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.roots import growing_root


@dataclass(frozen=True, slots=True)
class AngularLens(Lens):
    """A lens whose image radius grows with the angle between ray and axis, up to `end_rad`."""

    @property
    @abstractmethod
    def end_rad(self) -> float:
        """Angle at which the image turns back or ends, rad; at most pi."""

    @abstractmethod
    def radius(self, angle: Array) -> tuple[Array, Array]:
        """Image radius at angles (N,), rad, and its derivative."""

    @abstractmethod
    def angle(self, radius: Array) -> Array:
        """Angle, rad, of image radii (N,) that the lens shows."""

    @abstractmethod
    def radius_slopes(self, angle: Array) -> Array:
        """Derivative (..., p) of `radius` with respect to the coefficients at angles (...)."""

    def sees(self, points: Array) -> Mask:
        """As `Lens.sees`."""
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        r = np.sqrt(x * x + y * y)
        return np.asarray((np.arctan2(r, z) < self.end_rad) & ((r > 0) | (z > 0)))

    def project(self, points: Array) -> Array:
        """As `Lens.project`."""
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            r = np.sqrt(x * x + y * y)
            angle = np.arctan2(r, z)
            scale = np.where(angle < self.end_rad, self.radius(angle)[0] / r, np.nan)
            if not (r > 0).all():
                scale = np.where((r == 0) & (z > 0), 0.0, scale)
            image = np.empty((*points.shape[:-1], 2))
            np.multiply(x, scale, out=image[..., 0])
            np.multiply(y, scale, out=image[..., 1])
        return image

    def ray(self, image: Array) -> Array:
        """As `Lens.ray`."""
        x, y = image[..., 0], image[..., 1]
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            m = np.sqrt(x * x + y * y)
            end = float(self.radius(np.array([self.end_rad]))[0][0])
            angle = np.full(m.shape, np.nan)
            shown = m < end
            angle[shown] = self.angle(m[shown])
            sine = np.where(m > 0, np.sin(angle) / m, angle * 0 + 1)
        return np.stack([x * sine, y * sine, np.cos(angle)], axis=-1)

    def jacobian(self, points: Array) -> Array:
        """As `Lens.jacobian`."""
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            r2 = x * x + y * y
            r = np.sqrt(r2)
            angle = np.arctan2(r, z)
            radius, slope = self.radius(angle)
            c, s = np.where(r > 0, x / r, 1.0), np.where(r > 0, y / r, 0.0)
            outwards = slope * z / (r2 + z * z)
            around = np.where(r > 0, radius / r, outwards)
            J = np.empty((*points.shape[:-1], 2, 3))
            J[..., 0, 0] = c * c * outwards + s * s * around
            J[..., 0, 1] = c * s * (outwards - around)
            J[..., 1, 0] = J[..., 0, 1]
            J[..., 1, 1] = s * s * outwards + c * c * around
            along = -slope * r / (r2 + z * z)
            J[..., 0, 2] = c * along
            J[..., 1, 2] = s * along
        J[~self.sees(points)] = np.nan
        return J

    def slopes(self, points: Array) -> Array:
        """As `Lens.slopes`."""
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            r = np.sqrt(x * x + y * y)
            outwards = np.where(r[..., None] > 0, points[..., :2] / r[..., None], 0.0)
            J = np.asarray(outwards[..., None] * self.radius_slopes(np.arctan2(r, z))[..., None, :])
        J[~self.sees(points)] = np.nan
        return J

    def _root(self, radius: Array) -> Array:
        """Angles whose `radius` is (N,), all of them shown."""
        return growing_root(self.radius, radius, np.minimum(radius, self.end_rad), self.end_rad)
