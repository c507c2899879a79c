"""Where in the picture, and at which depth, a triangulator goes wrong."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from rigsim.present.kit import style
from rigsim.present.kit.format import plain
from rigsim.rig.arrays import Array, Mask
from rigsim.statistics import inner_range
from rigsim.study.verify.result import CaseResult
from rigsim.study.verify.worst import pixel_errors
from rigsim.theory.uncertainty import pixel_gain

_HEIGHT_IN = 3.0
_PANEL_IN = 2.75
_DECADES = 1.5
_MANY_DECADES = 4.0
_SMALLEST_PX = 1e-9
_LEFT_MARGIN_IN, _GAP_IN = 0.7, 1.45


def case_figure(result: CaseResult) -> Figure:
    """The size of the pixel error over the left image; beside it the depth error against depth.

    Where most rows came back as no point, the depths that did come back stand beside it instead.
    """
    with style.styled():
        figure = style.new_figure(style.PAGE_WIDTH_IN, _HEIGHT_IN)
        error_px = pixel_errors(result)
        lens = result.case.rig.left
        height_in = min(_PANEL_IN * lens.height / lens.width, _HEIGHT_IN - 1.0)
        axes = style.place(figure, _LEFT_MARGIN_IN, _HEIGHT_IN - 0.4 - height_in, _PANEL_IN, height_in)
        _draw_image(figure, axes, result, error_px, height_in)
        left = _LEFT_MARGIN_IN + _PANEL_IN + _GAP_IN
        beside = style.place(figure, left, 0.6, style.PAGE_WIDTH_IN - left - 0.1, _HEIGHT_IN - 1.0)
        asked = result.case.answerable
        answered = np.isfinite(error_px) & asked
        if answered.sum() >= 0.5 * asked.sum():
            _draw_depth_errors(beside, result, answered)
        else:
            _draw_depths(beside, result, asked)
    return figure


def _draw_image(figure: Figure, axes: Axes, result: CaseResult, error_px: Array, height_in: float) -> None:
    """Marks at the left pixels; crosses where a point is missing or made up."""
    lens, uv = result.case.rig.left, result.case.uv_left
    none = np.isinf(error_px)
    size = 4 if len(uv) > 500 else 9
    if none.any():
        axes.scatter(
            uv[none, 0],
            uv[none, 1],
            s=2 * size,
            marker="x",
            linewidths=0.8,
            color=style.VERMILION,
            rasterized=True,
        )
    some = np.isfinite(error_px)
    if some.any():
        low, high = _limits(np.maximum(error_px[some], _SMALLEST_PX))
        marks = axes.scatter(
            uv[some, 0],
            uv[some, 1],
            c=np.maximum(error_px[some], _SMALLEST_PX),
            s=size,
            cmap=style.heat_map(),
            norm=LogNorm(low, high),
            rasterized=True,
        )
        bottom = _HEIGHT_IN - 0.4 - height_in
        bar_axes = style.place(figure, _LEFT_MARGIN_IN + _PANEL_IN + 0.1, bottom, 0.1, height_in)
        figure.colorbar(marks, cax=bar_axes)
        bar_axes.grid(False)
        bar_axes.yaxis.set_major_locator(LogLocator(numticks=5))
        bar_axes.yaxis.set_minor_locator(NullLocator())
        bar_axes.yaxis.set_major_formatter(FuncFormatter(_tick))
    axes.set_xlim(-0.5, lens.width - 0.5)
    axes.set_ylim(lens.height - 0.5, -0.5)
    axes.grid(False)
    axes.set_title("Error in pixels" + (", × no point or one too many" if none.any() else ""), fontsize=9.5)
    axes.set_xlabel("u in the left image, px")
    axes.set_ylabel("v, px")


def _draw_depth_errors(axes: Axes, result: CaseResult, answered: Mask) -> None:
    case = result.case
    assert result.found_left is not None
    truth = case.points_left[answered]
    error = np.abs(result.found_left[answered, 2] - truth[:, 2])
    factor, unit = (1.0, "m") if np.median(error) >= 1 else (1e3, "mm")
    depth, error = truth[:, 2], error * factor
    shown = error > 0
    axes.scatter(depth[shown], error[shown], s=4, color=style.BLUE, rasterized=True)
    drawn = error[shown]
    if case.covariance_px2 is not None:
        covariance = np.broadcast_to(case.covariance_px2, (len(case), 4, 4))[answered]
        gain = pixel_gain(case.rig, truth)[:, 2]
        std = np.sqrt(np.einsum("ni,nij,nj->n", gain, covariance, gain)) * factor
        axes.scatter(depth, std, s=3, color=style.VERMILION, rasterized=True)
        drawn = np.concatenate([drawn, std])
        axes.set_title("Depth error; noise: orange", fontsize=9.5)
    else:
        axes.set_title("Depth error", fontsize=9.5)
    axes.set_xlabel("true depth, m")
    axes.set_ylabel(f"depth error, {unit}")
    _log_axis(axes, "x", depth, 4)
    _log_axis(axes, "y", drawn, 6)


def _draw_depths(axes: Axes, result: CaseResult, asked: Mask) -> None:
    assert result.found_left is not None
    true, found = result.case.points_left[asked, 2], result.found_left[asked, 2]
    back = np.isfinite(found)
    axes.set_xlabel("true depth, m")
    axes.set_ylabel("found depth, m")
    axes.set_title("Found depth, line: right", fontsize=9.5)
    axes.scatter(true[back], found[back], s=4, color=style.BLUE, rasterized=True)
    low, high = inner_range(found[back], 0.02) if back.any() else (0.0, 0.0)
    low, high = min(low, 0.0), max(high, float(true.max()))
    axes.plot([0, true.max()], [0, true.max()], color=style.VERMILION)
    margin = 0.05 * (high - low)
    axes.set_ylim(low - margin, high + margin)
    axes.set_xlim(0, 1.05 * float(true.max()))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: plain(value, 4)))


def _log_axis(axes: Axes, which: str, values: Array, ticks: int) -> None:
    low, high = _limits(values)
    axis = axes.xaxis if which == "x" else axes.yaxis
    if np.log10(high / low) < _MANY_DECADES:
        style.plain_axis(axes, "x" if which == "x" else "y", low, high, "log", ticks)
        return
    (axes.set_xscale if which == "x" else axes.set_yscale)("log")
    (axes.set_xlim if which == "x" else axes.set_ylim)(low, high)
    axis.set_major_locator(LogLocator(numticks=ticks))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(_tick))


def _limits(values: Array) -> tuple[float, float]:
    """Ends of a logarithmic axis around positive values, without the few smallest."""
    values = values[np.isfinite(values) & (values > 0)]
    if not values.size:
        return 0.1, 10.0
    low, high = inner_range(values, 0.02)[0], float(values.max())
    if high < low * 10**_DECADES:
        middle = np.sqrt(low * high)
        spread = max(np.sqrt(high / low) * 1.15, 1.5)
        return float(middle / spread), float(middle * spread)
    return low / 1.3, high * 1.3


def _tick(value: float, _: int) -> str:
    """A power of ten, written out where that is short."""
    if 1e-3 <= value < 1e5:
        return plain(value, 3)
    return f"1e{round(np.log10(value))}"
