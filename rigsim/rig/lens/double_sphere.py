"""The double sphere model of Usenko, Demmel and Cremers (2018), as Basalt and Kalibr have it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.lens.quotient import QuotientLens


@dataclass(frozen=True, slots=True)
class DoubleSphere(QuotientLens):
    """A point goes to one sphere, to a second one `xi` further on, and through a pinhole set back by `alpha`.

    Equations 40 to 52 of the paper. Both 0 is the ideal pinhole; its focal lengths are in fx and fy.

    Example:
        >>> import numpy as np, rigsim
        >>> lens = rigsim.DoubleSphere(xi=0.0, alpha=0.5)
        >>> lens.project(np.array([3.0, 0, 4.0])).tolist()  # 3 / (.5 * 5 + .5 * 4)
        [0.6666666666666666, 0.0]
    """

    model: ClassVar[str] = "double_sphere"
    title: ClassVar[str] = "double sphere"

    xi: float = 0.0
    alpha: float = 0.0

    def fault(self) -> str:
        """As `Lens.fault`."""
        if not self.xi > -1:
            return f"xi {self.xi:g}: must be > -1, or no ray reaches the axis"
        if not 0 <= self.alpha <= 1:
            return f"alpha {self.alpha:g}: must be from 0 to 1"
        return ""

    @property
    def is_ideal(self) -> bool:
        """As `Lens.is_ideal`: only up to the focal length where xi is not 0."""
        return self.xi == self.alpha == 0

    def divisor(self, r2: Array, z: Array) -> Array:
        """As `QuotientLens.divisor`."""
        shifted = self.xi * np.sqrt(r2 + z * z) + z
        return np.asarray(self.alpha * np.sqrt(r2 + shifted * shifted) + (1 - self.alpha) * shifted)

    def divisor_slope(self, r2: Array, z: Array) -> tuple[Array, Array]:
        """As `QuotientLens.divisor_slope`."""
        alpha, xi = self.alpha, self.xi
        first = np.sqrt(r2 + z * z)
        shifted = xi * first + z
        second = np.sqrt(r2 + shifted * shifted)
        return (
            alpha * (1 + shifted * xi / first) / second + (1 - alpha) * xi / first,
            (xi * z / first + 1) * (alpha * shifted / second + 1 - alpha),
        )

    def divisor_slopes(self, r2: Array, z: Array) -> Array:
        """As `QuotientLens.divisor_slopes`."""
        first = np.sqrt(r2 + z * z)
        shifted = self.xi * first + z
        second = np.sqrt(r2 + shifted * shifted)
        by_shift = self.alpha * shifted / second + 1 - self.alpha
        return np.stack([first * by_shift, second - shifted], axis=-1)

    def sees(self, points: Array) -> Mask:
        """As `Lens.sees`; equations 43 to 45."""
        alpha, xi = self.alpha, self.xi
        w1 = alpha / (1 - alpha) if alpha <= 0.5 else (1 - alpha) / alpha
        w2 = (w1 + xi) / math.sqrt(2 * w1 * xi + xi * xi + 1)
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        return np.asarray(z > -w2 * np.sqrt(x * x + y * y + z * z))

    def ray(self, image: Array) -> Array:
        """As `Lens.ray`; equations 46 to 52."""
        alpha, xi = self.alpha, self.xi
        x, y = image[..., 0], image[..., 1]
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            r2 = x * x + y * y
            z = (1 - alpha * alpha * r2) / (alpha * np.sqrt(1 - (2 * alpha - 1) * r2) + 1 - alpha)
            scale = (z * xi + np.sqrt(z * z + (1 - xi * xi) * r2)) / (z * z + r2)
            rays = np.stack([x * scale, y * scale, z * scale - xi], axis=-1)
            rays[~self.sees(rays)] = np.nan
        return rays
