"""Portable float maps: the format of Middlebury's disparities, and of matchers run as commands.

A header of three lines, ``Pf`` or ``PF``, ``width height``, ``scale``, then 32 bit floats, the bottom
row first; a negative scale means little endian (Debevec, "PFM portable FloatMap image format").
"""

from __future__ import annotations

import re

import numpy as np

from rigsim.errors import InvalidImage
from rigsim.rig.arrays import Array

_HEADER = re.compile(rb"(P[fF])\s+(\d{1,9})\s+(\d{1,9})\s+([-+]?[0-9.]+(?:[eE][-+]?\d+)?)\s")


def parse_pfm(content: bytes, name: str = "PFM") -> Array:
    """Values (H, W), or (H, W, 3) for colour, the top row first; infinite ones, the format's unknown, as NaN.

    The scale's size is a unit nobody writes down, so only its sign is used.

    Raises:
        InvalidImage: `content` is no PFM, or too short; `name` says which.
    """
    header = _HEADER.match(content)
    if header is None:
        raise InvalidImage(f"{name}: no PFM: must begin with Pf or PF, the width, the height and the scale")
    kind, width, height, scale = header[1], int(header[2]), int(header[3]), float(header[4])
    if scale == 0 or 0 in (width, height):
        raise InvalidImage(f"{name}: PFM of {width} x {height} px and scale {scale:g}: none may be 0")
    shape = (height, width, 3) if kind == b"PF" else (height, width)
    needed = 4 * int(np.prod(shape))
    held = len(content) - header.end()
    if held < needed:
        raise InvalidImage(f"{name}: PFM of {width} x {height} px needs {needed} bytes, and has {held}")
    order = "<f4" if scale < 0 else ">f4"
    rows = np.frombuffer(content, dtype=order, count=needed // 4, offset=header.end()).reshape(shape)
    values = rows[::-1].astype(np.float64)
    values[np.isinf(values)] = np.nan
    return values


def pfm_bytes(values: Array) -> bytes:
    """A little-endian PFM of `values` (H, W), top row first; NaN becomes infinite, the format's unknown."""
    rows = np.where(np.isnan(values), np.inf, values)[::-1].astype("<f4")
    height, width = rows.shape
    return b"Pf\n%d %d\n-1.0\n" % (width, height) + rows.tobytes()
