"""One small figure of the three witnesses: their depth errors, and each over what is predicted for it."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from rigsim.present.kit import style
from rigsim.present.kit.format import plain
from rigsim.present.sweep.measured_words import METHODS, noise_value
from rigsim.present.sweep.plots import third
from rigsim.present.sweep.plots.axes import PlotAxis, Slice, best_row, slice_along, swept_axes
from rigsim.present.sweep.plots.chart import DEPTH, along, drawn, scale_x
from rigsim.present.sweep.plots.strips import mark_beyond, scale_strip, within
from rigsim.rig.arrays import Array
from rigsim.study.scene import columns as col
from rigsim.study.sweep.result import SweepResult

_LEFT, _WIDTH, _STEP = 0.8, 3.7, 4.45
_HEIGHT, _TOP = 4.6, 0.92
_STRIP_BOTTOM, _STRIP_HEIGHT, _MAIN_BOTTOM = 0.48, 0.8, 1.42
_SIMULATED, _MEASURED = style.BLUE, style.VERMILION


@dataclass(frozen=True, slots=True, eq=False)
class _Curve:
    """Errors of one witness and what is predicted for them; one value a rig or bin of depth."""

    x: Array
    error_mm: Array
    predicted_mm: Array
    ci_mm: Array  # (2, N): down and up from the error


def witnesses_figure(result: SweepResult) -> Figure:
    """The best configuration's three witnesses against baseline (or what was swept first) and depth.

    Each error stands beside what the closed forms predict for its noise: the given one of the simulation,
    the claimed one of the measurement. The strips show both errors over their predictions.
    """
    axes = swept_axes(result)
    shown = [axis for axis in axes if axis.column == col.BASELINE] or [a for a in axes if a.numeric]
    cuts = [(_best_line(result, axis, axes), result.rows) for axis in shown[:1]]
    if len(result.by_depth):
        cuts.append((_best_line(result, DEPTH, axes), result.by_depth))
    with style.styled():
        figure = style.new_figure(_STEP * max(len(cuts), 1) + 0.05, _HEIGHT)
        for i, (cut, table) in enumerate(cuts):
            _draw(figure, i * _STEP, cut, table, _title(cut, axes), first=i == 0)
        _draw_legend(figure, result)
    return figure


def _best_line(result: SweepResult, x: PlotAxis, axes: list[PlotAxis]) -> Slice:
    """The slice through the best row, everything else held."""
    best = best_row(result)
    held = {axis.column: best[axis.column] for axis in axes if axis.column != x.column}
    return replace(slice_along(result, x, axes), lines=None, values=(), held=held)


def _title(cut: Slice, axes: list[PlotAxis]) -> str:
    """What is drawn against what, and where the other axes are held; the legend names the noise."""
    names = [axis for axis in axes if axis.column in cut.held and axis.column != col.NOISE]
    said = (f"{axis.heading} {axis.say(cut.held[axis.column])}".replace(" ", "\u00a0") for axis in names)
    held = ", ".join(said)
    return f"Against {cut.x.heading}" + (f" at {held}" if held else "")


def _draw(figure: Figure, left: float, cut: Slice, table: pd.DataFrame, title: str, *, first: bool) -> None:
    height = _HEIGHT - _MAIN_BOTTOM - _TOP
    axes = style.place(figure, left + _LEFT, _MAIN_BOTTOM, _WIDTH - 0.2, height)
    strip = style.place(figure, left + _LEFT, _STRIP_BOTTOM, _WIDTH - 0.2, _STRIP_HEIGHT)
    axes.set_title("\n".join(textwrap.wrap(title, 44)), pad=5, fontsize=9.5)
    strip.set_xlabel(cut.x.label, labelpad=2)
    if first:
        axes.set_ylabel("depth error RMS, mm")
        strip.set_ylabel("error over\nits prediction")
        figure.align_ylabels([axes, strip])
    parts = [(value, drawn(part)) for value, part in cut.parts(table)]
    if not parts or not len(parts[0][1]):
        axes.text(0.5, 0.5, "no depth error to draw", transform=axes.transAxes, ha="center")
        return
    part = parts[0][1]
    found = third.measured_series(cut, parts, lambda rows: along(cut.x, rows))
    curves: list[tuple[_Curve, str, third.Dashes | str]] = [(_simulated(cut.x, part), _SIMULATED, "solid")]
    curves += [(_measured(series), _MEASURED, third.DASHES) for series in found]
    scale_x([axes, strip], cut.x, np.concatenate([curve.x for curve, _, _ in curves]), own=False)
    axes.tick_params(labelbottom=False)
    errors = np.concatenate([np.r_[curve.error_mm, curve.predicted_mm] for curve, _, _ in curves])
    errors = errors[np.isfinite(errors) & (errors > 0)]
    pad = float(errors.max() / errors.min()) ** 0.06 * 1.05
    style.plain_axis(axes, "y", float(errors.min()) / pad, float(errors.max()) * pad, "log")
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = np.concatenate([curve.error_mm / curve.predicted_mm for curve, _, _ in curves])
    scale_strip(strip, ratios, ratios, ratios)
    for curve, color, dashes in curves:
        _draw_curve(axes, strip, curve, color, dashes)


def _draw_curve(axes: Axes, strip: Axes, curve: _Curve, color: str, dashes: third.Dashes | str) -> None:
    hollow = color == _MEASURED
    known = np.isfinite(curve.predicted_mm) & (curve.predicted_mm > 0)
    axes.plot(
        *style.between(curve.x[known], curve.predicted_mm[known]),
        color=color,
        linestyle=dashes,
        linewidth=1.4,
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio, ci = curve.error_mm / curve.predicted_mm, curve.ci_mm / curve.predicted_mm
    mark_beyond(strip, curve.x, ratio, color, strip.transData)
    for each, y, reach in ((axes, curve.error_mm, curve.ci_mm), (strip, within(strip, ratio), ci)):
        each.errorbar(
            curve.x,
            y,
            yerr=reach,
            color=color,
            marker=style.MEASURED_MARK if hollow else "o",
            markersize=5.5 if hollow else 5,
            markerfacecolor="none" if hollow else color,
            markeredgecolor=color if hollow else "white",
            markeredgewidth=1.3 if hollow else 0.6,
            linestyle="none",
            elinewidth=1.1,
            zorder=5 if hollow else 4,
        )


def _simulated(axis: PlotAxis, part: pd.DataFrame) -> _Curve:
    error, predicted, low, high = (
        np.asarray(part[name], dtype=np.float64)
        for name in (
            col.DEPTH_RMSE,
            col.PREDICTED_DEPTH_RMSE,
            col.DEPTH_RMSE_CI_LOW,
            col.DEPTH_RMSE_CI_HIGH,
        )
    )
    reach = np.nan_to_num(np.clip([error - low, high - error], 0, None))
    return _Curve(along(axis, part), error, predicted, reach)


def _measured(series: third.Series) -> _Curve:
    return _Curve(series.x, series.measured_mm, series.predicted_mm, np.zeros((2, len(series.x))))


def _draw_legend(figure: Figure, result: SweepResult) -> None:
    """Both witnesses with their predictions, above the panels."""
    best = best_row(result)
    method = METHODS.get(str(best[col.MEASURED_METHOD]), "points")
    value = noise_value(best)
    found = f"measured: {method}" + (f", {value} px of noise" if value else "")
    dot = Line2D([], [], color=_SIMULATED, marker="o", linestyle="none")
    line = Line2D([], [], color=_SIMULATED, linewidth=1.4)
    diamond = Line2D(
        [], [], color=_MEASURED, marker=style.MEASURED_MARK, linestyle="none", markerfacecolor="none"
    )
    dashed = Line2D([], [], color=_MEASURED, linestyle=third.DASHES, linewidth=1.4)
    entries: list[tuple[Artist, str]] = [
        (line, f"predicted from {plain(best[col.NOISE])} px of noise"),
        (dot, f"simulated with {plain(best[col.NOISE])} px of noise, 95 % CI"),
        (dashed, "predicted from the accuracy they claim"),
        (diamond, found),
    ]
    style.legend(figure, entries, _LEFT, _HEIGHT - 0.08, columns=2)
