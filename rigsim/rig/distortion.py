"""Brown-Conrady lens distortion in normalised coordinates (D. C. Brown, 1971; OpenCV's order of terms)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array

_NEWTON_STEPS = 20
_CONVERGED = 1e-14
_ACCEPTED = 1e-9


@dataclass(frozen=True, slots=True)
class BrownConrady:
    """Radial k1, k2, k3 and tangential p1, p2; all zero is the ideal pinhole. No units: x/z and y/z."""

    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    k3: float = 0.0

    def __post_init__(self) -> None:
        for name in ("k1", "k2", "p1", "p2", "k3"):
            value = float(getattr(self, name))
            if not np.isfinite(value):
                raise InvalidRig(f"distortion {name} {value}: must be a finite number")
            object.__setattr__(self, name, value)

    @property
    def fold_radius2(self) -> float:
        """Squared ideal radius (x/z)^2 + (y/z)^2 at which the radial polynomial turns back; infinite if it
        never does. No lens shows what lies beyond: there the polynomial repeats the inner image."""
        # r (1 + k1 r^2 + k2 r^4 + k3 r^6) has slope 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3, s = r^2, here in 1/s
        roots = np.roots([1.0, 3 * self.k1, 5 * self.k2, 7 * self.k3])
        real = roots.real[(np.abs(roots.imag) <= 1e-9 * np.abs(roots)) & (roots.real > 1e-12)]
        return float(1 / real.max()) if real.size else np.inf

    def distort(self, normalized: Array) -> Array:
        """Map ideal (N, 2) to distorted (N, 2) normalised coordinates."""
        x, y = normalized[..., 0], normalized[..., 1]
        r2 = x * x + y * y
        radial = 1 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3))
        return np.stack(
            [
                x * radial + 2 * self.p1 * x * y + self.p2 * (r2 + 2 * x * x),
                y * radial + self.p1 * (r2 + 2 * y * y) + 2 * self.p2 * x * y,
            ],
            axis=-1,
        )

    def jacobian(self, normalized: Array) -> Array:
        """Derivative (N, 2, 2) of `distort` with respect to the ideal coordinates."""
        x, y = normalized[..., 0], normalized[..., 1]
        r2 = x * x + y * y
        radial = 1 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3))
        slope = 2 * (self.k1 + r2 * (2 * self.k2 + 3 * r2 * self.k3))  # d radial / d x = x * slope
        cross = x * y * slope + 2 * self.p1 * x + 2 * self.p2 * y
        jacobian = np.empty((*normalized.shape, 2))
        jacobian[..., 0, 0] = radial + x * x * slope + 2 * self.p1 * y + 6 * self.p2 * x
        jacobian[..., 0, 1] = cross
        jacobian[..., 1, 0] = cross
        jacobian[..., 1, 1] = radial + y * y * slope + 6 * self.p1 * y + 2 * self.p2 * x
        return jacobian

    def undistort(self, distorted: Array) -> Array:
        """Invert `distort` by Newton's method; NaN where no ideal point maps there."""
        ideal = np.array(distorted, dtype=np.float64)
        with np.errstate(all="ignore"):
            for _ in range(_NEWTON_STEPS):
                residual = self.distort(ideal) - distorted
                J = self.jacobian(ideal)
                det = J[..., 0, 0] * J[..., 1, 1] - J[..., 0, 1] * J[..., 1, 0]
                ideal[..., 0] -= (J[..., 1, 1] * residual[..., 0] - J[..., 0, 1] * residual[..., 1]) / det
                ideal[..., 1] -= (J[..., 0, 0] * residual[..., 1] - J[..., 1, 0] * residual[..., 0]) / det
                if np.nanmax(np.abs(residual), initial=0.0) < _CONVERGED:
                    break
            # past the fold Newton finds a root of another branch, or none
            unmet = ~(np.abs(self.distort(ideal) - distorted).max(axis=-1) < _ACCEPTED)
            wrong = unmet | ~((ideal**2).sum(axis=-1) < self.fold_radius2)
        ideal[wrong] = np.nan
        return ideal
