"""Strokes that SVG pictures of the page share."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

from rigsim.rig.arrays import Array


def polygon(corners: Sequence[tuple[float, float]], style: str) -> str:
    """A filled shape; nothing for fewer than three corners."""
    if len(corners) < 3:
        return ""
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in corners)
    return f'<polygon points="{path}" style="{style}"/>'


def line(start: tuple[float, float], end: tuple[float, float], style: str) -> str:
    """A straight line."""
    return (
        f'<line x1="{start[0]:.1f}" y1="{start[1]:.1f}" x2="{end[0]:.1f}" y2="{end[1]:.1f}" style="{style}"/>'
    )


def text(at: tuple[float, float], words: str, style: str, anchor: str = "middle") -> str:
    """Words at a place."""
    return (
        f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" text-anchor="{anchor}" style="{style}">{escape(words)}</text>'
    )


def round_step(step: float) -> float:
    """The next greater of 1, 2, 5 and any power of ten."""
    power = 10.0 ** math.floor(math.log10(step))
    return next((nice * power for nice in (1.0, 2.0, 5.0) if nice * power >= step), 10.0 * power)


def ticks(low: float, high: float, step: float) -> list[float]:
    """Multiples of `step` from `low` to `high`."""
    first, last = math.ceil(low / step), math.floor(high / step)
    return [round(index * step, 12) for index in range(first, last + 1)]


def unit(vector: Array) -> tuple[float, float]:
    """A direction (2,) of length one."""
    size = math.hypot(float(vector[0]), float(vector[1])) or 1.0
    return float(vector[0]) / size, float(vector[1]) / size
