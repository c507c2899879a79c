"""What stands between an exact projection and a pixel position somebody measured."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from rigsim.errors import InvalidNoise, InvalidRange
from rigsim.rig import given
from rigsim.rig.arrays import Array

_Noise = TypeVar("_Noise")

_NAMES = {
    "std_px": "noise",
    "correlation": "noise correlation",
    "quantization_px": "quantisation",
    "outlier_fraction": "outlier fraction",
    "outlier_px": "outlier size",
}


@dataclass(frozen=True, slots=True)
class PixelNoise:
    """Gaussian noise on every pixel coordinate, equal in both images.

    Example:
        >>> import rigsim
        >>> round(rigsim.PixelNoise(0.25).disparity_std_px, 4)  # both images have it
        0.3536
        >>> rigsim.PixelNoise(0.25, correlation=1.0).disparity_std_px
        0.0
    """

    std_px: float
    """Standard deviation per coordinate and image, px."""
    correlation: float = 0.0
    """Correlation of the left with the right image's noise, per coordinate, -1 to 1."""
    quantization_px: float = 0.0
    """Step the position is rounded to, px; 0 is none, 1 is whole pixels."""
    outlier_fraction: float = 0.0
    """Share of points whose right position is replaced by one within `outlier_px`, 0 to 1."""
    outlier_px: float = 20.0
    """Half width of the square from which outliers are drawn, px."""

    def __post_init__(self) -> None:
        for item, name in _NAMES.items():
            value = given.real(getattr(self, item), name, InvalidNoise)
            object.__setattr__(self, item, value)
        for name, value in (
            ("noise", self.std_px),
            ("quantisation", self.quantization_px),
            ("outlier size", self.outlier_px),
        ):
            if not (math.isfinite(value) and value >= 0):
                raise InvalidNoise(f"{name} {value:g} px: must be >= 0 and finite")
        if not -1 <= self.correlation <= 1:
            raise InvalidNoise(f"noise correlation {self.correlation:g}: must be between -1 and 1")
        if not 0 <= self.outlier_fraction <= 1:
            raise InvalidNoise(f"outlier fraction {self.outlier_fraction:g}: must be between 0 and 1")

    @property
    def coordinate_var_px2(self) -> float:
        """Variance of one coordinate, px^2, rounding included (uniform: step^2 / 12)."""
        return self.std_px**2 + self.quantization_px**2 / 12

    @property
    def disparity_std_px(self) -> float:
        """Standard deviation of ``u_left - u_right``, px; sqrt(2) of the coordinate's when uncorrelated."""
        return math.sqrt(2 * self.std_px**2 * (1 - self.correlation) + 2 * self.quantization_px**2 / 12)

    @property
    def covariance_px2(self) -> Array:
        """Covariance (4, 4) px^2 of (u_left, v_left, u_right, v_right)."""
        shared = self.std_px**2 * self.correlation
        return self.coordinate_var_px2 * np.eye(4) + shared * np.eye(4)[[2, 3, 0, 1]]

    def apply(self, uv_left: Array, uv_right: Array, rng: np.random.Generator) -> tuple[Array, Array]:
        """Noisy copies of pixel positions (..., 2)."""
        shape = np.broadcast_shapes(uv_left.shape, uv_right.shape)
        unit_left, unit_right = rng.standard_normal(shape), rng.standard_normal(shape)
        if self.correlation:
            rho = self.correlation
            unit_right = rho * unit_left + math.sqrt(1 - rho * rho) * unit_right
        noisy_left = uv_left + self.std_px * unit_left
        noisy_right = uv_right + self.std_px * unit_right
        if self.outlier_fraction:
            outlier = rng.random(shape[:-1]) < self.outlier_fraction
            offset = rng.uniform(-self.outlier_px, self.outlier_px, shape)
            noisy_right = np.where(outlier[..., None], uv_right + offset, noisy_right)
        if self.quantization_px:
            step = self.quantization_px
            noisy_left = np.round(noisy_left / step) * step
            noisy_right = np.round(noisy_right / step) * step
        return noisy_left, noisy_right


def as_noise(value: object) -> PixelNoise:
    """A noise: as it is, or a number, the standard deviation per coordinate in px.

    Raises:
        InvalidNoise: it is neither, or cannot be.
    """
    if isinstance(value, PixelNoise):
        return value
    try:
        std_px = given.real(value, "noise", InvalidNoise)
    except InvalidNoise:
        raise InvalidNoise(
            f"noise {given.shown(value)}: must be a PixelNoise, or a number: the std of a coordinate in px"
        ) from None
    return PixelNoise(std_px)


def coordinate_noise_px(noise_px: _Noise | None, disparity_noise_px: object) -> _Noise | float | None:
    """Noise of one pixel coordinate, px, however it was said; None where it was not.

    Args:
        noise_px: it, as it comes; or None.
        disparity_noise_px: standard deviation of a disparity, px, instead: sqrt(2) times as much; or None.

    Raises:
        InvalidRange: it is said both ways.
        InvalidNoise: the disparity's is no number, or cannot be.
    """
    if disparity_noise_px is None:
        return noise_px
    if noise_px is not None:
        raise _both((noise_px,), (disparity_noise_px,))
    return _of_coordinate_px(disparity_noise_px)


def coordinate_noises_px(noises_px: object, disparity_noises_px: object) -> tuple[object, ...] | None:
    """The same for one or several."""
    if disparity_noises_px is None:
        return None if noises_px is None else given.several(noises_px)
    of_disparity = given.several(disparity_noises_px)
    if noises_px is not None:
        raise _both(given.several(noises_px), of_disparity)
    return tuple(_of_coordinate_px(value) for value in of_disparity)


def _of_coordinate_px(disparity_noise_px: object) -> float:
    return _of_disparity_px(disparity_noise_px) / math.sqrt(2)


def _of_disparity_px(value: object) -> float:
    px = given.real(value, "disparity noise", InvalidNoise)
    if not (math.isfinite(px) and px >= 0):
        raise InvalidNoise(f"disparity noise {px:g} px: must be >= 0 and finite")
    return px


def _both(noises_px: tuple[object, ...], disparity_noises_px: tuple[object, ...]) -> InvalidRange:
    noise = ", ".join(f"{as_noise(value).std_px:g}" for value in noises_px)
    disparity = ", ".join(f"{_of_disparity_px(value):g}" for value in disparity_noises_px)
    return InvalidRange(
        f"noise {noise} px and disparity noise {disparity} px both given: a disparity's is sqrt(2) times a "
        "coordinate's, give one"
    )
