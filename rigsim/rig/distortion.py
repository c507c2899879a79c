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
            # past the fold of the polynomial Newton finds a mirrored root, or none
            J = self.jacobian(ideal)
            det = J[..., 0, 0] * J[..., 1, 1] - J[..., 0, 1] * J[..., 1, 0]
            unmet = ~(np.abs(self.distort(ideal) - distorted).max(axis=-1) < _ACCEPTED)
            # J is symmetric, and positive definite on the side of the fold that a lens shows
            wrong = unmet | ~(det > 0) | ~(J[..., 0, 0] > 0)
        ideal[wrong] = np.nan
        return ideal
