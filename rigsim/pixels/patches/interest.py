"""Where a disparity can be measured: pixels with grey gradient along the row, spread over the image."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from rigsim.pixels.patches.spline import Indices
from rigsim.rig.arrays import Array, Mask

_WORST_STD_PX = 0.25
_BLOCK = 32


def estimate_noise(image: Array) -> float:
    """Standard deviation of an image's noise, grey, from the second differences of its calmest parts.

    Immerkaer's mask ("Fast noise variance estimation", CVIU 1996), averaged over blocks; the block that a
    tenth of the others fall below stands for the image. Where fine texture is everywhere it
    counts as noise: a starting value, rarely below what it is.
    """
    second = np.array([1.0, -2.0, 1.0])
    filtered = ndimage.correlate1d(ndimage.correlate1d(image, second, axis=0), second, axis=1)[1:-1, 1:-1]
    side = max(1, min(_BLOCK, *filtered.shape))
    rows, columns = (size // side for size in filtered.shape)
    blocks = np.abs(filtered[: rows * side, : columns * side]).reshape(rows, side, columns, side)
    return float(np.quantile(blocks.mean(axis=(1, 3)), 0.1) * np.sqrt(np.pi / 2) / 6)


def interest_points(
    gradient: Array, usable: Mask, n_points: int, *, radius: int, noise_var: float
) -> Indices:
    """At most `n_points` whole pixels (N, 2) whose windows hold the most gradient along the row.

    Only this gradient helps a match along the row, so its windowed energy takes the place of
    Shi and Tomasi's smaller eigenvalue. Local maxima alone are kept, and where they crowd, the best of
    each cell of a grid come first, so that the points cover the image.

    Args:
        gradient: derivative along the row, (H, W), grey/px.
        usable: pixels whose windows may be measured, (H, W).
        n_points: how many points are wanted.
        radius: of the square window, px.
        noise_var: variance of `gradient` that noise explains, grey^2/px^2; pixels whose disparity it would
            leave more than 0.25 px uncertain are no candidates.
    """
    height, width = gradient.shape
    side = 2 * radius + 1
    energy = ndimage.uniform_filter(gradient**2, side) * side**2 - noise_var * side**2
    least = max(2 * noise_var / _WORST_STD_PX**2, 1e-6 * float(energy.max(initial=0.0)))
    spacing = max(3, int(min(radius, 0.5 * np.sqrt(height * width / max(n_points, 1)))))
    peaks = (energy == ndimage.maximum_filter(energy, spacing)) & (energy > least)
    v, u = np.nonzero(peaks & usable)
    order = np.argsort(-energy[v, u], kind="stable")
    v, u = v[order], u[order]

    cell_side = max(side, np.sqrt(height * width / max(n_points, 1)))
    cell = (v // cell_side).astype(np.int64) * width + (u // cell_side).astype(np.int64)
    chosen = np.argsort(_rank_within(cell), kind="stable")[:n_points]
    return np.stack([u[chosen], v[chosen]], axis=1).astype(np.intp)


def _rank_within(group: np.ndarray[tuple[int], np.dtype[np.int64]]) -> Indices:
    """How many earlier elements are of the same group, (N,)."""
    order = np.argsort(group, kind="stable")
    sorted_group = group[order]
    new = np.concatenate([[True], sorted_group[1:] != sorted_group[:-1]]) if len(group) else np.zeros(0, bool)
    start = np.maximum.accumulate(np.where(new, np.arange(len(group)), 0))
    rank = np.empty(len(group), dtype=np.intp)
    rank[order] = np.arange(len(group)) - start
    return rank
