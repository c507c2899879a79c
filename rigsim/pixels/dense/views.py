"""Pictures whose rows are epipolar lines though no perspective picture holds what they show.

Both have their axis along the baseline, x. A row is a half plane through it, so every point lies in the
same row of both pictures; along the row runs the angle from the plane across the baseline (longitude and
latitude with the poles on the baseline), or its tangent (a cylinder about the baseline). Disparity is then an
angle, or the baseline over the distance from it.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Literal, TypeAlias

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.lens.lens import Lens

RowView: TypeAlias = Literal["perspective", "cylinder", "latlong"]
"""What a pair is rectified to."""
VIEWS: tuple[RowView, ...] = ("perspective", "cylinder", "latlong")
"""All of them."""


def view_of(view: str | None) -> RowView | None:
    """The view of that name; None stays None.

    Raises:
        InvalidRange: it is none of `VIEWS`, nor None.
    """
    for known in VIEWS:
        if view == known:
            return known
    if view is not None:
        raise InvalidRange(f"rectify {view!r}: choose one of {', '.join(VIEWS)}")
    return None


@dataclass(frozen=True, slots=True)
class AxialView(Lens):
    """An image (along, row): row is the angle about x from the z axis towards y, rad."""

    @abstractmethod
    def along(self, x: Array, rho: Array) -> Array:
        """Coordinate along the row of what lies `x` along the axis and `rho` off it."""

    @abstractmethod
    def tangent(self, along: Array) -> Array:
        """``x / rho`` there; NaN where the view ends."""

    @abstractmethod
    def slope(self, x: Array, rho: Array) -> tuple[Array, Array]:
        """Derivative of `along` by x and by rho."""

    def sees(self, points: Array) -> Mask:
        """As `Lens.sees`: everything but the axis."""
        return np.asarray((points[..., 1] != 0) | (points[..., 2] != 0))

    def project(self, points: Array) -> Array:
        """As `Lens.project`."""
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            image = np.stack([self.along(x, np.hypot(y, z)), np.arctan2(y, z)], axis=-1)
        return np.where(self.sees(points)[..., None], image, np.nan)

    def slopes(self, points: Array) -> Array:
        """As `Lens.slopes`: it has no coefficients."""
        return np.zeros((*points.shape[:-1], 2, 0))

    def ray(self, image: Array) -> Array:
        """As `Lens.ray`."""
        tangent, row = self.tangent(image[..., 0]), image[..., 1]
        row = np.where(np.abs(row) <= np.pi, row, np.nan)
        cosine = 1 / np.hypot(tangent, 1)
        return np.stack([tangent * cosine, np.sin(row) * cosine, np.cos(row) * cosine], axis=-1)

    def jacobian(self, points: Array) -> Array:
        """As `Lens.jacobian`."""
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        rho = np.hypot(y, z)
        with np.errstate(divide="ignore", invalid="ignore"):
            by_x, by_rho = self.slope(x, rho)
            J = np.zeros((*points.shape[:-1], 2, 3))
            J[..., 0, 0], J[..., 0, 1], J[..., 0, 2] = by_x, by_rho * y / rho, by_rho * z / rho
            J[..., 1, 1], J[..., 1, 2] = z / rho**2, -y / rho**2
        J[~self.sees(points)] = np.nan
        return J


@dataclass(frozen=True, slots=True)
class Cylinder(AxialView):
    """The tangent along the row: disparity is ``f b / rho``."""

    model: ClassVar[str] = "cylinder"
    title: ClassVar[str] = "cylinder about the baseline"

    def along(self, x: Array, rho: Array) -> Array:
        """As `AxialView.along`."""
        return np.asarray(x / rho)

    def tangent(self, along: Array) -> Array:
        """As `AxialView.tangent`."""
        return along

    def slope(self, x: Array, rho: Array) -> tuple[Array, Array]:
        """As `AxialView.slope`."""
        return 1 / rho, -x / rho**2


@dataclass(frozen=True, slots=True)
class LatLong(AxialView):
    """The angle along the row: disparity is an angle."""

    model: ClassVar[str] = "latlong"
    title: ClassVar[str] = "longitude and latitude about the baseline"

    def along(self, x: Array, rho: Array) -> Array:
        """As `AxialView.along`."""
        return np.arctan2(x, rho)

    def tangent(self, along: Array) -> Array:
        """As `AxialView.tangent`."""
        return np.asarray(np.tan(np.where(np.abs(along) < np.pi / 2, along, np.nan)))

    def slope(self, x: Array, rho: Array) -> tuple[Array, Array]:
        """As `AxialView.slope`."""
        square = x * x + rho * rho
        return rho / square, -x / square
