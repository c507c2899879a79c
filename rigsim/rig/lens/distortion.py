"""Brown-Conrady lens distortion in normalised coordinates (D. C. Brown, 1971; OpenCV's order of terms)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig import given
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.lens import polynomial, undistortion


@dataclass(frozen=True, slots=True)
class BrownConrady:
    """Radial k1, k2, k3 and tangential p1, p2; all zero is the ideal pinhole. No units: x/z and y/z.

    Example:
        >>> import rigsim
        >>> lens = rigsim.Intrinsics.from_focal(640, 480, 500.0, distortion=rigsim.BrownConrady(k1=-0.1))
        >>> u, v = lens.project([[0.5, 0, 1.0]])[0]
        >>> round(float(u - lens.cx), 3)  # 500 * .5 * (1 - .1 * .25)
        243.75
    """

    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    k3: float = 0.0

    def __post_init__(self) -> None:
        for name in ("k1", "k2", "p1", "p2", "k3"):
            value = given.real(getattr(self, name), f"distortion {name}", InvalidRig)
            if not np.isfinite(value):
                raise InvalidRig(f"distortion {name} {value}: must be a finite number")
            object.__setattr__(self, name, value)

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

    def jacobian(self, normalized: Array) -> Array:
        """Derivative (N, 2, 2) of `distort` with respect to the ideal coordinates."""
        return polynomial.jacobian(self.coefficients, normalized)

    def shows(self, normalized: Array) -> Mask:
        """Whether the lens shows ideal coordinates (..., 2): within the fold, and where p1 and p2 fold
        nothing either; there `distort` is one to one."""
        x, y = normalized[..., 0], normalized[..., 1]
        r2 = x * x + y * y
        shown = np.asarray(r2 < self.fold_radius2)
        if self.p1 == 0 and self.p2 == 0:
            return shown
        shown = shown & polynomial.is_one_to_one(self.coefficients, normalized)
        for dip2 in undistortion.dips2(self):
            with np.errstate(divide="ignore", invalid="ignore"):
                at_dip = normalized * np.sqrt(dip2 / r2)[..., None]
            shown &= (r2 <= dip2) | polynomial.is_one_to_one(self.coefficients, at_dip)
        return shown

    def undistort(self, distorted: Array) -> Array:
        """Invert `distort` (..., 2) to rounding; NaN where the lens shows no ideal point."""
        return undistortion.undistort(self, distorted)
