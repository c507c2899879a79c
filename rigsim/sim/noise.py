"""Seeded noise that tiles: the raw material of every texture.

Only additions, multiplications and square roots stand between the random numbers and the result, so
equal seeds give equal bits.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Plane: TypeAlias = npt.NDArray[np.float32]
"""(H, W), or (H, W, 3) for colours, each between 0 and 1."""

_OCTAVE_STD = np.float32(0.20)  # of one octave of centred value noise
_CELL_SPREAD = 0.8  # how far a cell's seed strays inside its cell


def value_noise(rng: np.random.Generator, shape: tuple[int, int], cells: tuple[int, int]) -> Plane:
    """One octave (H, W) between -0.5 and 0.5, smooth inside each of `cells` = (rows, columns).

    The cells must divide the shape.
    """
    grid = rng.random(cells, dtype=np.float32) - np.float32(0.5)
    # columns first, while there are few rows to transpose
    wide = np.ascontiguousarray(_stretch(np.ascontiguousarray(grid.T), shape[1] // cells[1]).T)
    return _stretch(wide, shape[0] // cells[0])


def _stretch(grid: Plane, step: int) -> Plane:
    """Interpolate `step` samples from each row to the next, and from the last to the first."""
    if step == 1:
        return grid
    t = np.arange(step, dtype=np.float32) / np.float32(step)
    weight = (t * t * (3 - 2 * t))[None, :, None]
    onward = np.roll(grid, -1, axis=0) - grid
    return np.asarray((grid[:, None] + onward[:, None] * weight).reshape(-1, grid.shape[1]))


def fractal(
    rng: np.random.Generator,
    shape: tuple[int, int],
    cells: tuple[int, int],
    octaves: int,
    gain: float = 0.6,
) -> Plane:
    """Octaves of value noise (H, W), each twice as fine and `gain` times as strong; mean 0, std near 1.

    Octaves finer than a texel are left out.
    """
    total = np.zeros(shape, dtype=np.float32)
    power, amplitude = 0.0, 1.0
    for _ in range(octaves):
        if shape[0] % cells[0] or shape[1] % cells[1]:
            break
        total += np.float32(amplitude) * value_noise(rng, shape, cells)
        power += amplitude**2
        amplitude *= gain
        cells = (cells[0] * 2, cells[1] * 2)
    return np.asarray(total / (_OCTAVE_STD * np.sqrt(np.float32(max(power, 1e-9)))))


def cellular(
    rng: np.random.Generator, shape: tuple[int, int], cells: tuple[int, int]
) -> tuple[Plane, Plane, npt.NDArray[np.intp]]:
    """Voronoi cells around jittered seeds: distance to the nearest and to the second nearest seed, in
    cells, and the index (H, W) of the nearest."""
    rows, cols = cells
    seed_y = (rng.random(cells, dtype=np.float32) - np.float32(0.5)) * np.float32(_CELL_SPREAD)
    seed_x = (rng.random(cells, dtype=np.float32) - np.float32(0.5)) * np.float32(_CELL_SPREAD)
    y = (np.arange(shape[0], dtype=np.float32) + np.float32(0.5)) * np.float32(rows / shape[0])
    x = (np.arange(shape[1], dtype=np.float32) + np.float32(0.5)) * np.float32(cols / shape[1])
    iy, ix = y.astype(np.intp), x.astype(np.intp)
    y, x = y - iy - np.float32(0.5), x - ix - np.float32(0.5)
    first = np.full(shape, 9.0, dtype=np.float32)
    second = first.copy()
    owner = np.zeros(shape, dtype=np.intp)
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            row, col = (iy + dy) % rows, (ix + dx) % cols
            across = np.take(seed_x[row], col, axis=1) + (np.float32(dx) - x)
            down = np.take(seed_y[row], col, axis=1) + (np.float32(dy) - y)[:, None]
            away = across * across + down * down
            np.minimum(second, np.maximum(first, away), out=second)
            np.copyto(owner, row[:, None] * cols + col, where=away < first)
            np.minimum(first, away, out=first)
    return np.sqrt(first), np.sqrt(second), owner


def warp(image: Plane, dy: Plane, dx: Plane) -> Plane:
    """Read each texel `dy` rows down and `dx` columns right of itself (nearest texel, wrapping round)."""
    height, width = image.shape[:2]
    rows = (np.arange(height)[:, None] + np.rint(dy).astype(np.intp)) % height
    cols = (np.arange(width) + np.rint(dx).astype(np.intp)) % width
    return np.asarray(image[rows, cols])


def smoothstep(low: float, high: float, values: Plane) -> Plane:
    """0 below `low`, 1 above `high`, smooth between."""
    t = np.clip((values - np.float32(low)) / np.float32(high - low), 0, 1)
    return np.asarray(t * t * (3 - 2 * t), dtype=np.float32)


def mix(a: npt.ArrayLike, b: npt.ArrayLike, share: Plane) -> Plane:
    """Blend colours or pictures a and b (..., 3) by `share` (H, W): 0 is a, 1 is b."""
    start, end = np.asarray(a, dtype=np.float32), np.asarray(b, dtype=np.float32)
    return np.asarray(start + (end - start) * share[..., None])
