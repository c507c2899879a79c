"""The enhanced unified camera model of Khomutenko, Garcia and Martinet (2016)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.lens.lens import unit
from rigsim.rig.lens.quotient import QuotientLens


@dataclass(frozen=True, slots=True)
class Eucm(QuotientLens):
    """A point divided by ``alpha sqrt(beta (x^2 + y^2) + z^2) + (1 - alpha) z``; alpha 0 is the pinhole.

    With beta 1 it is the unified camera model.

    Example:
        >>> import numpy as np, rigsim
        >>> lens = rigsim.Eucm(alpha=0.5, beta=1.0)
        >>> lens.project(np.array([3.0, 0, 4.0])).tolist()  # 3 / (.5 * 5 + .5 * 4)
        [0.6666666666666666, 0.0]
    """

    model: ClassVar[str] = "eucm"
    title: ClassVar[str] = "enhanced unified"

    alpha: float = 0.0
    beta: float = 1.0

    def fault(self) -> str:
        """As `Lens.fault`."""
        if not 0 <= self.alpha <= 1:
            return f"alpha {self.alpha:g}: must be from 0 to 1"
        if not self.beta > 0:
            return f"beta {self.beta:g}: must be > 0"
        return ""

    @property
    def is_ideal(self) -> bool:
        """As `Lens.is_ideal`."""
        return self.alpha == 0

    def divisor(self, r2: Array, z: Array) -> Array:
        """As `QuotientLens.divisor`."""
        return np.asarray(self.alpha * np.sqrt(self.beta * r2 + z * z) + (1 - self.alpha) * z)

    def divisor_slope(self, r2: Array, z: Array) -> tuple[Array, Array]:
        """As `QuotientLens.divisor_slope`."""
        distance = np.sqrt(self.beta * r2 + z * z)
        return self.alpha * self.beta / distance, self.alpha * z / distance + 1 - self.alpha

    def divisor_slopes(self, r2: Array, z: Array) -> Array:
        """As `QuotientLens.divisor_slopes`."""
        distance = np.sqrt(self.beta * r2 + z * z)
        return np.stack([distance - z, self.alpha * r2 / (2 * distance)], axis=-1)

    def sees(self, points: Array) -> Mask:
        """As `Lens.sees`."""
        alpha = self.alpha
        w = alpha / (1 - alpha) if alpha <= 0.5 else (1 - alpha) / alpha
        x, y, z = points[..., 0], points[..., 1], points[..., 2]
        return np.asarray(z > -w * np.sqrt(self.beta * (x * x + y * y) + z * z))

    def ray(self, image: Array) -> Array:
        """As `Lens.ray`."""
        alpha, beta = self.alpha, self.beta
        x, y = image[..., 0], image[..., 1]
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            r2 = x * x + y * y
            inside = 1 - (2 * alpha - 1) * beta * r2
            z = (1 - beta * alpha * alpha * r2) / (alpha * np.sqrt(inside) + 1 - alpha)
            rays = unit(np.stack([x, y, z], axis=-1))
            rays[~self.sees(rays)] = np.nan
        return rays
