"""Where in the image each quantity of a tolerance study does its harm: one map each."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rigsim.present.kit.format import number, plain
from rigsim.rig.arrays import Array
from rigsim.study.tolerance.joint.cause import CALIBRATION
from rigsim.study.tolerance.places import Places, places
from rigsim.study.tolerance.run import ToleranceResult
from rigsim.study.tolerance.sensitivities import QUANTITIES, UNITS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_ACROSS = 3
_LEFT_IN, _TOP_IN, _BOTTOM_IN = 0.15, 0.98, 0.15
_WIDTH_IN, _STEP_X_IN, _GAP_Y_IN = 1.6, 2.35, 0.62
_FLAT = 0.02


def places_png(result: ToleranceResult) -> bytes:
    """PNG of `places_figure`."""
    from rigsim.present.kit import style

    return style.to_png(places_figure(result))


def places_figure(result: ToleranceResult) -> Figure:
    """Maps of the depth error over the left image: the worst quantities alone, then all together."""
    from rigsim.present.kit import style

    found = places(result)
    panels = [
        (f"{QUANTITIES.get(key, key)}\n{_off_by(result, key)}", found.alone_mm[place])
        for place, key in enumerate(found.keys)
    ]
    panels.append(("all together\nroot mean square", found.together_mm))
    lens = result.rig.left
    height_in = _WIDTH_IN * lens.height / lens.width
    lines = -(-len(panels) // _ACROSS)
    page_in = _TOP_IN + lines * height_in + (lines - 1) * _GAP_Y_IN + _BOTTOM_IN
    with style.styled():
        figure = style.new_figure(style.PAGE_WIDTH_IN, page_in)
        figure.text(
            _LEFT_IN / style.PAGE_WIDTH_IN,
            1 - 0.12 / page_in,
            f"Depth error over the left image at {plain(result.required.depth_m)} m, mm",
            weight="bold",
            fontsize=10.5,
            va="top",
        )
        figure.text(
            _LEFT_IN / style.PAGE_WIDTH_IN,
            1 - 0.33 / page_in,
            "Every map has its own scale; grey is what the right camera does not see.",
            fontsize=9,
            va="top",
        )
        for place, (title, values) in enumerate(panels):
            row, column = divmod(place, _ACROSS)
            left = _LEFT_IN + column * _STEP_X_IN
            bottom = page_in - _TOP_IN - height_in - row * (height_in + _GAP_Y_IN)
            _draw(figure, (left, bottom, _WIDTH_IN, height_in), title, values, found)
    return figure


def _draw(
    figure: Figure, frame: tuple[float, float, float, float], title: str, values: Array, found: Places
) -> None:
    from rigsim.present.kit import style

    left, bottom, width, height = frame
    axes = style.place(figure, left, bottom, width, height)
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    # a map of one colour is one: no range is made up from rounding
    widest = max(abs(low), abs(high))
    if high - low < _FLAT * widest:
        low, high = (low + high - _FLAT * widest) / 2, (low + high + _FLAT * widest) / 2
    mesh = axes.pcolormesh(
        found.u_px,
        found.v_px,
        np.ma.masked_invalid(values),
        cmap=style.heat_map(),
        vmin=low,
        vmax=high,
        rasterized=True,
    )
    style.show_as_picture(axes)
    axes.set_title(title, fontsize=9, pad=3, linespacing=1.15)
    bar_axes = style.place(figure, left + width + 0.06, bottom, 0.09, height)
    bar = figure.colorbar(mesh, cax=bar_axes, ticks=[low, high])
    bar.ax.set_yticklabels([number(value) for value in (low, high)], fontsize=8)
    bar.ax.grid(visible=False)


def _off_by(result: ToleranceResult, key: str) -> str:
    if key == CALIBRATION:
        return "standard deviation"
    return f"off by {number(result.tolerances.std(key))} {UNITS[key]}".rstrip()
