"""Quintic B-spline interpolation along image rows (Unser, "Splines", IEEE Signal Processing Magazine, 1999).

On a rectified pair a match moves along its row only, so one dimension is enough: six taps a sample,
exact at pixel centres. Cubic splines leave up to 0.007 px of bias at texture of 0.35 cycles/px, quintic
ones 0.001 px, and at 0.48 cycles/px 0.02 px: `error_kernels` say how much it is for a given texture.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from rigsim.rig.arrays import Array

Indices = npt.NDArray[np.intp]

_PAD = 3
REACH = 14
"""Pixels on either side that `error_kernels` look at."""
_PHASES = 64
_FREQUENCIES = np.linspace(0.0, np.pi, 512, endpoint=False) + np.pi / 1024


@dataclass(frozen=True, slots=True, eq=False)
class RowSpline:
    """The splines through the rows of one image."""

    coefficients: Array
    """B-spline coefficients, (H, W + 6): three mirrored columns on either side."""

    @classmethod
    def through(cls, image: Array) -> RowSpline:
        """Splines through the pixels of `image` (H, W), mirrored at the ends; W must be at least 4."""
        coefficients = ndimage.spline_filter1d(image, order=5, axis=1, mode="mirror")
        return cls(np.pad(coefficients, ((0, 0), (_PAD, _PAD)), mode="reflect"))

    @property
    def width(self) -> int:
        """Width of the image, px."""
        return int(self.coefficients.shape[1]) - 2 * _PAD

    def sample(self, rows: Indices, u: Array) -> Array:
        """Values at columns `u` of `rows` (broadcast together), NaN outside the pixel centres."""
        inside = (u >= 0) & (u <= self.width - 1)
        # the last centre is the end of its interval, not the start of one beyond the image
        column = np.minimum(np.where(inside, u, 0.0).astype(np.intp), self.width - 2)
        first = rows * self.coefficients.shape[1] + column + (_PAD - 2)
        flat = self.coefficients.ravel()
        value = np.zeros(np.broadcast_shapes(np.shape(rows), u.shape))
        for tap, weight in enumerate(tap_weights(np.where(inside, u - column, np.nan))):
            value += weight * flat.take(first + tap)
        return value

    def derivative(self) -> Array:
        """Derivative along the row at the pixel centres, (H, W), grey/px."""
        c, end = self.coefficients, self.coefficients.shape[1] - _PAD
        near = c[:, _PAD + 1 : end + 1] - c[:, _PAD - 1 : end - 1]
        far = c[:, _PAD + 2 : end + 2] - c[:, _PAD - 2 : end - 2]
        return np.asarray(near * (10 / 24) + far / 24)


def tap_weights(fraction: Array) -> tuple[Array, ...]:
    """Weights of the six coefficients at -2 to 3 for positions `fraction` (0 to 1) right of number 0."""
    t, s = fraction, 1.0 - fraction
    t5, s5 = t**5, s**5
    t1, s1 = (1.0 + t) ** 5, (1.0 + s) ** 5
    # truncated powers: 120 B(x) = sum over k of (-1)^k binomial(6, k) max(3 - |x| - k, 0)^5
    return (
        s5 / 120,
        (s1 - 6 * s5) / 120,
        ((2.0 + s) ** 5 - 6 * s1 + 15 * s5) / 120,
        ((2.0 + t) ** 5 - 6 * t1 + 15 * t5) / 120,
        (t1 - 6 * t5) / 120,
        t5 / 120,
    )


def noise_gain(fraction: Array) -> Array:
    """Variance of white unit noise interpolated `fraction` (...) right of a pixel: 1 at 0, least at 0.5."""
    return np.asarray(np.mean(np.abs(_response(fraction, _FREQUENCIES)) ** 2, axis=-1))


def phase_of(position: Array) -> Indices:
    """Which of `error_kernels` belongs to positions (...) px."""
    return np.rint(np.nan_to_num(position) % 1.0 * _PHASES).astype(np.intp)


@lru_cache(maxsize=1)
def error_kernels() -> tuple[Array, Array]:
    """What the spline gets wrong of a picture it has to shift back, by the fraction of a pixel.

    A texture below half a cycle a pixel, sampled `fraction` off and interpolated there, comes back as itself
    plus its convolution with the kernel: ``sum over k of kernel[k] texture(u + k)``.

    Returns:
        Kernels (65, 2 REACH + 1) for the fractions 0 to 1 in steps of 1/64, and the sum of each over the
        derivative's own taps, (65,): what noise alone would make of the product of the two, px^-1.
    """
    fraction = np.arange(_PHASES + 1) / _PHASES
    w = _FREQUENCIES
    response = _response(fraction, w) * np.exp(-1j * w * fraction[:, None]) - 1
    k = np.arange(-REACH, REACH + 1)
    basis = np.exp(-1j * w[:, None] * k)  # kernel[k] multiplies the pixel k further right
    kernels = (response @ basis).real / len(w)
    outer = np.maximum(np.abs(k) - REACH / 2, 0) / (REACH / 2 + 1)
    kernels *= np.cos(np.pi / 2 * outer) ** 2
    taps = ((1j * _slope(w)) @ basis).real / len(w)
    return kernels, kernels @ taps


def _response(fraction: Array, w: Array) -> npt.NDArray[np.complex128]:
    """What `fraction` (...) right of a pixel becomes of unit waves of `w` (M,) radians a pixel, (..., M)."""
    response = np.zeros((*fraction.shape, len(w)), dtype=np.complex128)
    for offset, weight in zip(range(-2, 4), tap_weights(fraction), strict=True):
        response += weight[..., None] * np.exp(1j * w * offset)
    return np.asarray(response / _smoothing(w))


def _slope(w: Array) -> Array:
    """The derivative of unit waves at the pixel centres, over i."""
    return np.asarray(2 * (10 * np.sin(w) + np.sin(2 * w)) / 24 / _smoothing(w))


def derivative_noise_gain() -> float:
    """Variance of `RowSpline.derivative` of white unit noise, px^-2."""
    return float(np.mean(_slope(_FREQUENCIES) ** 2))


def _smoothing(w: Array) -> Array:
    return np.asarray((66 + 52 * np.cos(w) + 2 * np.cos(2 * w)) / 120)
