"""Matches to a whole pixel: normalised cross-correlation along the row."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from rigsim.pixels.patches.spline import Indices
from rigsim.rig.arrays import Array, Mask

_BLUR_PX = 1.0
_STRIDE = 2  # every second pixel of a window: the blurred image has no finer detail
_CHUNK_ELEMENTS = 60_000


@dataclass(frozen=True, slots=True, eq=False)
class Correlations:
    """The best and the second best place of each of N windows along its row."""

    disparity: Array
    """``u - u_other`` of the best place, (N,), whole px; NaN where the range holds no place."""
    score: Array
    """Its correlation, -1 to 1, (N,); NaN as above."""
    second_score: Array
    """Correlation of the best other peak, (N,); -1 where there is none."""


@dataclass(frozen=True, slots=True, eq=False)
class Blurred:
    """An image made ready for correlation with windows of one radius."""

    pixels: npt.NDArray[np.float32]
    """Blurred grey less its mean, (H, W)."""
    deviation: npt.NDArray[np.float32]
    """Root of the sum of squared deviations in the window about each pixel, (H, W); inf where it is flat
    or not wholly on the image."""
    offsets: Indices
    """Offsets of a window's columns and rows, px."""

    @classmethod
    def of(cls, image: Array, usable: Mask, radius: int) -> Blurred:
        """Blur `image` (H, W) and sum over windows of `radius` px, those wholly on `usable` (H, W) pixels."""
        offsets = np.arange(-(radius // _STRIDE) * _STRIDE, radius + 1, _STRIDE)
        pixels = ndimage.gaussian_filter(image - image.mean(), _BLUR_PX, mode="nearest")
        stencil = np.zeros(2 * radius + 1)
        stencil[offsets + radius] = 1

        def total(values: Array) -> Array:
            return ndimage.correlate1d(ndimage.correlate1d(values, stencil, axis=0), stencil, axis=1)

        squares = total(pixels**2)
        deviation = squares - total(pixels) ** 2 / len(offsets) ** 2
        flat = deviation <= 1e-9 * squares + 1e-12
        root = np.where(flat, np.inf, np.sqrt(np.where(flat, 1, deviation)))
        whole = whole_windows(usable, radius)
        return cls(pixels.astype(np.float32), np.where(whole, root, np.inf).astype(np.float32), offsets)


def whole_windows(usable: Mask, radius: int) -> Mask:
    """Whether the square window about each pixel lies wholly on usable ones, (H, W)."""
    return np.asarray(ndimage.minimum_filter(usable, 2 * radius + 1, mode="constant", cval=False))


def correlate(image: Blurred, other: Blurred, uv: Indices, low: int, high: int) -> Correlations:
    """Find the windows about whole pixels `uv` (N, 2) of `image` in `other`, disparities `low` to `high`."""
    count = high - low + 1
    step = max(1, _CHUNK_ELEMENTS // (count + 2 * int(image.offsets[-1])))
    parts = [_correlate(image, other, uv[i : i + step], low, high) for i in range(0, max(len(uv), 1), step)]
    return Correlations(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _correlate(
    image: Blurred, other: Blurred, uv: Indices, low: int, high: int
) -> tuple[Array, Array, Array]:
    offsets, width, n = image.offsets, other.pixels.shape[1], len(uv)
    reach, count = int(offsets[-1]), high - low + 1
    u, v = uv[:, 0], uv[:, 1]
    template = image.pixels[v[:, None, None] + offsets[:, None], u[:, None, None] + offsets]
    template = template - template.mean(axis=(1, 2), keepdims=True)

    # columns run with u_other, so the last one belongs to the lowest disparity
    first = u - high
    columns = first[:, None] + np.arange(-reach, count + reach)
    strips = other.pixels[v[:, None, None] + offsets[:, None], np.clip(columns, 0, width - 1)[:, None]]
    product = np.zeros((n, count), dtype=np.float32)
    for j in range(len(offsets)):
        for k, offset in enumerate(offsets):
            at = reach + int(offset)
            product += template[:, j, k, None] * strips[:, j, at : at + count]

    places = columns[:, reach : reach + count]
    inside = (places >= 0) & (places < width)
    scale = np.where(inside, other.deviation[v[:, None], np.clip(places, 0, width - 1)], np.inf)
    possible = np.isfinite(scale)
    score = np.where(possible, product / (scale * image.deviation[v, u][:, None]), -1.0)

    row = np.arange(n)
    best = score.argmax(axis=1)
    padded = np.pad(score, ((0, 0), (1, 1)), constant_values=-2)
    peak = (padded[:, 1:-1] >= padded[:, :-2]) & (padded[:, 1:-1] > padded[:, 2:])
    peak[np.abs(np.arange(count) - best[:, None]) <= 1] = False
    second = np.where(peak, score, -1.0).max(axis=1)
    found = possible[row, best]
    return (
        np.where(found, high - best, np.nan).astype(np.float64),
        np.where(found, score[row, best], np.nan).astype(np.float64),
        second.astype(np.float64),
    )
