"""Depth error and overlap over distances, as options of one chart with two panels.

Greys and lines are chosen to be read on white and on black paper.
"""

from __future__ import annotations

import math
from typing import Any

from rigsim.rig.arrays import Array
from rigsim.study.calc.curve import DepthCurve, OverlapCurve

AXIS, RULE = "#7a828e", "rgba(122,130,142,.28)"
"""Of axes' words and of lines behind curves."""
ERROR, BOUND, REQUIRED, SHARE = "#0072B2", "#56B4E9", "#D55E00", "#009E73"
"""Of the depth error, its bounds, what is required, and the overlap (Okabe and Ito's palette)."""
_TALL, _FLAT = 280, 110
_SERIES = ("depth error, std", "found too far by", "found too near by", "required", "overlap")


def curve_options(*, log: bool) -> dict[str, Any]:
    """The chart without its data; `log` for logarithmic axes."""
    scale = "log" if log else "value"
    return {
        "animation": False,
        "backgroundColor": "transparent",
        "aria": {"enabled": True},
        "textStyle": {"fontFamily": "inherit"},
        "grid": [
            {"left": 64, "right": 18, "top": 40, "height": _TALL},
            {"left": 64, "right": 18, "top": 40 + _TALL + 56, "height": _FLAT},
        ],
        "legend": {
            "top": 0,
            "left": 8,
            "textStyle": {"color": AXIS},
            "data": list(_SERIES[:4]),
            "icon": "roundRect",
            "itemHeight": 3,
            "itemWidth": 18,
        },
        "axisPointer": {"link": [{"xAxisIndex": "all"}], "label": {":formatter": _SAYS_POINTER}},
        "tooltip": {"trigger": "axis", ":formatter": _SAYS},
        "xAxis": [_across(scale, 0, "distance Z, m"), _across(scale, 1, "distance Z, m")],
        "yAxis": [
            _axis("depth error, mm", 0, type=scale, min=None if log else 0),
            _axis("overlap, %", 1, type="value", min=0, max=100, interval=50),
        ],
        "series": [
            _line(_SERIES[0], ERROR, width=2.6),
            _line(_SERIES[1], BOUND, kind="dashed"),
            _line(_SERIES[2], BOUND, kind="dotted"),
            _line(_SERIES[3], REQUIRED, kind="dashed"),
            _line(_SERIES[4], SHARE, panel=1, width=2.2),
        ],
    }


def fill_curves(
    options: dict[str, Any],
    depth: DepthCurve | None,
    overlap: OverlapCurve | None,
    required: tuple[float, float] | None,
) -> None:
    """Put what is shown into the chart's options.

    Args:
        options: of `curve_options`; changed in place.
        depth: the depth error; None for none.
        overlap: the overlap; None for none.
        required: distance, m, and the error allowed there, mm; None for none.
    """
    series = options["series"]
    log = options["yAxis"][0]["type"] == "log"
    for item, values in zip(series, ("std_mm", "too_far_mm", "too_near_mm"), strict=False):
        item["data"] = [] if depth is None else _points(depth.z_m, getattr(depth, values), log=log)
    series[3]["data"] = []
    if required is not None and depth is not None:
        at_m, error_mm = required
        foot = _foot(depth, log=log)
        series[3]["data"] = [
            [_short(min(float(depth.z_m[0]), at_m)), error_mm],
            [at_m, error_mm],
            [at_m, foot],
        ]
    series[4]["data"] = [] if overlap is None else _points(overlap.z_m, 100 * overlap.share)
    if depth is not None:
        ends = _short(float(depth.z_m[0])), _short(float(depth.z_m[-1]))
        for axis in options["xAxis"]:
            axis["min"], axis["max"] = ends


def _foot(depth: DepthCurve, *, log: bool) -> float:
    """Where the line down from the requirement ends: the axis, or the curve's least on a logarithmic one."""
    known = depth.std_mm[depth.std_mm > 0]
    return 0.0 if not log or not len(known) else _short(float(known.min()))


def _points(x: Array, y: Array, *, log: bool = False) -> list[list[float | None]]:
    return [
        [_short(a), _short(b) if math.isfinite(b) and (b > 0 or not log) else None]
        for a, b in zip(x.tolist(), y.tolist(), strict=True)
    ]


def _short(value: float) -> float:
    return float(f"{value:.5g}")


def _line(
    name: str, color: str, *, kind: str = "solid", panel: int = 0, width: float = 1.6
) -> dict[str, Any]:
    return {
        "name": name,
        "type": "line",
        "showSymbol": False,
        "xAxisIndex": panel,
        "yAxisIndex": panel,
        "itemStyle": {"color": color},
        "lineStyle": {"color": color, "type": kind, "width": width},
        "data": [],
    }


def _axis(name: str, panel: int, **more: Any) -> dict[str, Any]:
    return {
        "name": name,
        "gridIndex": panel,
        "nameLocation": "middle",
        "nameGap": 44,
        "nameTextStyle": {"color": AXIS, "fontSize": 12.5},
        "axisLabel": {"color": AXIS, "hideOverlap": True},
        "axisLine": {"show": True, "lineStyle": {"color": AXIS}},
        "splitLine": {"lineStyle": {"color": RULE}},
        **{key: value for key, value in more.items() if value is not None},
    }


def _across(scale: str, panel: int, name: str) -> dict[str, Any]:
    return {**_axis(name, panel, type=scale), "nameGap": 26}


_SAYS_POINTER = (
    "pointer => Number(pointer.value).toPrecision(3) + (pointer.axisDimension === 'x' ? ' m' : '')"
)
_SAYS = """
items => {
  if (!items.length) return '';
  const lines = items.filter(item => item.data[1] != null && item.seriesName !== 'required').map(item =>
    item.marker + item.seriesName + '  <b>' + Number(item.data[1]).toPrecision(3) + '</b>' +
    (item.seriesName === 'overlap' ? ' %' : ' mm'));
  return 'Z = <b>' + Number(items[0].axisValue).toPrecision(3) + '</b> m<br>' + lines.join('<br>');
}
""".strip()
