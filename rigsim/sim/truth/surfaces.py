"""Surfaces that textures are made of, colours (H, W, 3) between 0 and 1; all of them tile.

Each takes a canvas, then parameters by keyword; those whose default is `#rrggbb` are
colours.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rigsim.sim.noise import Plane, cellular, fractal, mix, smoothstep, value_noise, warp

Shape = tuple[int, int]


class Canvas(NamedTuple):
    """What a texture is painted with and on."""

    rng: np.random.Generator
    """Its random numbers."""
    shape: Shape
    """Rows and columns, texels."""


def rgb(color: str) -> Plane:
    """The three channels of `#rrggbb`, 0..1."""
    return np.array([int(color[i : i + 2], 16) for i in (1, 3, 5)], dtype=np.float32) / np.float32(255)


def grained(rng: np.random.Generator, shape: Shape, strength: float) -> Plane:
    """What every real surface has: tone that varies at all scales down to a texel, about 1, (H, W, 1)."""
    fine = fractal(rng, shape, (shape[0] // 8, shape[1] // 8), 4, gain=0.9)
    coarse = fractal(rng, shape, (4, 4), 4, gain=0.7)
    return (1 + np.float32(strength) * (np.float32(0.7) * fine + np.float32(0.5) * coarse))[..., None]


def cell_grid(shape: Shape, rows: int, cols: int) -> tuple[Plane, Plane]:
    """Row (H, 1) and column (1, W) coordinates that count `rows` and `cols` cells."""
    y = (np.arange(shape[0], dtype=np.float32)[:, None] + np.float32(0.5)) * np.float32(rows / shape[0])
    x = (np.arange(shape[1], dtype=np.float32)[None, :] + np.float32(0.5)) * np.float32(cols / shape[1])
    return y, x


def plaster(on: Canvas, *, base: str = "#b9b2a4", contrast: float = 0.09) -> Plane:
    """Roughcast, paint or stone: blotches, grain and darker pits."""
    rng, shape = on
    stains = fractal(rng, shape, (2, 2), 5)
    pits = smoothstep(1.1, 1.9, fractal(rng, shape, (shape[0] // 16, shape[1] // 16), 3, gain=0.8))
    tone = (1 - np.float32(3.0 * contrast) * pits + np.float32(0.5 * contrast) * stains)[..., None]
    return np.asarray(rgb(base) * tone * grained(rng, shape, contrast))


def terrazzo(
    on: Canvas,
    *,
    base: str = "#a8a39a",
    chip: str = "#6b5a4c",
    cells: int = 48,
    contrast: float = 0.35,
    grain: float = 0.08,
) -> Plane:
    """Chips of stone of many tones in a matrix."""
    rng, shape = on
    first, second, owner = cellular(rng, shape, (cells, cells))
    tone = rng.random((cells * cells,), dtype=np.float32)[owner]
    inside = smoothstep(0.08, 0.2, second - first) * smoothstep(0.25, 0.4, tone)
    light = (1 + np.float32(contrast) * (tone - np.float32(0.5)))[..., None]
    color = mix(rgb(base), rgb(chip), inside * smoothstep(0.6, 0.7, tone)) * light
    return np.asarray(color * grained(rng, shape, grain))


def bricks(
    on: Canvas,
    *,
    base: str = "#9a5a44",
    mortar: str = "#b5aa9a",
    rows: int = 16,
    cols: int = 8,
    contrast: float = 0.3,
) -> Plane:
    """Running bond; every brick has its own tone."""
    rng, shape = on
    y, x = cell_grid(shape, rows, cols)
    row = y.astype(np.intp)
    x = x + np.float32(0.5) * (row % 2)
    col = x.astype(np.intp) % cols
    tone = rng.random((rows, cols), dtype=np.float32)[row, col]
    fy, fx = np.abs(y - row - np.float32(0.5)), np.abs(x % 1 - np.float32(0.5))
    rough = np.float32(0.03) * fractal(rng, shape, (32, 32), 4)
    edge = np.minimum((np.float32(0.5) - fy), (np.float32(0.5) - fx) * np.float32(rows / cols)) + rough
    wall = rgb(base) * (1 + np.float32(contrast) * (tone - np.float32(0.5)) * 2)[..., None]
    return np.asarray(mix(rgb(mortar), wall, smoothstep(0.05, 0.1, edge)) * grained(rng, shape, 0.13))


def tiles(
    on: Canvas,
    *,
    base: str = "#a9a79f",
    grout: str = "#5d5a55",
    rows: int = 4,
    cols: int = 4,
    contrast: float = 0.12,
    joint: float = 0.012,
) -> Plane:
    """Square slabs of speckled stone with dark joints."""
    rng, shape = on
    y, x = cell_grid(shape, rows, cols)
    tone = rng.random((rows, cols), dtype=np.float32)[y.astype(np.intp), x.astype(np.intp)]
    edge = np.minimum(0.5 - np.abs(y % 1 - 0.5), 0.5 - np.abs(x % 1 - 0.5))
    stone = terrazzo(on, base=base, chip=base, cells=64, contrast=0.5, grain=0.1)
    stone = stone * (1 + np.float32(contrast) * (tone - np.float32(0.5)) * 2)[..., None]
    return mix(rgb(grout) * grained(rng, shape, 0.1), stone, smoothstep(joint, 1.8 * joint, edge))


def wood(
    on: Canvas,
    *,
    base: str = "#b98a55",
    dark: str = "#6b4423",
    planks: int = 1,
    contrast: float = 1.0,
) -> Plane:
    """Boards along x with growth rings, fibres and seams."""
    rng, shape = on
    height, width = shape
    y, _ = cell_grid(shape, planks, 1)
    plank = y.astype(np.intp)[:, 0]
    bend = fractal(rng, shape, (4, 2), 4)
    shift = rng.integers(0, width, planks)[plank][:, None]
    bend = bend[np.arange(height)[:, None], (np.arange(width) + shift) % width]
    phase = (np.arange(height, dtype=np.float32)[:, None] * np.float32(16 / height) + bend) % 1
    rings = np.float32(4) * phase * (1 - phase)  # a parabola does for a sine, and is exact
    fibres = fractal(rng, shape, (height // 4, max(width // 64, 1)), 3, gain=0.8)
    share = np.float32(0.3) * rings + np.float32(0.13) * fibres + np.float32(0.1)
    color = mix(rgb(base), rgb(dark), np.clip(np.float32(contrast) * share, 0, 1))
    tone = 1 + np.float32(0.2) * (rng.random(planks, dtype=np.float32) - np.float32(0.5))[plank]
    if planks > 1:
        tone *= smoothstep(0.0, 0.025, np.float32(0.5) - np.abs(y[:, 0] % 1 - np.float32(0.5)))
    return np.asarray(color * tone[:, None, None] * grained(rng, shape, 0.06))


def bark(on: Canvas, *, base: str = "#7a6653", dark: str = "#2e241c", ridges: int = 16) -> Plane:
    """Ridges along x with dark furrows, scales and patches of lichen."""
    rng, shape = on
    relief = fractal(rng, shape, (ridges, max(ridges // 4, 1)), 5, gain=0.65)
    sway = np.float32(shape[0] / 40) * fractal(rng, shape, (8, 8), 3)
    furrow = warp(np.abs(relief), sway, sway)
    color = mix(rgb(dark), rgb(base), smoothstep(0.02, 0.75, furrow))
    lichen = smoothstep(0.9, 1.3, fractal(rng, shape, (8, 8), 5, gain=0.75))
    color = mix(color, rgb("#a3a68b"), np.float32(0.75) * lichen)
    return np.asarray(color * grained(rng, shape, 0.16))


def leaves(
    on: Canvas,
    *,
    base: str = "#4d7034",
    dark: str = "#141f10",
    count: int = 1200,
    length: float = 0.06,
    slender: float = 0.45,
) -> Plane:
    """Leaves (or blades, when `slender` is small) strewn over darkness, the later over the earlier.

    `length` is that of the longest as a share of the texture's width.
    """
    rng, shape = on
    height, width = shape
    color = rgb(dark) * grained(rng, shape, 0.3)
    reach = max(int(length * width / 2), 2)
    axis = np.arange(-reach, reach + 1, dtype=np.float32)
    sprites = []
    for _ in range(24):
        angle = rng.random() * 2 * np.pi
        c, s = np.float32(np.cos(angle)), np.float32(np.sin(angle))
        scale = np.float32(reach * (0.55 + 0.45 * rng.random()))
        along = (c * axis + s * axis[:, None]) / scale
        across = (c * axis[:, None] - s * axis) / (scale * np.float32(slender))
        mask = np.abs(across) < 1 - along**2
        rib = np.float32(0.35) * (np.abs(across) < np.float32(1.5) / (scale * np.float32(slender)))
        sprites.append((mask[..., None], (np.float32(0.75) + np.float32(0.2) * across + rib)[..., None]))
    rows, cols = rng.integers(0, height, count), rng.integers(0, width, count)
    kinds = rng.integers(0, len(sprites), count)
    depth = np.linspace(0.35, 1.0, count, dtype=np.float32)
    tints = 1 + np.float32(0.25) * (rng.random((count, 3), dtype=np.float32) - np.float32(0.5))
    tones = (
        rgb(base)
        * tints
        * (depth * (np.float32(0.8) + np.float32(0.5) * rng.random(count, np.float32)))[:, None]
    )
    # leaves that cross an edge are drawn again beyond the opposite one; the middle is then cut out
    canvas = np.pad(color, ((2 * reach, 2 * reach + 1), (2 * reach, 2 * reach + 1), (0, 0)), mode="wrap")
    for i in range(count):
        mask, shade = sprites[kinds[i]]
        color_of_leaf = tones[i] * shade
        for top in _copies(int(rows[i]), height, reach):
            for left in _copies(int(cols[i]), width, reach):
                window = canvas[top : top + 2 * reach + 1, left : left + 2 * reach + 1]
                np.copyto(window, color_of_leaf, where=mask)
    color = canvas[2 * reach : 2 * reach + height, 2 * reach : 2 * reach + width]
    return np.asarray(color * grained(rng, shape, 0.1))


def _copies(at: int, size: int, reach: int) -> list[int]:
    """Where patches begin that show a leaf centred `at` inside the canvas, or across its edges."""
    begins = [at + reach]
    if at < reach:
        begins.append(at + size + reach)
    if at >= size - reach:
        begins.append(at - size + reach)
    return begins


def metal(
    on: Canvas,
    *,
    base: str = "#8f9499",
    brushed: float = 0.12,
    spots: float = 0.25,
    rust: str = "#5a3a26",
) -> Plane:
    """Brushed along x, scratched, with stains."""
    rng, shape = on
    lines = fractal(rng, shape, (shape[0] // 2, 4), 3, gain=0.8)
    scratches = smoothstep(1.9, 2.3, fractal(rng, shape, (shape[0] // 4, 8), 2))
    stains = smoothstep(0.7, 1.6, fractal(rng, shape, (8, 8), 6, gain=0.75))
    light = (1 + np.float32(brushed) * lines + np.float32(0.35) * scratches)[..., None]
    color = mix(rgb(base) * light, rgb(rust), np.float32(min(spots, 1.0)) * stains)
    return np.asarray(color * grained(rng, shape, 0.1))


def paint(
    on: Canvas,
    *,
    base: str = "#c8a02a",
    under: str = "#5b5148",
    wear: float = 0.5,
    grain: float = 0.1,
) -> Plane:
    """Worn paint: chips that show what is under it, dust and grain."""
    rng, shape = on
    chips = smoothstep(2.5 - wear, 2.6 - wear, fractal(rng, shape, (8, 8), 6, gain=0.7))
    return np.asarray(mix(rgb(base), rgb(under), chips) * grained(rng, shape, grain))


def carbon(on: Canvas, *, base: str = "#34373b", cells: int = 32) -> Plane:
    """Twill weave of carbon fibre."""
    rng, shape = on
    y, x = cell_grid(shape, cells, cells)
    iy, ix = y.astype(np.intp), x.astype(np.intp)
    warp_up = (iy + ix) % 4 < 2
    sheen = np.where(warp_up, 4 * (x % 1) * (1 - x % 1), 4 * (y % 1) * (1 - y % 1))
    tone = np.where(warp_up, np.float32(1.25), np.float32(0.75)) * (np.float32(0.6) + np.float32(0.6) * sheen)
    return np.asarray(rgb(base) * tone[..., None].astype(np.float32) * grained(rng, shape, 0.12))


def cardboard(on: Canvas, *, base: str = "#b08a5e") -> Plane:
    """Fibres and the faint lines of the flutes."""
    rng, shape = on
    y, _ = cell_grid(shape, 64, 1)
    flutes = np.float32(0.05) * (np.abs(y % 1 - np.float32(0.5)) - np.float32(0.25))
    fibres = np.float32(0.05) * fractal(rng, shape, (shape[0] // 8, shape[1] // 16), 3, gain=0.8)
    return np.asarray(rgb(base) * (1 + flutes + fibres)[..., None] * grained(rng, shape, 0.08))


def cork(on: Canvas, *, base: str = "#b08455", dark: str = "#5f3f22") -> Plane:
    """Granules of cork."""
    rng, shape = on
    _, _, owner = cellular(rng, shape, (64, 64))
    tone = rng.random(64 * 64, dtype=np.float32)[owner]
    return np.asarray(mix(rgb(base), rgb(dark), smoothstep(0.55, 1.0, tone)) * grained(rng, shape, 0.14))


def clouds(on: Canvas, *, base: str = "#8fb0d0", white: str = "#e8ecef") -> Plane:
    """A clouded sky."""
    rng, shape = on
    cover = smoothstep(-0.8, 1.2, fractal(rng, shape, (2, 2), 7, gain=0.6))
    return mix(rgb(base), rgb(white), cover)


def speckle(on: Canvas, *, base: str = "#808080", contrast: float = 0.35) -> Plane:
    """Plain noise, equally strong at every scale: what a matcher likes best."""
    rng, shape = on
    noise = fractal(rng, shape, (4, 4), 12, gain=0.95) + value_noise(rng, shape, shape)
    return np.asarray(rgb(base) * (1 + np.float32(contrast) * noise)[..., None])
