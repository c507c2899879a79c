"""Brown-Conrady lens distortion in normalised coordinates (D. C. Brown, 1971; OpenCV's order of terms)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.lens import polynomial, undistortion
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.planar import NearlyRadialLens


@dataclass(frozen=True, slots=True)
class BrownConrady(NearlyRadialLens):
    """Radial k1, k2, k3 and tangential p1, p2; all zero is the ideal pinhole. No units: x/z and y/z.

    Example:
        >>> import rigsim
        >>> lens = rigsim.Intrinsics.from_focal(640, 480, 500.0, lens=rigsim.BrownConrady(k1=-0.1))
        >>> u, v = lens.project([[0.5, 0, 1.0]])[0]
        >>> round(float(u - lens.cx), 3)  # 500 * .5 * (1 - .1 * .25)
        243.75
    """

    model: ClassVar[str] = "brown"
    title: ClassVar[str] = "Brown-Conrady"

    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    k3: float = 0.0

    @property
    def is_ideal(self) -> bool:
        """Whether all coefficients are 0."""
        return not any(self.coefficients)

    @property
    def fold_radius2(self) -> float:
        """Squared ideal radius (x/z)^2 + (y/z)^2 at which the radial polynomial turns back; infinite if it
        never does. No lens shows what lies beyond: there the polynomial repeats the inner image."""
        return undistortion.fold_radius2(self.k1, self.k2, self.k3)

    @property
    def coefficients(self) -> polynomial.Coefficients:
        """k1, k2, p1, p2, k3."""
        return self.k1, self.k2, self.p1, self.p2, self.k3

    def distort(self, normalized: Array) -> Array:
        """Map ideal (N, 2) to distorted (N, 2) normalised coordinates."""
        return polynomial.distort(self.coefficients, normalized)

    def slope(self, normalized: Array) -> Array:
        """Derivative (N, 2, 2) of `distort` with respect to the ideal coordinates."""
        return polynomial.jacobian(self.coefficients, normalized)

    def distort_slopes(self, normalized: Array) -> Array:
        """As `PlanarLens.distort_slopes`."""
        return polynomial.slopes(normalized)

    def radial(self, radius: Array) -> tuple[Array, Array]:
        """As `NearlyRadialLens.radial`."""
        return polynomial.radial(self.coefficients, radius)

    @property
    def is_radial(self) -> bool:
        """As `NearlyRadialLens.is_radial`."""
        return self.p1 == 0 and self.p2 == 0

    def aside(self, radius: float) -> float:
        """As `NearlyRadialLens.aside`: p1 and p2 move a point by up to ``3 |p| r^2``."""
        return float(3 * np.hypot(self.p1, self.p2) * radius**2)

    def shows(self, normalized: Array) -> Mask:
        """Whether the lens shows ideal coordinates (..., 2): within the fold, and where p1 and p2 fold
        nothing either; there `distort` is one to one."""
        x, y = normalized[..., 0], normalized[..., 1]
        r2 = x * x + y * y
        shown = np.asarray(r2 < self.fold_radius2)
        if self.is_radial:
            return shown
        shown = shown & polynomial.is_one_to_one(self.coefficients, normalized)
        for dip2 in undistortion.dips2(self):
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                at_dip = normalized * np.sqrt(dip2 / r2)[..., None]
                shown &= (r2 <= dip2) | polynomial.is_one_to_one(self.coefficients, at_dip)
        return shown


def are_brown(*lenses: Lens | None) -> bool:
    """Whether all are of this model, whose coefficients they have; none is one of zeros."""
    return all(lens is None or isinstance(lens, BrownConrady) for lens in lenses)


def brown_of(lens: Lens | None, who: str) -> BrownConrady:
    """`lens` for what knows this model alone; all zeros for none.

    Raises:
        InvalidRig: it is another model; the message says what `who` takes.
    """
    if lens is None:
        return BrownConrady()
    if isinstance(lens, BrownConrady):
        return lens
    raise InvalidRig(f"lens {lens.said}: {who} takes Brown-Conrady's k1, k2, p1, p2, k3 alone")
