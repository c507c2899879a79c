"""Fisheyes of Kannala and Brandt ("A generic camera model", 2006), as OpenCV and Kalibr have them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.lens.angular import AngularLens


@dataclass(frozen=True, slots=True)
class KannalaBrandt(AngularLens):
    """Image radius ``t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8)`` for a ray at an angle t, rad, off the axis.

    All coefficients 0 is the equidistant fisheye.

    Example:
        >>> import rigsim
        >>> lens = rigsim.Intrinsics(1000, 1000, 300, 300, 499.5, 499.5, lens=rigsim.KannalaBrandt())
        >>> lens.project([[1.0, 0, 0]]).round(6).tolist()  # 90 degrees: 300 px times pi / 2
        [[970.738898, 499.5]]
    """

    model: ClassVar[str] = "kannala_brandt"
    title: ClassVar[str] = "Kannala-Brandt"

    k1: float = 0.0
    k2: float = 0.0
    k3: float = 0.0
    k4: float = 0.0

    @property
    def end_rad(self) -> float:
        """As `AngularLens.end_rad`: where the polynomial turns back."""
        return _turn(self.k1, self.k2, self.k3, self.k4)

    def radius(self, angle: Array) -> tuple[Array, Array]:
        """As `AngularLens.radius`."""
        k1, k2, k3, k4 = self.k1, self.k2, self.k3, self.k4
        s = angle * angle
        return (
            angle * (1 + s * (k1 + s * (k2 + s * (k3 + s * k4)))),
            1 + s * (3 * k1 + s * (5 * k2 + s * (7 * k3 + s * 9 * k4))),
        )

    def radius_slopes(self, angle: Array) -> Array:
        """As `AngularLens.radius_slopes`."""
        return np.stack([angle ** (2 * k + 1) for k in range(1, 5)], axis=-1)

    def angle(self, radius: Array) -> Array:
        """As `AngularLens.angle`."""
        return self._root(radius)


@lru_cache(maxsize=256)
def _turn(k1: float, k2: float, k3: float, k4: float) -> float:
    # the slope is 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3 + 9 k4 s^4, s the angle's square, here in 1/s
    roots = np.roots([1.0, 3 * k1, 5 * k2, 7 * k3, 9 * k4])
    real = roots.real[(np.abs(roots.imag) <= 1e-9 * np.abs(roots)) & (roots.real > 1e-12)]
    return min(math.pi, math.sqrt(1 / real.max())) if real.size else math.pi
