"""The noise of a pixel that was typed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rigsim.typed import quantity

if TYPE_CHECKING:
    from rigsim.rig.noise import PixelNoise


def pixel_noise(noise: str | None, disparity_noise: str | None) -> PixelNoise:
    """The noise that ``--noise`` or ``--disparity-noise`` says, as typed; 0.25 px where neither does.

    Raises:
        InvalidRange: both are typed, or one cannot be read.
    """
    from rigsim.rig.noise import PixelNoise, coordinate_noise_px

    px = coordinate_noise_px(
        None if noise is None else quantity.value(noise, quantity.NOISE),
        None if disparity_noise is None else quantity.value(disparity_noise, quantity.DISPARITY_NOISE),
    )
    return PixelNoise(quantity.NOISE_PX if px is None else px)
