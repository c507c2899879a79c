"""One chart of the depth error: predicted curve, simulated and measured marks, and their ratios below."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.container import ErrorbarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter
from matplotlib.transforms import Transform, offset_copy

from rigsim.present.kit import style
from rigsim.present.kit.format import plain
from rigsim.present.sweep.measured_words import was_measured
from rigsim.present.sweep.plots import third
from rigsim.present.sweep.plots.axes import PlotAxis, Slice
from rigsim.present.sweep.plots.strips import mark_beyond, scale_strip, within
from rigsim.rig.arrays import Array
from rigsim.study.agreement.agreement import blamed
from rigsim.study.agreement.agreement import flagged as flagged_rows
from rigsim.study.scene import columns as col

PANEL_WIDTH = style.PAGE_WIDTH_IN
"""Width of a chart with its legends, in."""
_LEFT, _WIDTH = 0.88, 4.5
RATIO_BOTTOM = 0.5
"""Where the lowest strip begins, in."""
_RATIO_HEIGHT, _RATIO_STEP = 0.78, 0.96
_MAIN_HEIGHT = 2.5
SIDE = _LEFT + _WIDTH + 0.15
"""Where the legends begin, in from the left."""
_UP = (col.DEPTH_RMSE_CI_LOW, col.DEPTH_RMSE_CI_HIGH, col.PREDICTED_DEPTH_RMSE)
_NO_ERROR_MM = 1e-6  # below a nanometre there is only arithmetic, nothing a logarithm should show
_DOTS = (0, (1, 2))
_LINE_IN = 0.2

DEPTH = PlotAxis(col.DEPTH_MEDIAN, "depth", "m", (), True, lambda value: plain(value / 1e3))
"""The axis of `SweepResult.by_depth`, drawn in metres."""


def panel_height(table: pd.DataFrame) -> float:
    """Height of a chart, in: what was measured has a strip of its own."""
    return 5.28 if was_measured(table) else 4.35


def draw_chart(figure: Figure, x: float, y: float, title: str, cut: Slice, table: pd.DataFrame) -> None:
    """Draw a chart whose lower left corner stands at (x, y) inches; against depth with the square law."""
    n_strips = 2 if was_measured(table) else 1
    bottom = y + RATIO_BOTTOM + n_strips * _RATIO_STEP + 0.02
    axes = style.place(figure, x + _LEFT, bottom, _WIDTH, _MAIN_HEIGHT)
    strips = [
        style.place(figure, x + _LEFT, y + RATIO_BOTTOM + i * _RATIO_STEP, _WIDTH, _RATIO_HEIGHT)
        for i in reversed(range(n_strips))
    ]
    parts = [(value, drawn(part)) for value, part in cut.parts(table)]
    parts = [(value, part) for value, part in parts if len(part)]
    axes.set_title(title, pad=8)
    axes.set_ylabel("depth error RMS, mm")
    for strip, words in zip(strips, ("predicted /\nsimulated", "measured /\npredicted"), strict=False):
        strip.set_ylabel(words)
    strips[-1].set_xlabel(cut.x.label, labelpad=2)
    figure.align_ylabels([axes, *strips])
    if not parts:
        axes.text(0.5, 0.5, "no depth error to draw", transform=axes.transAxes, ha="center")
        return
    found = third.measured_series(cut, parts, lambda part: along(cut.x, part)) if n_strips > 1 else []
    _scale_main(axes, strips, cut.x, [part for _, part in parts], found)
    scale_strip(strips[0], *_ratios(pd.concat([part for _, part in parts])))
    dodges = [4.0 * (i - (len(parts) - 1) / 2) for i in range(len(parts))]
    for i, (_, part) in enumerate(parts):
        _draw_line(axes, strips[0], cut.x, part, style.LINES[i], style.MARKERS[i], dodges[i])
    if n_strips > 1:
        ratios = np.concatenate([series.ratio for series in found]) if found else np.empty(0)
        scale_strip(strips[1], ratios, ratios, ratios)
    for series in found:
        aside = _aside(strips[1], 0.0 if series.line is None else dodges[series.line])
        curve = cut.x.numeric and cut.x.column != col.NOISE
        third.draw_series(axes, strips[1], series, curve, aside)
    if cut.x is DEPTH:
        _draw_square_law(axes, parts[-1][1])
    _draw_legends(figure, cut, parts, found, x + SIDE, bottom + _MAIN_HEIGHT)


def drawn(part: pd.DataFrame) -> pd.DataFrame:
    """The rows that a chart has something to show of; simulated errors that are none are taken out."""
    simulated = part[col.DEPTH_RMSE].between(_NO_ERROR_MM, np.inf, inclusive="neither")
    names = [col.DEPTH_RMSE, *_UP, col.PREDICTED_OVER_SIMULATED]
    return part.assign(**{name: part[name].where(simulated) for name in names})[
        simulated | (part[col.MEASURED_DEPTH_RMSE] > 0)
    ]


def _numbers(table: pd.DataFrame, name: str) -> Array:
    return np.asarray(table[name], dtype=np.float64)


def along(axis: PlotAxis, part: pd.DataFrame) -> Array:
    """Where rows stand along the page: their value, in m for depth, or the place of their name."""
    if axis is DEPTH:
        middle = np.sqrt(_numbers(part, col.DEPTH_NEAR) * _numbers(part, col.DEPTH_FAR))
        median = _numbers(part, axis.column)
        return np.asarray(np.where(np.isfinite(median), median, middle) / 1e3)
    if axis.numeric:
        return _numbers(part, axis.column)
    return np.array([axis.values.index(value) for value in part[axis.column]], dtype=np.float64)


def _scale_main(
    axes: Axes, strips: list[Axes], axis: PlotAxis, parts: list[pd.DataFrame], found: list[third.Series]
) -> None:
    every = pd.concat(parts)
    x = np.concatenate([along(axis, every), *(series.x for series in found)])
    at_values = not (axis.column == col.NOISE and found)
    scale_x([axes, *strips], axis, x, own=at_values)
    y = np.concatenate(
        [_numbers(every, name) for name in _UP]
        + [values for series in found for values in (series.measured_mm, series.predicted_mm)]
    )
    y = y[np.isfinite(y) & (y > 0)]
    for each in (axes, *strips[:-1]):
        each.tick_params(labelbottom=False)
    if style.scale_of(y, 4) == "log":
        style.plain_axis(axes, "y", *_padded_log(y), "log")
    else:
        style.plain_axis(axes, "y", 0.0, 1.15 * float(y.max()), "linear")


def scale_x(every: list[Axes], axis: PlotAxis, x: Array, *, own: bool) -> None:
    """Scale, limits and ticks along the page for places `x`; `own` ticks few values where they stand."""
    scale: style.AxisScale = "linear"
    if not axis.numeric:
        low, high = -0.5, len(axis.values) - 0.5
    elif (scale := style.scale_of(x, 4)) == "log":
        low, high = _padded_log(x)
    else:
        pad = 0.06 * float(np.ptp(x)) or 0.5 * abs(float(x[0])) or 1.0
        low, high = float(x.min()) - pad, float(x.max()) + pad
    few = not axis.numeric or axis.heading == "resolution" or len(axis.values) <= 4
    for each in every:
        style.plain_axis(each, "x", low, high, scale)
        if few and own and axis is not DEPTH:
            places = axis.values if axis.numeric else range(len(axis.values))
            each.xaxis.set_major_locator(FixedLocator([float(place) for place in places]))
            labels = dict(zip([float(place) for place in places], map(axis.show, axis.values), strict=True))
            each.xaxis.set_major_formatter(FuncFormatter(lambda value, _, said=labels: said.get(value, "")))


def _ratios(part: pd.DataFrame) -> tuple[Array, Array, Array]:
    """Predicted over simulated, and the same at both ends of the confidence interval."""
    predicted = _numbers(part, col.PREDICTED_DEPTH_RMSE)
    simulated = (col.DEPTH_RMSE, col.DEPTH_RMSE_CI_HIGH, col.DEPTH_RMSE_CI_LOW)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio, low, high = (predicted / _numbers(part, name) for name in simulated)
    return ratio, low, high


def _padded_log(values: Array) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    pad = (high / low) ** 0.06 if high > low else 1.5
    return low / pad, high * pad


def _aside(strip: Axes, dodge_pt: float) -> Transform:
    """Data, moved sideways by a few points of paper: otherwise the last line hides the others."""
    return offset_copy(strip.transData, strip.get_figure(root=True), dodge_pt, 0, "points")


def _draw_line(
    axes: Axes, strip: Axes, axis: PlotAxis, part: pd.DataFrame, color: str, marker: str, dodge_pt: float
) -> None:
    x = along(axis, part)
    simulated = _numbers(part, col.DEPTH_RMSE)
    predicted = _numbers(part, col.PREDICTED_DEPTH_RMSE)
    ci_low = _numbers(part, col.DEPTH_RMSE_CI_LOW)
    ci_high = _numbers(part, col.DEPTH_RMSE_CI_HIGH)
    known = np.isfinite(predicted)
    if axis.numeric and known.sum() > 1:
        axes.plot(*style.between(x[known], predicted[known]), color=color, zorder=2)
    else:
        axes.scatter(x, predicted, marker="_", s=260, color=color, linewidths=1.8, zorder=2)
    _whiskers(axes, x, (simulated, ci_low, ci_high), color, marker, axes.transData)
    aside = _aside(strip, dodge_pt)
    ratio, ratio_low, ratio_high = _ratios(part)
    mark_beyond(strip, x, ratio, color, aside)
    ratio = within(strip, ratio)
    _whiskers(strip, x, (ratio, ratio_low, ratio_high), color, marker, aside)
    flagged = blamed(part, "simulated")
    style.ring(axes, x[flagged], simulated[flagged], axes.transData)
    style.ring(strip, x[flagged], ratio[flagged], aside)


def _whiskers(
    axes: Axes, x: Array, values: tuple[Array, Array, Array], color: str, marker: str, transform: Transform
) -> ErrorbarContainer:
    """Points and their intervals; `values` are themselves, their lower and their upper ends."""
    y, low, high = values
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


def _draw_square_law(axes: Axes, part: pd.DataFrame) -> None:
    """A dotted line that grows with the square of the depth, a little below the last curve."""
    part = part[part[col.DEPTH_RMSE].notna()]
    x = along(DEPTH, part)
    if len(x) < 2 or x.max() / x.min() < 1.5:
        return
    low, high = axes.get_ylim()
    span = np.geomspace(x.min(), x.max(), 30)
    start = float(np.nanmin(_numbers(part, col.DEPTH_RMSE))) * 0.5
    start = max(start, low * 1.1)
    axes.plot(span, start * (span / span[0]) ** 2, color=style.GREY, linestyle=_DOTS, linewidth=1.4, zorder=1)
    axes.set_ylim(low, high)


def _draw_legends(
    figure: Figure,
    cut: Slice,
    parts: list[tuple[Any, pd.DataFrame]],
    found: list[third.Series],
    left: float,
    top: float,
) -> None:
    neutral = style.INK if cut.lines is not None else style.LINES[0]
    every = pd.concat([part for _, part in parts])
    marks: list[tuple[Artist, str]] = [
        (Line2D([], [], color=neutral), "predicted"),
        (Line2D([], [], color=neutral, marker="o", linestyle="none"), "simulated, 95 % CI"),
    ]
    if found:
        hollow = Line2D(
            [], [], color=neutral, marker=style.MEASURED_MARK, linestyle="none", markerfacecolor="none"
        )
        marks.append((hollow, "measured in\nrenderings"))
        dashed = Line2D([], [], color=neutral, linestyle=third.DASHES, linewidth=1.3)
        marks.append((dashed, "predicted from the\nmeasured noise"))
    if cut.x is DEPTH:
        marks.append((Line2D([], [], color=style.GREY, linestyle=_DOTS, linewidth=1.4), "slope of Z²"))
    if flagged_rows(every).any():
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
        rows = sum(1 + label.count("\n") for _, label in marks)
        style.legend(figure, lines, left, top - _LINE_IN * rows - 0.16, cut.lines.label)
