"""Single pictures: boards, labels, posters, scales and painted pottery, colours (H, W, 3), 0 to 1.

Parameters as in `surfaces`; only `checker` has neither seed nor size, for it is exact.
"""

from __future__ import annotations

import numpy as np

from rigsim.sim.noise import Plane, cellular, fractal, mix, smoothstep
from rigsim.sim.truth.surfaces import Canvas, Shape, cardboard, cell_grid, grained, rgb


def _lettering(rng: np.random.Generator, shape: Shape, glyph: int) -> Plane:
    """Lines of made-up type (H, W), 1 where ink is; `glyph` texels a dot, 4 x 7 dots a letter."""
    lines, letters = max(shape[0] // (7 * glyph), 1), max(shape[1] // (4 * glyph), 1)
    dots = np.zeros((lines, 7, letters, 4), dtype=np.float32)
    word = (rng.random((lines, 1, letters, 1)) > 0.16) & (
        np.arange(letters)[:, None] < (letters * (0.6 + 0.4 * rng.random((lines, 1, 1, 1))))
    )
    dots[:, 1:6, :, :3] = (rng.random((lines, 5, letters, 3)) > 0.35) & word
    sheet = dots.reshape(lines * 7, letters * 4)
    ink = np.repeat(np.repeat(sheet, glyph, axis=0), glyph, axis=1)[: shape[0], : shape[1]]
    out = np.zeros(shape, dtype=np.float32)
    out[: ink.shape[0], : ink.shape[1]] = ink
    return out


def parcel(on: Canvas, *, base: str = "#b08a5e", tape: str = "#8a6a3c") -> Plane:
    """One face of a carton: tape, a label with a bar code, printed marks."""
    rng, shape = on
    height, width = shape
    color = cardboard(on, base=base)
    seam = slice(int(0.46 * width), int(0.56 * width))
    color[:, seam] = rgb(tape) * grained(rng, shape, 0.08)[:, seam]
    top, left = int((0.12 + 0.1 * rng.random()) * height), int((0.06 + 0.04 * rng.random()) * width)
    h, w = int(0.34 * height), int(0.36 * width)
    label = np.float32(0.86) * np.ones((h, w), dtype=np.float32)
    bars = np.repeat(rng.random(max(w // 3, 1)) > 0.5, 3)[: int(0.8 * w)]
    label[h // 2 : int(0.86 * h), w // 10 : w // 10 + bars.size] -= np.float32(0.75) * bars
    label[h // 12 : h // 2 - 4] -= np.float32(0.7) * _lettering(
        rng, (h // 2 - 4 - h // 12, w), max(h // 48, 1)
    )
    color[top : top + h, left : left + w] = label[..., None]
    ink = _lettering(rng, (int(0.18 * height), int(0.34 * width)), max(height // 128, 1))
    row, col = int(0.72 * height), int(0.61 * width)
    patch = color[row : row + ink.shape[0], col : col + ink.shape[1]]
    patch[:] = mix(patch, rgb("#2b211a"), np.float32(0.8) * ink)
    return color


def poster(
    on: Canvas,
    *,
    base: str = "#e4dfd0",
    ink: str = "#1f3a5f",
    accent: str = "#c2502e",
) -> Plane:
    """A printed sheet: a headline, a picture, and small type."""
    rng, shape = on
    height, width = shape
    color = np.broadcast_to(rgb(base), (height, width, 3)) * grained(rng, shape, 0.03)
    field = fractal(rng, shape, (4, 4), 5, gain=0.55)
    picture = mix(rgb(ink), rgb(accent), smoothstep(-0.6, 0.2, field))
    picture = mix(picture, rgb(base), smoothstep(0.3, 0.9, field)) * grained(rng, shape, 0.12)
    edge_y, edge_x = height // 16, width // 16
    rows, cols = slice(int(0.24 * height), int(0.68 * height)), slice(edge_x, width - edge_x)
    color[rows, cols] = picture[rows, cols]
    for top, bottom, dot in ((0.07, 0.22, height // 50), (0.72, 0.94, height // 200)):
        band = slice(int(top * height), int(bottom * height))
        type_ = _lettering(rng, (band.stop - band.start, width - 2 * edge_x), max(dot, 1))
        color[band, cols] = mix(color[band, cols], rgb(ink), np.float32(0.9) * type_)
    color[: edge_y // 2], color[-edge_y // 2 :] = rgb(ink), rgb(ink)
    return np.asarray(color)


_MEANDER = np.array(
    [
        [int(dot) for dot in line]
        for line in (
            "11111111",
            "00000001",
            "11111101",
            "10000101",
            "10110101",
            "10100101",
            "10111101",
            "10000001",
            "11111111",
        )
    ],
    dtype=np.float32,
)


def amphora(on: Canvas, *, base: str = "#b5683c", figure: str = "#2a1e19") -> Plane:
    """Painted pottery, top row at the lip: bands, a meander, a frieze of mirrored figures, rays, crackle."""
    rng, shape = on
    height, width = shape
    share = np.zeros(shape, dtype=np.float32)
    y, x = cell_grid(shape, 1, 1)
    for top, bottom in ((0.0, 0.05), (0.20, 0.225), (0.30, 0.31), (0.66, 0.675), (0.745, 0.755), (0.93, 1.0)):
        share[(y[:, 0] > top) & (y[:, 0] <= bottom)] = 1
    for top, bottom, count in ((0.235, 0.29, 24), (0.685, 0.735, 24)):
        band = slice(int(top * height), int(bottom * height))
        rows = np.arange(band.stop - band.start) * 9 // (band.stop - band.start)
        cols = np.arange(width) * 8 * count // width % 8
        share[band] = _MEANDER[rows[:, None], cols]
    tongues = slice(int(0.06 * height), int(0.19 * height))
    share[tongues] = np.abs(x * 40 % 1 - 0.5) < 0.42 * (1 - (y[tongues] - 0.06) / 0.13)
    rays = slice(int(0.77 * height), int(0.93 * height))
    share[rays] = np.abs(x * 20 % 1 - 0.5) < 0.5 * (y[rays] - 0.77) / 0.16
    frieze = slice(int(0.32 * height), int(0.65 * height))
    half = width // 12
    ornament = fractal(rng, shape, (16, 32), 4, gain=0.5)[frieze]
    for panel in range(6):
        field = ornament[:, panel * half : (panel + 1) * half]
        column = slice(panel * 2 * half, (panel + 1) * 2 * half)
        share[frieze, column] = smoothstep(-0.05, 0.05, np.concatenate([field, field[:, ::-1]], axis=1))
    first, second, _ = cellular(rng, (height // 2, width // 2), (24, 48))  # half as fine will do
    crackle = np.float32(0.3) * (1 - smoothstep(0.01, 0.035, second - first))
    crackle = np.repeat(np.repeat(crackle, 2, axis=0), 2, axis=1)
    color = mix(rgb(base), rgb(figure), share * np.float32(0.88))
    flaked = smoothstep(1.15, 1.5, fractal(rng, shape, (8, 8), 6, gain=0.75))
    color = mix(color, rgb("#c89468"), np.float32(0.8) * flaked)
    return np.asarray(color * (1 - crackle)[..., None] * grained(rng, shape, 0.15))


def dial(on: Canvas, *, base: str = "#4a4d50", mark: str = "#e8e4d8", ticks: int = 72) -> Plane:
    """A turntable from above: rings and degree marks in the inscribed circle."""
    rng, shape = on
    y, x = cell_grid(shape, 2, 2)
    y, x = y - 1, x - 1
    radius, turn = np.sqrt(x * x + y * y), np.arctan2(y, x).astype(np.float32) / np.float32(2 * np.pi)
    beat = np.abs((turn * ticks) % 1 - np.float32(0.5))
    major = np.abs((turn * (ticks // 6)) % 1 - np.float32(0.5)) > 0.5 - 0.08 * (ticks // 6) / ticks
    lines = (beat > 0.5 - 0.08) & (radius > np.where(major, 0.78, 0.86)) & (radius < 0.95)
    lines |= np.abs(radius - 0.965) < 0.006
    rings = np.float32(0.05) * ((radius * 24) % 1 - np.float32(0.5))
    color = rgb(base) * (1 + rings[..., None]) * grained(rng, shape, 0.16)
    return mix(color, rgb(mark), lines.astype(np.float32))


def ruler(on: Canvas, *, base: str = "#ddd6bd", mark: str = "#161616", ticks: int = 30) -> Plane:
    """A scale along x: bars of one unit, black and white, above a line of ticks."""
    rng, shape = on
    y, x = cell_grid(shape, 1, ticks)
    unit = x.astype(np.intp)
    bars = (y < 0.45) & (unit % 2 == 0)
    long = np.where(unit % 5 == 0, 0.5, 0.72)
    lines = (y > long) & (x % 1 < 0.12)
    numbers = np.zeros(shape, dtype=bool)
    band = slice(int(0.5 * shape[0]), int(0.68 * shape[0]))
    numbers[band] = _lettering(rng, (band.stop - band.start, shape[1]), max(shape[0] // 48, 1)) > 0
    ink = bars | lines | (numbers & (unit % 5 == 1))
    return mix(rgb(base), rgb(mark), ink.astype(np.float32)) * grained(rng, shape, 0.05)


def checker(
    *,
    rows: int = 6,
    cols: int = 9,
    square: int = 32,
    margin: int = 16,
    dark: str = "#141414",
    light: str = "#ebebeb",
) -> Plane:
    """A calibration board with `rows` x `cols` inner corners, exactly centred.

    Squares of `square` texels and a light margin of `margin` texels round them, so that every edge
    lies on a border between texels. Pattern x runs with columns, the first row is at the top.
    """
    parity = (np.arange(rows + 1)[:, None] + np.arange(cols + 1)) % 2 == 0
    squares = np.repeat(np.repeat(parity, square, axis=0), square, axis=1)
    return mix(rgb(light), rgb(dark), np.pad(squares, margin).astype(np.float32))
