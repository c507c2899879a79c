"""The depth error over two axes of a sweep, one cell a rig."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from rigsim.present.kit import style
from rigsim.present.kit.format import number, plain
from rigsim.present.sweep.plots.axes import PlotAxis, best_row, swept_axes
from rigsim.present.sweep.same import at_same_distances
from rigsim.rig.arrays import Array
from rigsim.study.agreement.agreement import flagged as flagged_rows
from rigsim.study.scene import columns as col
from rigsim.study.sweep.result import SweepResult

_MOST_ANNOTATED = 12
_MOST_TICKS = 10


def heat_map_axes(axes: list[PlotAxis]) -> tuple[PlotAxis, PlotAxis] | None:
    """The two numeric axes with the most values, the longer one along the page; None without two."""
    numeric = sorted((axis for axis in axes if axis.numeric), key=lambda axis: -len(axis.values))
    return (numeric[0], numeric[1]) if len(numeric) > 1 else None


def heat_map_values(result: SweepResult, across: PlotAxis, up: PlotAxis) -> tuple[Array, Array]:
    """Depth error RMS (rows of `up`, columns of `across`) in mm, and 1 where flagged.

    It is taken at the same distances; NaN where no rig is, or none that answers them. Further axes are held
    at the best row's value.
    """
    rows = at_same_distances(result)
    best = best_row(result)
    for axis in swept_axes(result):
        if axis.column not in (across.column, up.column):
            rows = rows[rows[axis.column] == best[axis.column]]
    values = np.full((len(up.values), len(across.values)), np.nan)
    flagged = np.zeros_like(values)
    i = [up.values.index(value) for value in rows[up.column]]
    j = [across.values.index(value) for value in rows[across.column]]
    values[i, j] = rows[col.DEPTH_RMSE].to_numpy(dtype=np.float64)
    flagged[i, j] = flagged_rows(rows)
    return values, flagged


def draw_heat_map(
    figure: Figure,
    frame: tuple[float, float, float, float],
    result: SweepResult,
    across: PlotAxis,
    up: PlotAxis,
    title: str,
) -> None:
    """Draw the heat map with its colour bar; `frame` is left, bottom, width, height in inches."""
    left, bottom, width, height = frame
    values, flagged = heat_map_values(result, across, up)
    axes = style.place(figure, left, bottom, width, height)
    axes.grid(False)
    axes.set_title(title, pad=8)
    axes.set_xlabel(across.label, labelpad=2)
    axes.set_ylabel(up.label)
    _ticks(axes, across, up)
    finite = values[np.isfinite(values) & (values > 1e-6)]
    if not len(finite):
        axes.text(0.5, 0.5, "no depth error to draw", transform=axes.transAxes, ha="center")
        return
    low, high = float(finite.min()), float(finite.max())
    if high < 1.001 * low:
        low, high = 0.9 * low, 1.1 * high
    logarithmic = style.scale_of(finite, 4) == "log"
    norm: Normalize = LogNorm(low, high) if logarithmic else Normalize(low, high)
    colors = style.heat_map()
    mesh = axes.pcolormesh(
        np.arange(values.shape[1] + 1) - 0.5,
        np.arange(values.shape[0] + 1) - 0.5,
        np.ma.masked_where(~(values > 1e-6), values),
        cmap=colors,
        norm=norm,
        edgecolors="white",
        linewidth=0.8 if max(values.shape) <= 30 else 0.0,
        rasterized=values.size > 400,
    )
    bar_axes = style.place(figure, left + width + 0.15, bottom, 0.14, height)
    bar = figure.colorbar(mesh, cax=bar_axes)
    bar.set_label("depth error RMS, mm")
    bar_axes.grid(False)
    if logarithmic:
        ticks = style.nice_levels(low, high)
        bar_axes.yaxis.set_major_locator(FixedLocator(ticks))
    else:
        bar_axes.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    bar_axes.yaxis.set_minor_locator(NullLocator())
    bar_axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: plain(value, 4)))
    if min(values.shape) >= 3 and (values > 1e-6).all():
        levels = style.nice_levels(low * 1.02, high * 0.98)
        if levels:
            lines = axes.contour(values, levels, colors="white", linewidths=1.3, alpha=0.9)
            bar.add_lines(lines)
    if max(values.shape) <= _MOST_ANNOTATED:
        _annotate(axes, values, norm)
    for i, j in zip(*np.nonzero(flagged), strict=True):
        axes.add_patch(
            Rectangle((j - 0.47, i - 0.47), 0.94, 0.94, fill=False, edgecolor=style.VERMILION, linewidth=1.8)
        )


def _ticks(axes: Axes, across: PlotAxis, up: PlotAxis) -> None:
    for axis, drawn in ((across, axes.xaxis), (up, axes.yaxis)):
        most = _MOST_TICKS if max(len(axis.show(value)) for value in axis.values) <= 4 else 7
        step = -(-len(axis.values) // most)
        places = list(range(0, len(axis.values), step))
        drawn.set_major_locator(FixedLocator(places))
        drawn.set_minor_locator(NullLocator())
        said = {place: axis.show(axis.values[place]) for place in places}
        drawn.set_major_formatter(FuncFormatter(lambda value, _, said=said: said.get(round(value), "")))


def _annotate(axes: Axes, values: Array, norm: Normalize) -> None:
    digits = 2 if values.shape[1] > 7 else 3
    colors = style.heat_map()
    for (i, j), value in np.ndenumerate(values):
        if np.isfinite(value):
            share = float(norm(value)) if value > 1e-6 else 1.0
            axes.text(
                j,
                i,
                number(value, digits),
                ha="center",
                va="center",
                fontsize=9,
                color="white" if share < 0.62 else "black",
                path_effects=[withStroke(linewidth=2.5, foreground=colors(share))],  # over the contours
            )
