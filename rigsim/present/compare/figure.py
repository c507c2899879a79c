"""A comparison as one figure for print: geometries side by side, what is compared below each other."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullLocator

from rigsim.present.kit import style
from rigsim.present.kit.format import plain
from rigsim.rig.arrays import Array
from rigsim.study.compare import columns as col
from rigsim.study.compare.run import ComparisonResult

WIDTH_IN = 180 / 25.4
"""Width of a figure over both columns of a paper."""
PNG_DPI = 300

_MOST_COLUMNS = 6
_WIDEST_IN = 1.9
_LEFT, _RIGHT, _GAP = 0.82, 0.08, 0.1
_TITLE, _BETWEEN, _FOOT = 0.22, 0.1, 0.42
_ERROR, _BIAS, _FAILED, _SPEED = 1.35, 1.2, 0.72, 0.72
_BLOCK = _TITLE + _ERROR + _BIAS + _FAILED + 2 * _BETWEEN + _FOOT + _SPEED + 0.2
_LEGEND_LINE, _LEGEND_WORD = 0.17, 0.42
_TICK, _LABEL = 7.5, 8.0
_LETTER_IN = 0.063
_LONGEST = 34
_DODGE, _MOST_DODGE = 1.09, 1.2  # from method to method, and of the outermost
_ASIDE = 1.35  # of the noise axis, beyond its levels
_TWO_SIDED = 1.96  # standard errors of 95 %
_DASHES: tuple[Any, ...] = (
    "-",
    (0, (5, 2)),
    (0, (1, 1.3)),
    (0, (5, 1.5, 1, 1.5)),
    (0, (8, 2)),
    (0, (2, 2)),
)


@dataclass(frozen=True, slots=True)
class _Style:
    """How one method is drawn: its colour, mark and line each tell it from the others."""

    color: str
    marker: str
    line: Any
    hollow: bool

    def marks(self) -> dict[str, Any]:
        """Properties of its lines and marks."""
        return {
            "color": self.color,
            "marker": self.marker,
            "linestyle": self.line,
            "linewidth": 1.1,
            "markersize": 3.8,
            "markerfacecolor": "white" if self.hollow else self.color,
            "markeredgecolor": self.color if self.hollow else "white",
            "markeredgewidth": 0.9 if self.hollow else 0.4,
        }


def comparison_figure(result: ComparisonResult) -> Figure:
    """Pixel error, depth bias and lost points against noise, and speed; a column a geometry."""
    rows = result.rows
    names = [geometry.name for geometry in result.plan.chosen()]
    names = [name for name in names if (rows[col.GEOMETRY] == name).any()]
    looks = {label: _look(place) for place, label in enumerate(result.triangulators)}
    blocks = [names[i : i + _MOST_COLUMNS] for i in range(0, len(names), _MOST_COLUMNS)]
    columns = max((len(block) for block in blocks), default=1)
    width = min((WIDTH_IN - _LEFT - _RIGHT - (columns - 1) * _GAP) / columns, _WIDEST_IN)
    with style.styled():
        entries = _entries(looks)
        lines = _legend_lines(entries)
        head = lines * _LEGEND_LINE + 0.12
        figure = style.new_figure(WIDTH_IN, head + max(len(blocks), 1) * _BLOCK)
        height = float(figure.get_size_inches()[1])
        style.legend(figure, entries, 0.1, height - 0.06, columns=-(-len(entries) // lines))
        for text in figure.legends[0].get_texts():
            text.set_fontsize(_LABEL)
        for number, block in enumerate(blocks):
            top = height - head - number * _BLOCK
            for column, name in enumerate(block):
                left = _LEFT + column * (width + _GAP)
                _draw_geometry(figure, result, name, looks, (left, top, width), first=column == 0)
    return figure


def figure_png(figure: Figure) -> bytes:
    """The figure as PNG, fine enough for print."""
    return style.to_png(figure, dpi=PNG_DPI)


def figure_pdf(figure: Figure) -> bytes:
    """The figure as PDF, with its fonts in it; the same bytes for the same numbers."""
    import matplotlib

    buffer = io.BytesIO()
    with style.styled(), matplotlib.rc_context({"pdf.fonttype": 42}):
        figure.savefig(
            buffer, format="pdf", metadata={"CreationDate": None, "Producer": None, "Creator": None}
        )
    return buffer.getvalue()


def _look(place: int) -> _Style:
    n = len(style.LINES)
    return _Style(style.LINES[place % n], style.MARKERS[place % n], _DASHES[place % n], place // n % 2 == 1)


def _entries(looks: dict[str, _Style]) -> list[tuple[Artist, str]]:
    entries: list[tuple[Artist, str]] = [
        (Line2D([], [], **look.marks()), _short(label)) for label, look in looks.items()
    ]
    band = Patch(facecolor=style.LIGHT_GREY, edgecolor="none")
    must = Line2D([], [], color=style.GREY, linewidth=0.9)
    return [*entries, (must, "what noise alone does"), (band, "95 % at the bound")]


def _legend_lines(entries: list[tuple[Artist, str]]) -> int:
    """Lines the legend needs: its columns are as wide as their longest words."""
    for lines in range(1, len(entries) + 1):
        labels = [label for _, label in entries]
        columns = [labels[i : i + lines] for i in range(0, len(labels), lines)]
        width = sum(max(len(label) for label in column) * _LETTER_IN + _LEGEND_WORD for column in columns)
        if width <= WIDTH_IN - 0.2:
            return lines
    return len(entries)


def _short(label: str) -> str:
    return label if len(label) <= _LONGEST else "…" + label[-_LONGEST + 1 :]


def _draw_geometry(
    figure: Figure,
    result: ComparisonResult,
    name: str,
    looks: dict[str, _Style],
    where: tuple[float, float, float],
    *,
    first: bool,
) -> None:
    """One column; `where` is its left side, top and width, in."""
    left, top, width = where
    rows = result.rows
    part = rows[rows[col.GEOMETRY] == name]
    bottom = top - _TITLE
    panels: list[Axes] = []
    for height in (_ERROR, _BIAS, _FAILED):
        bottom -= height
        panels.append(style.place(figure, left, bottom, width, height))
        bottom -= _BETWEEN
    bottom -= _FOOT - _BETWEEN + _SPEED
    speed = style.place(figure, left, bottom, width, _SPEED)
    panels[0].set_title(name, fontsize=8.5, pad=4)
    _draw_errors(panels[0], rows, part, looks)
    _draw_biases(panels[1], rows, part, looks)
    _draw_failures(panels[2], rows, part, looks)
    _draw_speeds(speed, rows, part, looks)
    for axes in panels:
        _noise_axis(axes, result.plan.noises_px, width, labelled=axes is panels[-1])
    panels[-1].set_xlabel("noise, px", fontsize=_LABEL, labelpad=1)
    words = ("pixel error above\nthe bound, %", "depth bias, σ", "lost\npoints, %", "million\npoints / s")
    for axes, label in zip((*panels, speed), words, strict=True):
        axes.tick_params(labelsize=_TICK, length=2.5, pad=2)
        if first:
            axes.set_ylabel(label, fontsize=_LABEL)
            axes.yaxis.set_label_coords(-0.4 / width, 0.5)
        else:
            axes.tick_params(axis="y", labelleft=False)


def _draw_errors(axes: Axes, rows: pd.DataFrame, part: pd.DataFrame, looks: dict[str, _Style]) -> None:
    noise, half = _of_noise(part, col.BOUND_SE)
    reach = _wide(noise)
    half = 100 * _TWO_SIDED * np.interp(np.log(reach), np.log(noise), half)
    axes.fill_between(reach, -half, half, color=style.LIGHT_GREY, linewidth=0, zorder=1)
    axes.axhline(0, color=style.GREY, linewidth=0.9, zorder=1.5)
    for label, mine, x in _each(part, looks):
        y = 100 * (mine[col.PIXEL_ERROR_OVER_BOUND].to_numpy() - 1)
        _curve(axes, x, y, 100 * mine[col.PIXEL_ERROR_OVER_BOUND_SE].to_numpy(), looks[label])
    _signed_axis(axes, 100 * (rows[col.PIXEL_ERROR_OVER_BOUND].to_numpy() - 1), linear=2.0)


def _draw_biases(axes: Axes, rows: pd.DataFrame, part: pd.DataFrame, looks: dict[str, _Style]) -> None:
    noise, must = _of_noise(part, col.EXPECTED_DEPTH_BIAS)
    axes.plot(noise, must, color=style.GREY, linewidth=0.9, zorder=1.5)
    for label, mine, x in _each(part, looks):
        se = mine[col.DEPTH_BIAS_SE].to_numpy()
        _curve(axes, x, mine[col.DEPTH_BIAS].to_numpy(), se, looks[label])
    _signed_axis(axes, rows[col.DEPTH_BIAS].to_numpy(), linear=0.1)


def _draw_failures(axes: Axes, rows: pd.DataFrame, part: pd.DataFrame, looks: dict[str, _Style]) -> None:
    noise, must = _of_noise(part, col.EXPECTED_FAILED_SHARE)
    axes.plot(noise, 100 * must, color=style.GREY, linewidth=0.9, zorder=1.5)
    for label, mine, x in _each(part, looks):
        share = mine[col.FAILED_SHARE].to_numpy()
        se = np.sqrt(share * (1 - share) / mine[col.N].to_numpy())
        _curve(axes, x, 100 * share, 100 * se, looks[label])
    most = 100 * float(np.nanmax(rows[[col.FAILED_SHARE, col.EXPECTED_FAILED_SHARE]].to_numpy()))
    style.plain_axis(axes, "y", -0.06 * max(most, 1), 1.1 * max(most, 1), "linear", 4)


def _draw_speeds(axes: Axes, rows: pd.DataFrame, part: pd.DataFrame, looks: dict[str, _Style]) -> None:
    """A bar a method with its mark on top, on a scale that all geometries share."""
    speeds = rows[col.POINTS_PER_SECOND].to_numpy() / 1e6
    speeds = speeds[np.isfinite(speeds) & (speeds > 0)]
    low, high = (float(speeds.min()), float(speeds.max())) if len(speeds) else (0.1, 1.0)
    low, high = 10 ** np.floor(np.log10(low) - 0.15), high * 3
    axes.set_yscale("log")
    for place, (label, look) in enumerate(looks.items()):
        mine = part[part[col.TRIANGULATOR] == label]
        if len(mine) and mine[col.POINTS_PER_SECOND].iloc[0] > 0:
            value = mine[col.POINTS_PER_SECOND].iloc[0] / 1e6
            axes.bar(place, value - low, 0.5, bottom=low, color=look.color, alpha=0.45, linewidth=0)
            axes.plot([place], [value], **{**look.marks(), "linestyle": "none"})
    axes.set_xlim(-0.7, len(looks) - 0.3)
    axes.set_xticks([])
    axes.grid(visible=False, axis="x")
    axes.set_ylim(low, high)
    axes.yaxis.set_major_locator(LogLocator(base=100 if high / low > 1e3 else 10, numticks=6))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: plain(value, 1)))


def _of_noise(part: pd.DataFrame, column: str) -> tuple[Array, Array]:
    """Noise levels and a column that says the same for all methods, or nearly so."""
    found = part.groupby(col.NOISE)[column].first()
    return found.index.to_numpy(dtype=np.float64), found.to_numpy(dtype=np.float64)


def _each(part: pd.DataFrame, looks: dict[str, _Style]) -> list[tuple[str, pd.DataFrame, Array]]:
    """Each method's rows by noise, and their places: a little apart, so that none hides another."""
    found = []
    middle = (len(looks) - 1) / 2
    step = min(_DODGE, _MOST_DODGE ** (1 / max(middle, 1)))
    for place, label in enumerate(looks):
        mine = part[part[col.TRIANGULATOR] == label].sort_values(col.NOISE)
        aside = step ** (place - middle)
        if len(mine):
            found.append((label, mine, mine[col.NOISE].to_numpy(dtype=np.float64) * aside))
    return found


def _curve(axes: Axes, x: Array, y: Array, se: Array, look: _Style) -> None:
    axes.errorbar(
        x, y, yerr=_TWO_SIDED * np.nan_to_num(se), elinewidth=0.7, capsize=0, zorder=3, **look.marks()
    )


def _wide(noise: Array) -> Array:
    """Noise levels and the axis' own ends."""
    return np.concatenate([[noise.min() / 1.5], noise, [noise.max() * 1.5]])


def _noise_axis(axes: Axes, noises_px: tuple[float, ...], width_in: float, *, labelled: bool) -> None:
    noises = sorted(noises_px)
    axes.set_xscale("log")
    axes.set_xlim(noises[0] / _ASIDE, noises[-1] * _ASIDE)
    kept: list[float] = []
    span = np.log(noises[-1] / noises[0]) + 2 * np.log(_ASIDE)
    for tick in (noises[0], noises[-1], noises[len(noises) // 2]):
        # labels that touch cannot be read
        letters = [(len(plain(tick, 3)) + len(plain(other, 3))) / 2 + 1 for other in kept]
        apart_in = [abs(np.log(tick / other)) / span * width_in for other in kept]
        if all(there >= _LETTER_IN * n for there, n in zip(apart_in, letters, strict=True)):
            kept.append(tick)
    axes.xaxis.set_major_locator(FixedLocator(kept))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: plain(value, 3)))
    axes.tick_params(axis="x", labelbottom=labelled)


def _signed_axis(axes: Axes, values: Array, linear: float) -> None:
    """Linear around 0, logarithmic farther off; plain where nothing is far off."""
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 0.0)
    low, high = min(low, -0.75 * linear), max(high, 0.75 * linear)
    if max(-low, high) <= 2 * linear:
        style.plain_axis(axes, "y", 1.15 * low, 1.15 * high, "linear", 5)
        return
    axes.set_yscale("symlog", linthresh=linear, linscale=1.0)
    axes.set_ylim(low * (1.15 if low > -linear else 1.8), high * (1.15 if high < linear else 1.8))
    one = 10.0 ** np.floor(np.log10(linear))
    decades = [one * 10.0**k for k in range(8)]
    ticks = (
        [-tick for tick in decades if tick < -1.6 * low]
        + [0.0]
        + [tick for tick in decades if tick < 1.6 * high]
    )
    axes.yaxis.set_major_locator(FixedLocator(sorted(ticks)))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: plain(value, 3)))
