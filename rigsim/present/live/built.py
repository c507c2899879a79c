"""A built rig's errors over the image, and the ranked quantities of a class, as options of charts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from rigsim.present.live.axes import COLORS, PICK, TEXT, named
from rigsim.rig.arrays import Array

_DIVERGING = ("#08519c", "#4292c6", "#9ecae1", "#f2f2f2", "#fdbe85", "#e6550d", "#9a3403")
"""Blue for negative, orange for positive: told apart by the colour-blind, and equal in lightness."""
_STEPS = (1, 2, 5, 10)
_GUIDE_PX = 640


def error_map(u_px: Array, v_px: Array, values: Array, name: str, unit: str) -> dict[str, Any]:
    """Signed values over the left image.

    Args:
        u_px: columns (n,), px.
        v_px: rows (m,), px.
        values: values (m, n); NaN where there is none.
        name: what they are.
        unit: their unit.
    """
    known = np.isfinite(values)
    largest = round_up(float(np.abs(values[known]).max())) if known.any() else 1.0
    rows, columns = np.nonzero(known)
    cells = [
        [int(column), int(row), float(f"{values[row, column]:.4g}")]
        for row, column in zip(rows, columns, strict=True)
    ]
    return {
        "animation": False,
        "backgroundColor": "transparent",
        "grid": {"left": 60, "right": 14, "top": 10, "bottom": 84},
        "xAxis": _side("x", "u, px", u_px),
        "yAxis": {**_side("y", "v, px", v_px), "inverse": True},
        "visualMap": {
            "type": "continuous",
            "min": -largest,
            "max": largest,
            "calculable": False,
            "orient": "horizontal",
            "left": "center",
            "bottom": 0,
            "itemHeight": 220,
            "itemWidth": 14,
            "text": [f"+{largest:g} {unit}", f"−{largest:g} {unit}"],
            "textStyle": {"color": TEXT},
            "inRange": {"color": list(_DIVERGING)},
        },
        "tooltip": {
            "position": "top",
            ":formatter": f"p => '{name} <b>' + p.data[2] + '</b> {unit}'",
        },
        "series": [{"type": "heatmap", "name": name, "data": cells, "progressive": 0}],
    }


def round_up(value: float) -> float:
    """The next of 1, 2, 5 times a power of ten: a scale that stands still while a hand moves a little."""
    if not 0 < value < math.inf:
        return 1.0
    power = math.floor(math.log10(value))
    return next(found for step in _STEPS if (found := float(f"{step}e{power}")) >= value * (1 - 1e-9))


def _side(which: Any, name: str, px: Array) -> dict[str, Any]:
    return {
        **named(which, name),
        "type": "category",
        "data": [f"{value:.0f}" for value in px],
        "axisLabel": {"color": TEXT, "interval": max(1, len(px) // 5) - 1},
        "axisTick": {"show": False},
        "splitLine": {"show": False},
    }


def ranked_bars(
    names: Sequence[str], common_mm: Sequence[float], differing_mm: Sequence[float], at: str
) -> dict[str, Any]:
    """Bars of what each quantity does alone, the worst on top.

    Args:
        names: the quantities, the worst first.
        common_mm: what the whole image shares, mm.
        differing_mm: what differs over the image, mm.
        at: the distance, in words.
    """
    bars = (
        ("common", [abs(value) for value in common_mm], COLORS[0]),
        ("varies across the image", list(differing_mm), COLORS[4]),
    )
    return {
        "animation": False,
        "backgroundColor": "transparent",
        "grid": {"left": 170, "right": 16, "top": 34, "bottom": 46},
        "legend": {"top": 0, "left": 0, "textStyle": {"color": TEXT}},
        "tooltip": {
            "trigger": "axis",
            "axisPointer": {"type": "shadow"},
            ":valueFormatter": "v => Number(v).toPrecision(3) + ' mm'",
        },
        "xAxis": {**named("x", f"depth error at {at}, mm"), "type": "value", "axisLabel": {"color": TEXT}},
        "yAxis": {
            "type": "category",
            "inverse": True,
            "data": list(names),
            "axisLabel": {"color": TEXT, "interval": 0},
            "axisTick": {"show": False},
            "axisLine": {"lineStyle": {"color": TEXT}},
        },
        "series": [
            {
                "type": "bar",
                "name": name,
                "data": [float(f"{value:.4g}") for value in values],
                "itemStyle": {"color": color},
                "barMaxWidth": 11,
            }
            for name, values, color in bars
        ],
    }


def row_guide(share: float, apart: float | None, drawn: tuple[int, int]) -> str:
    """A marked row over a picture: where a matcher looks, and where the points of that row are.

    Args:
        share: the row, from 0 at the top to 1 at the bottom.
        apart: how much lower the points are, as a share of the height; None for no second line.
        drawn: width and height of the picture, px.
    """
    width, height = drawn
    thin = max(width / _GUIDE_PX, 0.5)
    looks = (
        f'stroke="#ffffff" stroke-width="{1.5 * thin:.2f}" stroke-dasharray="{5 * thin:.1f} {4 * thin:.1f}"'
    )
    found = f'stroke="{PICK}" stroke-width="{2 * thin:.2f}"'
    lines = [(share, looks)] if apart is None else [(share, looks), (share + apart, found)]
    return "".join(
        f'<line x1="0" x2="{width}" y1="{at * height:.2f}" y2="{at * height:.2f}" {style}/>'
        for at, style in lines
    )
