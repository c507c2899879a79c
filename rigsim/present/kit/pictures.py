"""Images to look at: anaglyphs, disparity and depth in colour, and their encoding."""

from __future__ import annotations

import io
from typing import Literal

import numpy as np
import numpy.typing as npt
from PIL import Image as PillowImage

from rigsim.errors import OutputError
from rigsim.rig.arrays import Array, Image
from rigsim.statistics import inner_range

_LUMA = np.array([0.299, 0.587, 0.114])  # ITU-R BT.601
_INVALID = 60


def anaglyph(left: Image, right: Image) -> Image:
    """Red-cyan anaglyph (H, W, 3) of two images (H, W, 3): left in red, right in green and blue.

    Raises:
        OutputError: the images differ in size.
    """
    if left.shape != right.shape:
        raise OutputError(
            f"anaglyph: left image {left.shape[1]}x{left.shape[0]} and right image "
            f"{right.shape[1]}x{right.shape[0]} px: must be the same size"
        )
    picture = np.empty_like(left)
    picture[..., 0] = np.rint(left @ _LUMA)
    picture[..., 1:] = np.rint(right @ _LUMA)[..., None]
    return picture


def disparity_picture(disparity_px: npt.ArrayLike, limits_px: tuple[float, float] | None = None) -> Image:
    """Disparity (H, W) px as colours (H, W, 3), near is bright; NaN and infinite are dark grey.

    `limits_px` are the disparities at both ends of the colour map; by default the 1st and
    99th percentile.
    """
    return _colored(np.asarray(disparity_px, dtype=np.float64), limits_px)


def depth_picture(depth_m: npt.ArrayLike, limits_m: tuple[float, float] | None = None) -> Image:
    """Depth (H, W) m as colours (H, W, 3), near is bright and even steps are even in 1/Z, as in the images;
    NaN, infinite and non-positive are dark grey."""
    depth = np.asarray(depth_m, dtype=np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = np.where(depth > 0, 1 / depth, np.nan)
    return _colored(inverse, None if limits_m is None else (1 / limits_m[1], 1 / limits_m[0]))


def error_picture(error: npt.ArrayLike, limits: tuple[float, float] | None = None) -> Image:
    """Expected error (H, W), in whatever unit `limits` is, as colours (H, W, 3), large is bright; NaN and
    infinite are dark grey. `limits` as of `disparity_picture`."""
    return _colored(np.asarray(error, dtype=np.float64), limits)


def with_scale(picture: Image, limits: tuple[float, float], label: str) -> Image:
    """The picture (H, W, 3) above a colour bar that says what its colours mean."""
    from rigsim.present.kit.scale import scale_strip

    return np.concatenate([picture, scale_strip(picture.shape[1], limits, label)])


def picture_limits(values: npt.ArrayLike) -> tuple[float, float]:
    """Ends of the colour map by default: the 1st and 99th percentile of the finite values."""
    array = np.asarray(values, dtype=np.float64)
    array = array[np.isfinite(array)]
    if not array.size:
        return 0.0, 1.0
    low, high = inner_range(array)
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def encode(image: Image, kind: Literal["png", "jpeg"] = "png", *, width: int | None = None) -> bytes:
    """Encode an image (H, W, 3) or (H, W), shrunk to `width` px when it is wider."""
    picture = PillowImage.fromarray(np.ascontiguousarray(image))
    if width is not None and picture.width > width:
        height = max(1, round(picture.height * width / picture.width))
        picture = picture.resize((width, height), PillowImage.Resampling.LANCZOS)
    buffer = io.BytesIO()
    if kind == "png":
        picture.save(buffer, "PNG", compress_level=4)
    else:
        picture.save(buffer, "JPEG", quality=85, optimize=True)
    return buffer.getvalue()


def _colored(values: Array, limits: tuple[float, float] | None) -> Image:
    import matplotlib

    low, high = picture_limits(values) if limits is None else limits
    known = np.isfinite(values)
    share = np.clip((np.where(known, values, low) - low) / (high - low), 0, 1)
    table = np.rint(matplotlib.colormaps["viridis"](np.linspace(0, 1, 256))[:, :3] * 255).astype(np.uint8)
    picture = table[np.rint(share * 255).astype(np.intp)]
    picture[~known] = _INVALID
    return np.asarray(picture)
