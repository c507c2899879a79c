"""Recalibration of a built rig: what epipolar errors and known lengths tell of what it is off by.

The rig looks at features whose places it does not know, and at pairs of marks whose distances it does:
across the image at several depths they tell the baseline and where disparity 0 is, whatever the focal length
(X = u B / d); along the depth they tell the focal length that both cameras share (Z = f B / d). The
quantities follow by least squares with what is known of them beforehand (Gauss-Newton for all rigs at once).
What the pictures do not show, that holds where it was.
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
_RIDGE = 1e-12
_LONGEST = 2.0
_LEAST_NOISE_PX = 1e-3
_MOVES = ("yaw_rad", "pitch_rad", "roll_rad", "baseline_m", "axial_m", "vertical_m")


@dataclass(frozen=True, slots=True, eq=False)
class Compensator:
    """What the calibration looks at, and how well."""

    rig: StereoRig
    """The assumed rig."""
    features_left: Array
    """Features (m, 3) m, whose places the calibration does not know."""
    marks_left: Array
    """Pairs of marks (2 k, 3) m, one after the other; the distance of each pair is known."""
    std: Array
    """Standard deviations (12,) of the quantities beforehand, in `PARAMETERS`' units; 0 is known."""
    noise_px: float = 0.025
    """Standard deviation of one pixel coordinate, after averaging over pictures."""
    length_std_m: float = 1e-4
    """Standard deviation of a known length, m; every rig is told each with an error of its own."""

    def __post_init__(self) -> None:
        if not (np.isfinite(self.std).all() and (self.std >= 0).all()):
            raise InvalidRange("compensator: standard deviations must be finite and >= 0")
        if not (np.isfinite(self.noise_px) and self.noise_px >= 0 and self.length_std_m > 0):
            raise InvalidRange("compensator: noise must be >= 0 px and the length's std > 0 m")

    @property
    def lengths_m(self) -> Array:
        """The true distances (k,) of the pairs of marks, m."""
        return np.asarray(np.linalg.norm(self.marks_left[1::2] - self.marks_left[::2], axis=1))

    def observe(self, thetas: Array, rng: np.random.Generator) -> tuple[Array, Array]:
        """What rigs off by `thetas` (n, 12) have: pixels (4, n, m + 2 k), marks last, and lengths (n, k) m.

        Each length is what one calibration is told of a pair's distance, off by its own error.
        """
        points = np.concatenate([self.features_left, self.marks_left])
        pixels = RigBatch(self.rig, thetas).project(points)
        pixels += self.noise_px * rng.standard_normal(pixels.shape)
        # no tape reads less than nothing
        true_m = self.lengths_m
        lengths_m = np.abs(true_m + self.length_std_m * rng.standard_normal((len(thetas), len(true_m))))
        return pixels, lengths_m

    def residuals(self, pixels: Array, lengths_m: Array, thetas: Array) -> Array:
        """Weighted residuals (n, m + k + 12): epipolar errors, the lengths', and the quantities' own."""
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
        residual, J, rays = self._slopes(pixels, lengths_m, thetas, start, free)
        transposed = J.transpose(0, 2, 1)
        normal, toward = transposed @ J, (transposed @ residual[:, :, None])[:, :, 0]
        # a mark read near infinity outweighs all else: each quantity in its own measure, and a rank held up
        scale = 1 / np.sqrt(np.einsum("nqq->nq", normal))
        normal = normal * scale[:, :, None] * scale[:, None, :] + _RIDGE * np.eye(len(free))
        step = scale * np.linalg.solve(normal, (scale * toward)[:, :, None])[:, :, 0]
        # far off, the slopes mislead: no step is longer than what is known beforehand allows
        return step / np.maximum(np.abs(step).max(axis=1, keepdims=True) / _LONGEST, 1.0), rays

    def information(self) -> Array:
        """What one calibration tells, to first order: the inverse (12, 12) of the quantities' covariance.

        Infinite on the diagonal where a quantity is known.
        """
        free = np.flatnonzero(self.std > 0).astype(np.int32)
        exact = np.zeros((1, len(PARAMETERS)))
        points = np.concatenate([self.features_left, self.marks_left])
        pixels = RigBatch(self.rig, exact).project(points)
        _, J, _ = self._slopes(pixels, self.lengths_m[None], exact, read_rays(self.rig, pixels), free)
        J = J[0] / self.std[free]
        found = np.diag(np.full(len(PARAMETERS), np.inf))
        found[np.ix_(free, free)] = J.T @ J
        return found

    def _slopes(
        self, pixels: Array, lengths_m: Array, thetas: Array, start: Rays, free: Ids
    ) -> tuple[Array, Array, Rays]:
        """Residuals (n, r), their slopes (n, r, q) in standard deviations of `free`, and the rays."""
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
        return residual, J, rays

    def _read_again(self, batch: RigBatch, name: str, pixels: Array, rays: Rays) -> Rays:
        """The rays after a tiny change of one quantity: only lenses bend them."""
        if name in _MOVES:
            return rays
        left = batch.rays_left(pixels, rays, 1) if name.startswith("both_") else rays.left
        return Rays(left, batch.rays_right(pixels, rays, 1))

    def _residuals(self, batch: RigBatch, lengths_m: Array, thetas: Array, rays: Rays) -> Array:
        noise_px = max(self.noise_px, _LEAST_NOISE_PX)
        (xl, yl), (xr, yr) = rays.left, rays.right
        features = len(self.features_left)
        epipolar = batch.epipolar_error_px(rays)[:, :features] / noise_px
        marks = slice(features, None)
        x, y, z = batch.triangulate(Rays((xl[:, marks], yl[:, marks]), (xr[:, marks], yr[:, marks])))
        length = np.sqrt(sum((along[:, 1::2] - along[:, ::2]) ** 2 for along in (x, y, z)))
        scaled = np.where(self.std > 0, thetas / np.where(self.std > 0, self.std, 1.0), 0.0)
        # in the inverse length, which disparity moves evenly: a mark read at infinity is no infinite error
        off = lengths_m * (1 - lengths_m / length) / self._length_sigma_m
        return np.concatenate([epipolar, off, scaled], axis=1)

    @property
    def _length_sigma_m(self) -> Array:
        """Standard deviations (k,) of the lengths as triangulated: the marks' own, and the pixels'."""
        along = (self.marks_left[1::2] - self.marks_left[::2]) / self.lengths_m[:, None]
        gain = pixel_gain(self.rig, self.marks_left)
        seen = (
            sum((np.einsum("ki,kij->kj", along, gain[mark::2]) ** 2).sum(axis=1) for mark in range(2))
            * self.noise_px**2
        )
        return np.asarray(np.sqrt(self.length_std_m**2 + seen))
