"""Axes of charts that follow a hand: units in their names, plain ticks, legible in light and dark."""

from __future__ import annotations

import math
from typing import Any, Literal

TEXT, RULE = "#7a828e", "rgba(122,130,142,.28)"
"""Grey of texts and of rules, which shows on white and on black."""
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#767676")
"""Of lines: Okabe and Ito's palette, as in the reports, with a grey for its black."""
PICK = "#E69F00"
"""Of the rig that is recommended, as in the reports."""


def log_axis(which: Literal["x", "y"], name: str, low: float, high: float, most: int = 7) -> dict[str, Any]:
    """A logarithmic axis whose ticks are round numbers.

    Args:
        which: the axis.
        name: its name with the unit.
        low: its lower end, > 0.
        high: its upper end.
        most: most ticks.
    """
    choices = ((1, 1.5, 2, 3, 4, 5, 7), (1, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,))
    levels = [_levels(low, high, steps) for steps in choices]
    ticks = next((found for found in levels if len(found) <= most), levels[-1])
    return {
        "type": "log",
        "min": low,
        "max": high,
        "axisTick": {"customValues": ticks},
        "axisLabel": {"customValues": ticks, "color": TEXT, "hideOverlap": True},
        "minorTick": {"show": False},
        **named(which, name),
    }


def named(which: Literal["x", "y"], name: str) -> dict[str, Any]:
    """Name and rules of an axis."""
    return {
        "name": name,
        "nameLocation": "middle",
        "nameGap": 28 if which == "x" else 46,
        "nameTextStyle": {"color": TEXT},
        "splitLine": {"lineStyle": {"color": RULE}},
        "axisLine": {"show": True, "lineStyle": {"color": TEXT}},
    }


def _levels(low: float, high: float, steps: tuple[float, ...]) -> list[float]:
    exponents = range(math.floor(math.log10(low)), math.floor(math.log10(high)) + 1)
    # a decimal literal is exact where a product with a power of ten is not
    found = (float(f"{step}e{exponent}") for exponent in exponents for step in steps)
    return [level for level in found if low * (1 - 1e-9) <= level <= high * (1 + 1e-9)]
