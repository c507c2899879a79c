"""OpenCV's lens of up to 14 terms: a radial quotient, tangential and thin-prism terms, a tilted sensor."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import ClassVar

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.lens import polynomial
from rigsim.rig.lens.planar import NearlyRadialLens

_MOST_TILT_RAD = math.radians(80)


@dataclass(frozen=True, slots=True)
class Rational(NearlyRadialLens):
    """Radius times ``(1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)``, and more.

    p1, p2 as Brown-Conrady's; thin prism s1 r^2 + s2 r^4 along x and s3 r^2 + s4 r^4 along y; the sensor
    turned by tau_x, then tau_y, rad. OpenCV's names, signs and order (calib3d, its detailed description).

    Example:
        >>> import numpy as np, rigsim
        >>> lens = rigsim.Rational(k1=0.5, k4=0.25)
        >>> lens.project(np.array([2.0, 0, 1.0])).tolist()  # 2 (1 + .5 * 4) / (1 + .25 * 4)
        [3.0, 0.0]
    """

    model: ClassVar[str] = "rational"
    title: ClassVar[str] = "rational"

    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    k3: float = 0.0
    k4: float = 0.0
    k5: float = 0.0
    k6: float = 0.0
    s1: float = 0.0
    s2: float = 0.0
    s3: float = 0.0
    s4: float = 0.0
    tau_x: float = 0.0
    tau_y: float = 0.0

    def fault(self) -> str:
        """As `Lens.fault`."""
        for name in ("tau_x", "tau_y"):
            tilt = getattr(self, name)
            if abs(tilt) > _MOST_TILT_RAD:
                return f"{name} {tilt:g} rad: must be less than 80 degrees"
        return ""

    @property
    def is_ideal(self) -> bool:
        """As `Lens.is_ideal`."""
        return not any(getattr(self, name) for name in self.names())

    @property
    def fold_radius2(self) -> float:
        """As `PlanarLens.fold_radius2`: of the radial quotient."""
        return _fold_radius2((self.k1, self.k2, self.k3), (self.k4, self.k5, self.k6))

    @property
    def is_radial(self) -> bool:
        """As `NearlyRadialLens.is_radial`."""
        return not any((self.p1, self.p2, self.s1, self.s2, self.s3, self.s4, self.tau_x, self.tau_y))

    def aside(self, radius: float) -> float:
        """As `NearlyRadialLens.aside`, before the tilt."""
        if not np.isfinite(radius):
            return float(np.inf)
        r2 = radius**2
        prism = math.hypot(abs(self.s1) + abs(self.s2) * r2, abs(self.s3) + abs(self.s4) * r2)
        return (3 * math.hypot(self.p1, self.p2) + prism) * r2

    def radial(self, radius: Array) -> tuple[Array, Array]:
        """As `NearlyRadialLens.radial`."""
        s = radius * radius
        factor, slope = self._quotient(s)
        return radius * factor, factor + s * slope

    def distort(self, normalized: Array) -> Array:
        """Map ideal (..., 2) to distorted (..., 2) coordinates."""
        image = np.empty(normalized.shape)
        x, y = normalized[..., 0], normalized[..., 1]
        s = x * x
        s += y * y
        factor = self._factor(s)
        u = np.multiply(x, factor, out=image[..., 0])
        v = np.multiply(y, factor, out=image[..., 1])
        if self.p1 or self.p2:
            xy = 2 * x * y
            u += self.p1 * xy + self.p2 * (s + 2 * x * x)
            v += self.p1 * (s + 2 * y * y) + self.p2 * xy
        if self.s1 or self.s2:
            u += s * (self.s1 + s * self.s2)
        if self.s3 or self.s4:
            v += s * (self.s3 + s * self.s4)
        return _through(_tilt(self.tau_x, self.tau_y), image) if self.tau_x or self.tau_y else image

    def slope(self, normalized: Array) -> Array:
        """Derivative (..., 2, 2) of `distort` with respect to the ideal coordinates."""
        J = self._slope_before_tilt(normalized)
        if not (self.tau_x or self.tau_y):
            return J
        flat = replace(self, tau_x=0.0, tau_y=0.0).distort(normalized)
        return np.asarray(_through_slope(_tilt(self.tau_x, self.tau_y), flat) @ J)

    def distort_slopes(self, normalized: Array) -> Array:
        """As `PlanarLens.distort_slopes`."""
        x, y = normalized[..., 0], normalized[..., 1]
        s = x * x + y * y
        factor, under = self._factor(s), 1 + s * (self.k4 + s * (self.k5 + s * self.k6))
        J = np.zeros((*normalized.shape, 14))
        J[..., :5] = polynomial.slopes(normalized)
        J[..., (0, 1, 4)] /= under[..., None, None]
        J[..., 5:8] = -factor[..., None, None] * J[..., (0, 1, 4)]
        for place, axis, power in ((8, 0, s), (9, 0, s * s), (10, 1, s), (11, 1, s * s)):
            J[..., axis, place] = power
        flat = replace(self, tau_x=0.0, tau_y=0.0).distort(normalized)
        if self.tau_x or self.tau_y:
            J = np.asarray(_through_slope(_tilt(self.tau_x, self.tau_y), flat) @ J)
        for place, turned in enumerate(_tilt_slopes(self.tau_x, self.tau_y), start=12):
            J[..., place] = _through_turned(_tilt(self.tau_x, self.tau_y), turned, flat)
        return J

    def shows(self, normalized: Array) -> Mask:
        """As `PlanarLens.shows`: within the fold, and where nothing else folds."""
        x, y = normalized[..., 0], normalized[..., 1]
        shown = np.asarray(x * x + y * y < self.fold_radius2)
        if self.is_radial:
            return shown
        with np.errstate(all="ignore"):
            J = self._slope_before_tilt(normalized)
            a, b, c, d = J[..., 0, 0], J[..., 0, 1], J[..., 1, 0], J[..., 1, 1]
            shown &= (a * d > b * c) & (a + d > 0)
            if self.tau_x or self.tau_y:
                flat = replace(self, tau_x=0.0, tau_y=0.0).distort(normalized)
                row = _tilt(self.tau_x, self.tau_y)[2]
                shown &= row[0] * flat[..., 0] + row[1] * flat[..., 1] + row[2] > 0
        return shown

    def undistort(self, distorted: Array) -> Array:
        """Invert `distort` (..., 2) to rounding; NaN where the lens shows no ideal point."""
        if not (self.tau_x or self.tau_y):
            return NearlyRadialLens.undistort(self, distorted)
        back = np.linalg.inv(_tilt(self.tau_x, self.tau_y))
        with np.errstate(all="ignore"):
            flat = _through(np.asarray(back), np.asarray(distorted, dtype=np.float64))
        return replace(self, tau_x=0.0, tau_y=0.0).undistort(flat)

    def _factor(self, s: Array) -> Array:
        over = 1 + s * (self.k1 + s * (self.k2 + s * self.k3))
        if self.k4 or self.k5 or self.k6:
            over /= 1 + s * (self.k4 + s * (self.k5 + s * self.k6))
        return np.asarray(over)

    def _quotient(self, s: Array) -> tuple[Array, Array]:
        """The radial factor of squared radii, and twice its derivative by them."""
        factor = self._factor(s)
        under = 1 + s * (self.k4 + s * (self.k5 + s * self.k6))
        over_slope = 2 * (self.k1 + s * (2 * self.k2 + 3 * s * self.k3))
        under_slope = 2 * (self.k4 + s * (2 * self.k5 + 3 * s * self.k6))
        return factor, (over_slope - factor * under_slope) / under

    def _slope_before_tilt(self, normalized: Array) -> Array:
        x, y = normalized[..., 0], normalized[..., 1]
        s = x * x + y * y
        factor, slope = self._quotient(s)
        p1, p2 = self.p1, self.p2
        J = np.empty((*normalized.shape, 2))
        prism_x, prism_y = 2 * (self.s1 + 2 * s * self.s2), 2 * (self.s3 + 2 * s * self.s4)
        cross = x * y * slope + 2 * p1 * x + 2 * p2 * y
        J[..., 0, 0] = factor + x * x * slope + 2 * p1 * y + 6 * p2 * x + prism_x * x
        J[..., 0, 1] = cross + prism_x * y
        J[..., 1, 0] = cross + prism_y * x
        J[..., 1, 1] = factor + y * y * slope + 6 * p1 * y + 2 * p2 * x + prism_y * y
        return J


def _through(H: Array, image: Array) -> Array:
    """Image coordinates (..., 2) through a homography (3, 3)."""
    moved = image @ H[:2, :2].T + H[:2, 2]
    return np.asarray(moved / (image @ H[2, :2] + H[2, 2])[..., None])


def _through_slope(H: Array, image: Array) -> Array:
    """Derivative (..., 2, 2) of `_through`."""
    moved, w = _through(H, image), image @ H[2, :2] + H[2, 2]
    return np.asarray((H[:2, :2] - moved[..., :, None] * H[2, :2]) / w[..., None, None])


def _through_turned(H: Array, change: Array, image: Array) -> Array:
    """Change (..., 2) of `_through` as H changes by `change` (3, 3)."""
    moved, w = _through(H, image), image @ H[2, :2] + H[2, 2]
    by = image @ change[:, :2].T + change[:, 2]
    return np.asarray((by[..., :2] - moved * by[..., 2:]) / w[..., None])


@lru_cache(maxsize=256)
def _tilt_slopes(tau_x: float, tau_y: float) -> tuple[Array, Array]:
    """Derivatives of `_tilt` by both angles: ``onto' R + onto R'``."""
    cx, sx, cy, sy = math.cos(tau_x), math.sin(tau_x), math.cos(tau_y), math.sin(tau_y)
    about_x = np.array([[1, 0, 0], [0, cx, sx], [0, -sx, cx]])
    about_y = np.array([[cy, 0, -sy], [0, 1, 0], [sy, 0, cy]])
    slope_x = np.array([[0, 0, 0], [0, -sx, cx], [0, -cx, -sx]])
    slope_y = np.array([[-sy, 0, -cy], [0, 0, 0], [cy, 0, -sy]])
    R = about_y @ about_x

    def along(change: Array) -> Array:
        by = np.array([[change[2, 2], 0, -change[0, 2]], [0, change[2, 2], -change[1, 2]], [0, 0, 0]])
        return np.asarray(by @ R + _onto(R) @ change)

    return along(about_y @ slope_x), along(slope_y @ about_x)


def _onto(R: Array) -> Array:
    """``[R33 0 -R13; 0 R33 -R23; 0 0 1]``."""
    return np.array([[R[2, 2], 0, -R[0, 2]], [0, R[2, 2], -R[1, 2]], [0, 0, 1]])


@lru_cache(maxsize=256)
def _tilt(tau_x: float, tau_y: float) -> Array:
    """From the untilted to the tilted sensor, (3, 3): ``[R33 0 -R13; 0 R33 -R23; 0 0 1] R``."""
    cx, sx, cy, sy = math.cos(tau_x), math.sin(tau_x), math.cos(tau_y), math.sin(tau_y)
    about_x = np.array([[1, 0, 0], [0, cx, sx], [0, -sx, cx]])
    about_y = np.array([[cy, 0, -sy], [0, 1, 0], [sy, 0, cy]])
    R = about_y @ about_x
    return np.asarray(_onto(R) @ R)


@lru_cache(maxsize=256)
def _fold_radius2(over: tuple[float, float, float], under: tuple[float, float, float]) -> float:
    """Squared radius at which the radial quotient first turns back, or has its pole; infinite if never."""
    # polynomials of s = r^2, the lowest power first
    N, M = np.array([1.0, *over]), np.array([1.0, *under])
    s = np.array([0.0, 1.0])
    poly = np.polynomial.polynomial
    N_slope, M_slope = poly.polyder(N), poly.polyder(M)
    turn = poly.polysub(
        poly.polymul(poly.polyadd(N, 2 * poly.polymul(s, N_slope)), M),
        2 * poly.polymul(s, poly.polymul(N, M_slope)),
    )
    ends = [_first_root(turn), _first_root(M)]
    return min(ends)


def _first_root(polynomial: Array) -> float:
    """The least positive root; infinite where there is none. The lowest power comes first, and is not 0."""
    roots = np.roots(polynomial)  # of 1/s, as np.roots takes the highest power first
    real = roots.real[(np.abs(roots.imag) <= 1e-9 * np.abs(roots)) & (roots.real > 1e-12)]
    return float(1 / real.max()) if real.size else float(np.inf)
