"""Whether a built rig is good: what its build errs over the image, and what pixel noise adds on top.

A rig reads a point at z instead of Z; noise then scatters what it reads, in proportion to z^2, as a depth
goes with one over a disparity. A rig is good when over all points of the image and all noise

- the root mean square of the errors is within the bound: per point ``(z - Z)^2 + 2 (z - Z) b + s^2 + 8 s^4
  / z^2 + b^2``, with the standard deviation s and the bias b that `rigsim.theory.uncertainty` predicts; or
- 95 of 100 errors are: the probability of each point, exact for noise that is normal in one over the depth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.inputs import BuildRequirement
from rigsim.theory.uncertainty import predict_depth_bias, predict_depth_std


@dataclass(frozen=True, slots=True, eq=False)
class Judge:
    """Holds rigs to a requirement at points (m, 3) of one depth."""

    required: BuildRequirement
    """The bound; its distance may be another than the points'."""
    z: Array
    """Depths of the points (m,) m."""
    std_m: Array
    """First-order standard deviation of each depth from pixel noise (m,) m; 0 without noise."""
    bias_m: Array
    """Bias of each depth from pixel noise (m,) m."""

    @property
    def noise_m(self) -> float:
        """Root mean square error of a rig built without any error, m."""
        return float(self.rms_m(self.z[None])[0])

    def rms_m(self, found: Array) -> Array:
        """Root mean square error (n,) m over points and noise of rigs that read depths (n, m) m.

        Infinite where a point has no depth.
        """
        with np.errstate(all="ignore"):
            ratio = found / self.z
            std, bias = self.std_m * ratio**2, self.bias_m * ratio**3
            error = found - self.z
            square = error * (error + 2 * bias) + std**2 * (1 + 8 * (std / found) ** 2) + bias**2
            mean = square.mean(axis=1)
        return np.sqrt(np.where(np.isnan(mean), np.inf, np.maximum(mean, 0.0)))

    def is_good(self, found: Array) -> Mask:
        """Which rigs (n,) that read depths (n, m) m are good; one that loses a point is not."""
        if not self.required.p95:
            return np.asarray(self.rms_m(found) <= self.required.error_m)
        bound, z = self.required.error_m, self.z
        with np.errstate(all="ignore"):
            std = self.std_m * found / z**2
            nearest = np.where(z > bound, found / np.where(z > bound, z - bound, 1.0) - 1, np.inf)
            within = ndtr(nearest / std) - ndtr((found / (z + bound) - 1) / std)
            within = np.where(std > 0, within, (np.abs(found - z) <= bound).astype(np.float64))
        within[~np.isfinite(found)] = 0.0
        lost = ~np.isfinite(found).all(axis=1)
        return np.asarray((within.mean(axis=1) >= 0.95) & ~lost)

    def at_first(self, count: int) -> Judge:
        """The same at the first `count` points."""
        return Judge(self.required, self.z[:count], self.std_m[:count], self.bias_m[:count])

    @property
    def without_noise(self) -> Judge:
        """The same for the build alone."""
        none = np.zeros_like(self.z)
        return Judge(self.required, self.z, none, none)


def make_judge(rig: StereoRig, points: Array, required: BuildRequirement, noise_px: float) -> Judge:
    """A judge of what `rig` is taken for, at points (m, 3) m, with `noise_px` on every pixel coordinate."""
    if noise_px == 0:
        return Judge(required, points[:, 2], np.zeros(len(points)), np.zeros(len(points)))
    noise = PixelNoise(noise_px)
    return Judge(
        required,
        points[:, 2],
        predict_depth_std(rig, points, noise),
        predict_depth_bias(rig, points, noise),
    )
