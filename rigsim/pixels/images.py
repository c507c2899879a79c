"""Pictures as they come, made into one grey channel that can be measured."""

from __future__ import annotations

import numpy as np

from rigsim.errors import InvalidImage
from rigsim.rig.arrays import GREY_WEIGHTS, AnyImage, Array

_SATURATED_SHARE = 0.9


def grey(image: AnyImage, name: str = "image") -> Array:
    """One grey channel (H, W) in the picture's own levels: 0-255, 0-65535, or whatever the floats mean.

    Raises:
        InvalidImage: the shape or type is no picture's, a value is not finite, or every pixel is black,
            equal, or nearly all are at the type's largest value. `name` says which picture.
    """
    pixels = np.asarray(image)
    if (
        pixels.ndim not in (2, 3)
        or 0 in pixels.shape
        or (pixels.ndim == 3 and pixels.shape[2] not in (1, 3, 4))
    ):
        raise InvalidImage(f"{name}: shape {pixels.shape}: must be (height, width) or (height, width, 3)")
    if pixels.dtype not in (np.uint8, np.uint16) and pixels.dtype.kind != "f":
        raise InvalidImage(f"{name}: type {pixels.dtype}: must be 8 or 16 bit unsigned, or floating point")
    if pixels.ndim == 3:
        if pixels.shape[2] == 1:
            levels = pixels[..., 0].astype(np.float64)
        else:
            levels = pixels[..., :3].astype(np.float64) @ np.array(GREY_WEIGHTS)
    else:
        levels = pixels.astype(np.float64)
    if not np.isfinite(levels).all():
        raise InvalidImage(f"{name}: {np.count_nonzero(~np.isfinite(levels))} pixels are not finite numbers")
    low, high = float(levels.min()), float(levels.max())
    if high <= 0:
        raise InvalidImage(f"{name}: all black: expose it longer, or check that the file is the right one")
    if pixels.dtype.kind == "u":
        share = float(np.mean(levels >= np.iinfo(pixels.dtype).max))
        if share > _SATURATED_SHARE:
            raise InvalidImage(f"{name}: {share:.0%} of the pixels are saturated: expose it shorter")
    if high == low:
        raise InvalidImage(f"{name}: every pixel is {low:g}: there is nothing to measure")
    return levels


def quantization_var(image: AnyImage) -> float:
    """Variance that rounding to whole grey levels adds, grey^2: 1/12 for integers, 0 for floats.

    Colour made grey averages three rounding errors, which lowers it by the sum of the squared weights.
    """
    pixels = np.asarray(image)
    if pixels.dtype.kind != "u":
        return 0.0
    averaged = pixels.ndim == 3 and pixels.shape[2] > 1 and not _channels_equal(pixels)
    return sum(weight**2 for weight in GREY_WEIGHTS) / 12 if averaged else 1 / 12


def same_size(left: Array, right: Array) -> None:
    """Check that two pictures are a pair.

    Raises:
        InvalidImage: their sizes differ.
    """
    if left.shape != right.shape:
        sizes = " and ".join(f"{image.shape[1]} x {image.shape[0]}" for image in (left, right))
        raise InvalidImage(f"left and right image are {sizes} px: they must be of one size")


def _channels_equal(pixels: AnyImage) -> bool:
    return bool((pixels[..., 0] == pixels[..., 1]).all() and (pixels[..., 1] == pixels[..., 2]).all())
