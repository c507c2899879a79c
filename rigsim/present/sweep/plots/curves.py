"""Depth error against what was swept and against depth: predicted, simulated and, where known, measured."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass

import pandas as pd
from matplotlib.figure import Figure

from rigsim.present.kit import style
from rigsim.present.sweep.measured_words import was_measured
from rigsim.present.sweep.plots.axes import PlotAxis, best_row, held_words, slice_along, swept_axes
from rigsim.present.sweep.plots.chart import DEPTH, PANEL_WIDTH, RATIO_BOTTOM, SIDE, draw_chart, panel_height
from rigsim.present.sweep.plots.heatmap import draw_heat_map, heat_map_axes
from rigsim.present.sweep.same import at_same_distances, same_words
from rigsim.study.scene import columns as col
from rigsim.study.sweep.result import SweepResult

HEAT_HEIGHT = 4.35
"""Height of a heat map with its labels, in."""


@dataclass(frozen=True, slots=True)
class Panel:
    """One plot of the report."""

    name: str
    """Short name, unique in a report."""
    title: str
    """What it shows, in words."""
    note: str
    """What was held or left out, in words; "" when nothing was."""
    kind: str
    """"axis", "depth" or "heat"."""
    axes: tuple[PlotAxis, ...]
    """Axes of the sweep drawn along the page (and up it, for a heat map)."""


def panels(result: SweepResult) -> list[Panel]:
    """The plots that suit a sweep: one an axis, one against depth, a heat map for two numeric axes."""
    axes, same = swept_axes(result), same_words(result)
    found = [
        Panel(
            f"axis-{axis.column.replace('_', '-')}",
            f"Depth error against {axis.heading}",
            _joined(same, slice_along(result, axis, axes).note, _noise_note(result, axis)),
            "axis",
            (axis,),
        )
        for axis in axes
    ]
    if len(result.by_depth):
        note = slice_along(result, DEPTH, axes).note
        found.append(Panel("depth", "Depth error against depth", note, "depth", (DEPTH,)))
    pair = heat_map_axes(axes)
    if pair is not None:
        held = [axis for axis in axes if axis not in pair]
        best = best_row(result)
        note = _joined(same, *(held_words(axis, best[axis.column]) for axis in held))
        title = f"Depth error against {pair[0].heading} and {pair[1].heading}"
        found.append(Panel("heat", title, note, "heat", pair))
    return found


def panel_figure(result: SweepResult, panel: Panel) -> Figure:
    """One panel on its own page."""
    with style.styled():
        figure = style.new_figure(PANEL_WIDTH, _height(result, panel))
        _draw_panel(figure, result, panel, 0.0, 0.0)
    return figure


def depth_error_figure(result: SweepResult) -> Figure:
    """The panels that say most, on one page: the first axis, depth and, for two axes, the heat map."""
    every = panels(result)
    along = [panel for panel in every if panel.kind == "axis"]
    heat = [panel for panel in every if panel.kind == "heat"]
    chosen = along[:1] + [panel for panel in every if panel.kind == "depth"] + heat
    if heat:
        chosen += along[1:2]
    columns = min(len(chosen), 2) or 1
    lines = -(-len(chosen) // columns) or 1
    height = max((_height(result, panel) for panel in chosen), default=HEAT_HEIGHT)
    with style.styled():
        figure = style.new_figure(columns * PANEL_WIDTH, lines * height + 0.1)
        for i, panel in enumerate(chosen):
            x = (i % columns) * PANEL_WIDTH
            top = (lines - i // columns) * height
            _draw_panel(figure, result, panel, x, top - _height(result, panel))
    return figure


def _noise_note(result: SweepResult, axis: PlotAxis) -> str:
    """Where the measured marks stand along an axis of noise, which no picture knows."""
    if axis.column != col.NOISE or not was_measured(result.rows):
        return ""
    return "diamonds stand at the noise they correspond to"


def _joined(*notes: str) -> str:
    return "; ".join(note for note in notes if note)


def _draw_panel(figure: Figure, result: SweepResult, panel: Panel, x: float, y: float) -> None:
    """Draw a panel whose lower left corner stands at (x, y) inches."""
    if panel.kind == "heat":
        frame = (x + 1.25, y + 0.62, 4.0, HEAT_HEIGHT - 1.05)
        draw_heat_map(figure, frame, result, panel.axes[0], panel.axes[1], panel.title)
        _write_note(figure, panel.note, x + 6.12, y + 0.62, 13)
        return
    cut = slice_along(result, panel.axes[0], swept_axes(result))
    draw_chart(figure, x, y, panel.title, cut, _table(result, panel))
    _write_note(figure, panel.note, x + SIDE + 0.03, y + RATIO_BOTTOM, 22)


def _table(result: SweepResult, panel: Panel) -> pd.DataFrame:
    return result.by_depth if panel.kind == "depth" else at_same_distances(result)


def _height(result: SweepResult, panel: Panel) -> float:
    return HEAT_HEIGHT if panel.kind == "heat" else panel_height(_table(result, panel))


def _write_note(figure: Figure, note: str, x: float, y: float, columns: int) -> None:
    if note:
        width, height = figure.get_size_inches()
        text = "\n".join(textwrap.wrap(note[0].upper() + note[1:] + ".", columns))
        figure.text(x / width, y / height, text, fontsize=9, color=style.GREY, va="bottom", linespacing=1.25)
