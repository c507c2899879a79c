"""The depth errors of several rigs over distances, as one chart."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from rigsim.present.live.axes import COLORS, TEXT, named
from rigsim.study.calc.curve import DepthCurve

DASHES = ("solid", "dashed", "dotted", [9, 3, 2, 3])
"""Of the lines, so that they differ without colours too."""


def comparison_options(curves: Sequence[tuple[str, DepthCurve]]) -> dict[str, Any]:
    """The chart of named curves, in order; a rig keeps its colour and its dashes."""
    return {
        "animation": False,
        "backgroundColor": "transparent",
        "aria": {"enabled": True},
        "textStyle": {"fontFamily": "inherit"},
        "grid": {"left": 64, "right": 18, "top": 44, "bottom": 48},
        "legend": {
            "top": 0,
            "left": 8,
            "textStyle": {"color": TEXT},
            "itemWidth": 34,
            "icon": "roundRect",
            "itemHeight": 3,
        },
        "tooltip": {"trigger": "axis", ":formatter": _SAYS},
        "xAxis": {
            "type": "value",
            "min": min((float(f"{curve.z_m[0]:.5g}") for _, curve in curves), default=0.0),
            "max": max((float(f"{curve.z_m[-1]:.5g}") for _, curve in curves), default=5.0),
            "axisLabel": {"color": TEXT},
            **named("x", "distance Z, m"),
        },
        "yAxis": {
            "type": "value",
            "min": 0,
            "axisLabel": {"color": TEXT},
            **named("y", "depth error, std, mm"),
        },
        "series": [
            {
                "name": name,
                "type": "line",
                "showSymbol": False,
                "itemStyle": {"color": COLORS[index]},
                "lineStyle": {"color": COLORS[index], "type": DASHES[index], "width": 2.6},
                "data": [
                    [float(f"{z:.5g}"), float(f"{std:.5g}") if math.isfinite(std) else None]
                    for z, std in zip(curve.z_m.tolist(), curve.std_mm.tolist(), strict=True)
                ],
            }
            for index, (name, curve) in enumerate(curves)
        ],
    }


_SAYS = """
items => items.length ? Number(items[0].data[0]).toPrecision(3) + ' m<br>' + items.filter(item =>
  item.data[1] != null).map(item => item.marker + item.seriesName.replace(/[<>&]/g, '') + ': ' +
  Number(item.data[1]).toPrecision(3) + ' mm').join('<br>') : ''
"""
