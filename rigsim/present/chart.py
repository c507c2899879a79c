"""One chart of the depth error: predicted curve, simulated marks, and their ratio below."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.container import ErrorbarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator
from matplotlib.transforms import Transform, offset_copy

from rigsim.present import style
from rigsim.present.axes import Axis, Slice
from rigsim.present.format import plain
from rigsim.rig.arrays import Array

PANEL_WIDTH, PANEL_HEIGHT = style.PAGE_WIDTH_IN, 4.35
"""Size of a chart with its legends, in."""
_LEFT, _WIDTH = 0.88, 4.5
_MAIN_BOTTOM, _MAIN_HEIGHT = 1.48, 2.5
RATIO_BOTTOM, _RATIO_HEIGHT = 0.5, 0.78
SIDE = _LEFT + _WIDTH + 0.15
"""Where the legends begin, in from the left."""
_UP = ("depth_rmse_ci_low_mm", "depth_rmse_ci_high_mm", "predicted_depth_rmse_mm", "measured_depth_rmse_mm")
_NO_ERROR_MM = 1e-6  # below a nanometre there is only arithmetic, nothing a logarithm should show
_DASHED = (0, (4, 3))

DEPTH = Axis("depth_median_mm", "depth", "m", (), True, lambda value: plain(value / 1e3))
"""The axis of `SweepResult.by_depth`, drawn in metres."""


def draw_chart(figure: Figure, x: float, y: float, title: str, cut: Slice, table: pd.DataFrame) -> None:
    """Draw a chart whose lower left corner stands at (x, y) inches; against depth with the square law."""
    axes = style.place(figure, x + _LEFT, y + _MAIN_BOTTOM, _WIDTH, _MAIN_HEIGHT)
    ratio_axes = style.place(figure, x + _LEFT, y + RATIO_BOTTOM, _WIDTH, _RATIO_HEIGHT)
    parts = [
        (value, part[part["depth_rmse_mm"].between(_NO_ERROR_MM, np.inf, inclusive="neither")])
        for value, part in cut.parts(table)
    ]
    parts = [(value, part) for value, part in parts if len(part)]
    axes.set_title(title, pad=8)
    axes.set_ylabel("depth error RMS, mm")
    ratio_axes.set_xlabel(cut.x.label, labelpad=2)
    ratio_axes.set_ylabel("predicted /\nsimulated")
    if not parts:
        axes.text(0.5, 0.5, "no depth error to draw", transform=axes.transAxes, ha="center")
        return
    _scale_main(axes, ratio_axes, cut.x, [part for _, part in parts])
    _scale_ratio(ratio_axes, pd.concat([part for _, part in parts]))
    for i, (_, part) in enumerate(parts):
        dodge_pt = 4.0 * (i - (len(parts) - 1) / 2)
        _draw_line(axes, ratio_axes, cut.x, part, style.LINES[i], style.MARKERS[i], dodge_pt)
    if cut.x is DEPTH:
        _draw_square_law(axes, parts[-1][1])
    _draw_legends(figure, cut, parts, x + SIDE, y + _MAIN_BOTTOM + _MAIN_HEIGHT)


def _numbers(table: pd.DataFrame, name: str) -> Array:
    return np.asarray(table[name], dtype=np.float64)


def _positions(axis: Axis, part: pd.DataFrame) -> Array:
    """Where rows stand along the page: their value, in m for depth, or the place of their name."""
    if axis is DEPTH:
        return _numbers(part, axis.column) / 1e3
    if axis.numeric:
        return _numbers(part, axis.column)
    return np.array([axis.values.index(value) for value in part[axis.column]], dtype=np.float64)


def _scale_main(axes: Axes, ratio_axes: Axes, axis: Axis, parts: list[pd.DataFrame]) -> None:
    x = np.concatenate([_positions(axis, part) for part in parts])
    every = pd.concat(parts)
    y = np.concatenate([_numbers(every, name) for name in _UP if name in every])
    y = y[np.isfinite(y) & (y > 0)]
    scale: style.Scale = "linear"
    if not axis.numeric:
        low, high = -0.5, len(axis.values) - 0.5
    elif (scale := style.scale_of(x, 4)) == "log":
        low, high = _padded_log(x)
    else:
        pad = 0.06 * float(np.ptp(x)) or 0.5 * abs(float(x[0])) or 1.0
        low, high = float(x.min()) - pad, float(x.max()) + pad
    for each in (axes, ratio_axes):
        style.plain_axis(each, "x", low, high, scale)
        if axis is not DEPTH and (not axis.numeric or axis.heading == "resolution" or len(axis.values) <= 4):
            places = axis.values if axis.numeric else range(len(axis.values))
            each.xaxis.set_major_locator(FixedLocator([float(place) for place in places]))
            labels = dict(zip([float(place) for place in places], map(axis.show, axis.values), strict=True))
            each.xaxis.set_major_formatter(FuncFormatter(lambda value, _, said=labels: said.get(value, "")))
    axes.tick_params(labelbottom=False)
    if style.scale_of(y, 4) == "log":
        style.plain_axis(axes, "y", *_padded_log(y), "log")
    else:
        style.plain_axis(axes, "y", 0.0, 1.15 * float(y.max()), "linear")


def _scale_ratio(ratio_axes: Axes, every: pd.DataFrame) -> None:
    ratio, low_ratio, high_ratio = _ratios(every)
    half = max(1.3 * _most(ratio - 1, 100), 1.15 * _most(np.stack([low_ratio, high_ratio]) - 1, 90))
    half = float(np.clip(half, 0.02, 1.0))
    ratio_axes.set_ylim(1 - half, 1 + half)
    ratio_axes.yaxis.set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10]))
    ratio_axes.yaxis.set_minor_locator(NullLocator())
    ratio_axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: plain(value, 4)))
    ratio_axes.axhline(1, color="#555555", linewidth=0.9)


def _ratios(part: pd.DataFrame) -> tuple[Array, Array, Array]:
    """Predicted over simulated, and the same at both ends of the confidence interval."""
    predicted = _numbers(part, "predicted_depth_rmse_mm")
    simulated = ("depth_rmse_mm", "depth_rmse_ci_high_mm", "depth_rmse_ci_low_mm")
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio, low, high = (predicted / _numbers(part, name) for name in simulated)
    return ratio, low, high


def _most(deviation: Array, share: float) -> float:
    size = np.abs(deviation[np.isfinite(deviation)])
    return float(np.percentile(size, share)) if size.size else 0.0


def _padded_log(values: Array) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    pad = (high / low) ** 0.06 if high > low else 1.5
    return low / pad, high * pad


def _draw_line(
    axes: Axes, ratio_axes: Axes, axis: Axis, part: pd.DataFrame, color: str, marker: str, dodge_pt: float
) -> None:
    x = _positions(axis, part)
    simulated = _numbers(part, "depth_rmse_mm")
    predicted = _numbers(part, "predicted_depth_rmse_mm")
    ci_low = _numbers(part, "depth_rmse_ci_low_mm")
    ci_high = _numbers(part, "depth_rmse_ci_high_mm")
    if axis.numeric and len(x) > 1:
        axes.plot(*_between(x, predicted), color=color, zorder=2)
    else:
        axes.scatter(x, predicted, marker="_", s=260, color=color, linewidths=1.8, zorder=2)
    _whiskers(axes, x, simulated, ci_low, ci_high, color, marker, axes.transData)
    if "measured_depth_rmse_mm" in part:
        measured = _numbers(part, "measured_depth_rmse_mm")
        axes.scatter(
            x, measured, marker=style.MEASURED_MARK, s=42, facecolors="none", edgecolors=color, zorder=5
        )
    # beside one another, by a few points of paper: otherwise the last line hides the others
    aside = offset_copy(ratio_axes.transData, ratio_axes.get_figure(root=True), dodge_pt, 0, "points")
    ratio, ratio_low, ratio_high = _ratios(part)
    _whiskers(ratio_axes, x, ratio, ratio_low, ratio_high, color, marker, aside)
    flagged = (part["agreement"] != "agrees").to_numpy()
    for each, values, transform in (
        (axes, simulated, axes.transData),
        (ratio_axes, ratio, aside),
    ):
        each.scatter(
            x[flagged],
            values[flagged],
            s=120,
            facecolors="none",
            edgecolors=style.INK,
            linewidths=1.3,
            zorder=6,
            transform=transform,
        )


def _whiskers(
    axes: Axes, x: Array, y: Array, low: Array, high: Array, color: str, marker: str, transform: Transform
) -> ErrorbarContainer:
    reach = np.nan_to_num(np.clip([y - low, high - y], 0, None))
    return axes.errorbar(
        x,
        y,
        yerr=reach,
        color=color,
        marker=marker,
        markeredgecolor="white",
        markeredgewidth=0.6,
        markersize=6 if len(x) <= 20 else 4.5,
        linestyle="none",
        elinewidth=1.2 if len(x) <= 20 else 0.6,
        capsize=2.5 if len(x) <= 20 else 0,
        zorder=4,
        transform=transform,
    )


def _between(x: Array, y: Array) -> tuple[Array, Array]:
    """The polyline through (x, y), bent as a power law where all is positive: the law between the rigs."""
    if not ((x > 0).all() and (y > 0).all()) or np.ptp(x) == 0:
        return x, y
    fine = np.unique(np.concatenate([x, np.geomspace(x.min(), x.max(), 100)]))
    return fine, np.exp(np.interp(np.log(fine), np.log(x), np.log(y)))


def _draw_square_law(axes: Axes, part: pd.DataFrame) -> None:
    """A dashed line that grows with the square of the depth, a little below the last curve."""
    x = _positions(DEPTH, part)
    if len(x) < 2 or x.max() / x.min() < 1.5:
        return
    low, high = axes.get_ylim()
    span = np.geomspace(x.min(), x.max(), 30)
    start = float(_numbers(part, "depth_rmse_mm")[0]) * 0.5
    start = max(start, low * 1.1)
    axes.plot(
        span, start * (span / span[0]) ** 2, color=style.GREY, linestyle=_DASHED, linewidth=1.2, zorder=1
    )
    axes.set_ylim(low, high)


def _draw_legends(
    figure: Figure, cut: Slice, parts: list[tuple[Any, pd.DataFrame]], left: float, top: float
) -> None:
    neutral = style.INK if cut.lines is not None else style.LINES[0]
    every = pd.concat([part for _, part in parts])
    marks: list[tuple[Artist, str]] = [
        (Line2D([], [], color=neutral), "predicted"),
        (Line2D([], [], color=neutral, marker="o", linestyle="none"), "simulated, 95 % CI"),
    ]
    if "measured_depth_rmse_mm" in every:
        hollow = Line2D(
            [], [], color=neutral, marker=style.MEASURED_MARK, linestyle="none", markerfacecolor="none"
        )
        marks.append((hollow, "measured in images"))
    if cut.x is DEPTH:
        marks.append((Line2D([], [], color=style.GREY, linestyle=_DASHED, linewidth=1.2), "slope of Z²"))
    if (every["agreement"] != "agrees").any():
        ring = Line2D(
            [],
            [],
            marker="o",
            markersize=9,
            markerfacecolor="none",
            markeredgecolor=style.INK,
            linestyle="none",
        )
        marks.append((ring, "flagged"))
    style.legend(figure, marks, left, top)
    if cut.lines is not None:
        show = cut.lines.show
        lines: list[tuple[Artist, str]] = [
            (Line2D([], [], color=style.LINES[i], marker=style.MARKERS[i], linewidth=1.6), show(value))
            for i, (value, _) in enumerate(parts)
        ]
        style.legend(figure, lines, left, top - 0.2 * len(marks) - 0.16, cut.lines.label)
