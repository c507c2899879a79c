"""Recalibration of a built rig: what epipolar errors and one known length tell of what it is off by.

The rig looks at features whose places it does not know, and at two marks whose distance it does. The
quantities follow by least squares with what is known of them beforehand (Gauss-Newton for all rigs at
once). What the pictures do not show, that holds where it was.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array, Ids
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.batch import PARAMETERS, Rays, RigBatch, read_rays
from rigsim.theory.uncertainty import pixel_gain

_STEP = 1e-4
_MOST_STEPS = 20
_STILL = 1e-6
_LONGEST = 2.0
_LEAST_NOISE_PX = 1e-3
_MARKS = 2
_MOVES = ("yaw_rad", "pitch_rad", "roll_rad", "baseline_m", "axial_m", "vertical_m")


@dataclass(frozen=True, slots=True, eq=False)
class Compensator:
    """What the calibration looks at, and how well."""

    rig: StereoRig
    """The assumed rig."""
    features_left: Array
    """Features (m, 3) m, whose places the calibration does not know."""
    marks_left: Array
    """Two marks (2, 3) m; their distance is known."""
    std: Array
    """Standard deviations (12,) of the quantities beforehand, in `PARAMETERS`' units; 0 is known."""
    noise_px: float = 0.025
    """Standard deviation of one pixel coordinate, after averaging over pictures."""
    length_std_m: float = 1e-4
    """Standard deviation of the known length, m; every rig is told one with an error of its own."""

    def __post_init__(self) -> None:
        if not (np.isfinite(self.std).all() and (self.std >= 0).all()):
            raise InvalidRange("compensator: standard deviations must be finite and >= 0")
        if not (np.isfinite(self.noise_px) and self.noise_px >= 0 and self.length_std_m > 0):
            raise InvalidRange("compensator: noise must be >= 0 px and the length's std > 0 m")

    @property
    def length_m(self) -> float:
        """The marks' true distance, m."""
        return float(np.linalg.norm(self.marks_left[1] - self.marks_left[0]))

    def observe(self, thetas: Array, rng: np.random.Generator) -> tuple[Array, Array]:
        """What rigs off by `thetas` (n, 12) have: pixels (4, n, m + 2), the marks last, and lengths (n,) m.

        Each length is what one calibration is told of the marks' distance, off by its own error.
        """
        points = np.concatenate([self.features_left, self.marks_left])
        pixels = RigBatch(self.rig, thetas).project(points)
        pixels += self.noise_px * rng.standard_normal(pixels.shape)
        # no tape reads less than nothing
        lengths_m = np.abs(self.length_m + self.length_std_m * rng.standard_normal(len(thetas)))
        return pixels, lengths_m

    def residuals(self, pixels: Array, lengths_m: Array, thetas: Array) -> Array:
        """Weighted residuals (n, m + 1 + 12): epipolar errors, the length's, and the quantities' own."""
        batch = RigBatch(self.rig, thetas)
        return self._residuals(batch, lengths_m, thetas, batch.rays(pixels, read_rays(self.rig, pixels)))

    def solve(self, pixels: Array, lengths_m: Array) -> Array:
        """The quantities (n, 12) that minimise the squared `residuals` of what was observed."""
        free = np.flatnonzero(self.std > 0).astype(np.int32)
        found = np.zeros((pixels.shape[1], len(PARAMETERS)))
        rays = read_rays(self.rig, pixels)
        moving = np.arange(len(found))
        for _ in range(_MOST_STEPS):
            step, rays = self._step(pixels, lengths_m, found[moving], rays, free)
            found[np.ix_(moving, free)] -= step * self.std[free]
            still = np.abs(step).max(axis=1, initial=0.0) <= _STILL
            if still.all():
                break
            # what has come to rest need not be looked at again
            if still.any():
                moving, pixels, lengths_m = moving[~still], pixels[:, ~still], lengths_m[~still]
                rays = Rays(
                    (rays.left[0][~still], rays.left[1][~still]),
                    (rays.right[0][~still], rays.right[1][~still]),
                )
        return found

    def _step(
        self, pixels: Array, lengths_m: Array, thetas: Array, start: Rays, free: Ids
    ) -> tuple[Array, Rays]:
        """One step (n, q) of Gauss-Newton, in standard deviations of the `free` quantities, and the rays."""
        batch = RigBatch(self.rig, thetas)
        rays = batch.rays(pixels, start)
        residual = self._residuals(batch, lengths_m, thetas, rays)
        J = np.empty((*residual.shape, len(free)))
        for place, k in enumerate(free):
            moved = thetas.copy()
            moved[:, k] += _STEP * self.std[k]
            batch = RigBatch(self.rig, moved)
            read = self._read_again(batch, PARAMETERS[k], pixels, rays)
            J[:, :, place] = (self._residuals(batch, lengths_m, moved, read) - residual) / _STEP
        # what one rig does not see has no say; what is known beforehand keeps the system regular
        hidden = ~(np.isfinite(residual) & np.isfinite(J).all(axis=2))
        residual[hidden] = 0.0
        J[hidden] = 0.0
        transposed = J.transpose(0, 2, 1)
        step = np.linalg.solve(transposed @ J, transposed @ residual[:, :, None])[:, :, 0]
        # far off, the slopes mislead: no step is longer than what is known beforehand allows
        return step / np.maximum(np.abs(step).max(axis=1, keepdims=True) / _LONGEST, 1.0), rays

    def _read_again(self, batch: RigBatch, name: str, pixels: Array, rays: Rays) -> Rays:
        """The rays after a tiny change of one quantity: only lenses bend them."""
        if name in _MOVES:
            return rays
        left = batch.rays_left(pixels, rays, 1) if name.startswith("both_") else rays.left
        return Rays(left, batch.rays_right(pixels, rays, 1))

    def _residuals(self, batch: RigBatch, lengths_m: Array, thetas: Array, rays: Rays) -> Array:
        noise_px = max(self.noise_px, _LEAST_NOISE_PX)
        epipolar = batch.epipolar_error_px(rays)[:, :-_MARKS] / noise_px
        (xl, yl), (xr, yr) = rays.left, rays.right
        marks = slice(-_MARKS, None)
        x, y, z = batch.triangulate(Rays((xl[:, marks], yl[:, marks]), (xr[:, marks], yr[:, marks])))
        length = np.sqrt(np.diff(x) ** 2 + np.diff(y) ** 2 + np.diff(z) ** 2)
        scaled = np.where(self.std > 0, thetas / np.where(self.std > 0, self.std, 1.0), 0.0)
        # in the inverse length, which disparity moves evenly: a mark read at infinity is no infinite error
        known = lengths_m[:, None]
        off = known * (1 - known / length) / self._length_sigma_m
        return np.concatenate([epipolar, off, scaled], axis=1)

    @property
    def _length_sigma_m(self) -> float:
        """Standard deviation of the length as triangulated: the marks' own, and the pixels'."""
        along = (self.marks_left[1] - self.marks_left[0]) / self.length_m
        gain = along @ pixel_gain(self.rig, self.marks_left)
        seen = float((gain**2).sum()) * self.noise_px**2
        return float(np.sqrt(self.length_std_m**2 + seen))
