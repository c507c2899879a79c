"""The feasible region as options of a chart: area, the line of each limit with its name, and rigs in it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from rigsim.present.live.axes import COLORS, PICK, TEXT, log_axis
from rigsim.rig.arrays import Array
from rigsim.study.design import words as words
from rigsim.study.design.region import LimitLine, Region

_DASHES: tuple[str | list[int], ...] = ("solid", [8, 4], [10, 3, 2, 3], [2, 3])
_AREA = 48
_DRAW = """(params, api) => {
  const n = COUNT, at = k => api.coord([api.value(k), api.value(n + k)]), points = [];
  for (let k = 0; k < n; k++) points.push(at(k));
  return {type: 'polygon', shape: {points}, style: {fill: '#009e73', opacity: 0.2}, silent: true};
}""".replace("COUNT", str(2 * _AREA))

_ABOVE, _LEFT_OF = [10, -16], [-6, 6]
"""Where a name begins, or ends, from its line's end, px."""

Mark = tuple[float, float]
"""Focal length, px, and baseline, mm, of a rig."""


def region_chart(shown: Region, rigs: Sequence[Mark] = (), pick: Mark | None = None) -> dict[str, Any]:
    """Options of the chart.

    Args:
        shown: the region.
        rigs: rigs that would do.
        pick: the one that is recommended.
    """
    low_mm, high_mm = (end * 1e3 for end in shown.span_m)
    x = log_axis("x", "focal length, px", *_outward(shown.focal_px))
    y = log_axis("y", "baseline, mm", low_mm, high_mm)
    dots = {"type": "scatter", "z": 4, "silent": True}
    return {
        "animation": False,
        "backgroundColor": "transparent",
        "grid": {"left": 66, "right": 14, "top": 14, "bottom": 48},
        "xAxis": x,
        "yAxis": y,
        "series": [
            _area(shown, low_mm, high_mm),
            dots
            | {
                "name": "rigs that would do",
                "data": [list(mark) for mark in rigs],
                "symbolSize": 7,
                "itemStyle": {"color": "transparent", "borderColor": TEXT, "borderWidth": 1.5},
            },
            dots
            | {
                "name": "recommended",
                "z": 6,
                "data": [] if pick is None else [list(pick)],
                "symbol": _STAR,
                "symbolSize": 22,
                "itemStyle": {"color": PICK, "borderColor": "#222222", "borderWidth": 1},
                "label": {"show": True, "position": "right", "formatter": "recommended", "color": TEXT},
            },
            _names(shown, low_mm, high_mm),
            *(_line(line, low_mm, high_mm) for line in shown.lines),
        ],
    }


_STAR = "path://M0,-10 L2.9,-3.1 L10,-3.1 L4.4,1.8 L6.5,9.5 L0,5 L-6.5,9.5 L-4.4,1.8 L-10,-3.1 L-2.9,-3.1 Z"


def _outward(focal_px: Array) -> tuple[float, float]:
    """Ends of the axis, three digits."""
    return words.rounded(float(focal_px[0]), False), words.rounded(float(focal_px[-1]), True)


def _area(shown: Region, low_mm: float, high_mm: float) -> dict[str, Any]:
    """The feasible area as one polygon of as many corners whatever it is: there along the short end, and back
    along the long one."""
    there = np.isfinite(shown.shortest_m)
    data = []
    if there.sum() >= 2:
        focal = shown.focal_px[there]
        x = np.geomspace(focal[0], focal[-1], _AREA)
        ends = [
            np.exp(np.interp(np.log(x), np.log(focal), np.log(np.minimum(end[there] * 1e3, 10 * high_mm))))
            for end in (shown.shortest_m, shown.longest_m)
        ]
        lower, upper = (np.clip(end, low_mm, high_mm) for end in ends)
        data = [np.round(np.concatenate([x, x[::-1], lower, upper[::-1]]), 3).tolist()]
    return {
        "type": "custom",
        "name": "feasible",
        ":renderItem": _DRAW,
        "data": data,
        "silent": True,
        "clip": True,
        "z": 1,
    }


def _line(line: LimitLine, low_mm: float, high_mm: float) -> dict[str, Any]:
    x, y = _seen(line, low_mm, high_mm)
    return {
        "type": "line",
        "name": _name(line),
        "z": 3,
        "silent": True,
        "showSymbol": False,
        "data": np.round(np.column_stack([x, y]), 3).tolist(),
        "lineStyle": {
            "color": COLORS[line.place % len(COLORS)],
            "type": _DASHES[line.place % len(_DASHES)],
            "width": 2,
        },
    }


def _names(shown: Region, low_mm: float, high_mm: float) -> dict[str, Any]:
    """The limits' names, each at its line's left end and above it; beside those that stand upright."""
    data = []
    for line in shown.lines:
        x, y = _seen(line, low_mm, high_mm)
        if not len(x):
            continue
        upright = x[0] == x[-1]
        at = [float(x[0]), float(y[-1] if upright else y[0])]
        label = {"formatter": _name(line), "position": _LEFT_OF if upright else _ABOVE}
        label["align"] = "right" if upright else "left"
        data.append({"value": at, "label": label})
    return {
        "type": "scatter",
        "name": "limits",
        "silent": True,
        "z": 5,
        "data": data,
        "symbolSize": 1,
        "itemStyle": {"color": "transparent"},
        "label": {"show": True, "color": TEXT, "fontSize": 12},
        "labelLayout": {"moveOverlap": "shiftY"},
    }


def _name(line: LimitLine) -> str:
    return words.whole(line.requirement).replace("<=", "≤").replace(">=", "≥")


def _seen(line: LimitLine, low_mm: float, high_mm: float) -> tuple[Array, Array]:
    """The line's part inside the chart, px and mm."""
    x, y = line.focal_px, line.baseline_m * 1e3
    return (x, y) if x[0] == x[-1] else _within(x, y, low_mm, high_mm)


def _within(x: Array, y: Array, low: float, high: float) -> tuple[Array, Array]:
    """The part of a falling or rising line that lies between two ends, to where it leaves them."""
    found = []
    for (x0, y0), (x1, y1) in pairwise(zip(x, y, strict=True)):
        inside = [(x0, y0)] if low <= y0 <= high else []
        for end in (low, high):
            if min(y0, y1) < end < max(y0, y1):
                share = np.log(end / y0) / np.log(y1 / y0)
                inside.append((x0 * (x1 / x0) ** share, end))
        found += sorted(inside)
    if low <= y[-1] <= high:
        found.append((x[-1], y[-1]))
    kept = np.array(found).reshape(-1, 2)
    return kept[:, 0], kept[:, 1]
