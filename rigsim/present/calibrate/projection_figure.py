"""How sure a planned calibration leaves each pixel, as maps over both images."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rigsim.present.kit.format import number, plain
from rigsim.study.calibrate.plan.result import CalibrationPlan
from rigsim.study.calibrate.projection import FAR_M, ProjectionMap, projection_map

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh
    from matplotlib.figure import Figure

_LEFT_IN, _TOP_IN, _WIDTH_IN, _GAP_IN, _LINE_IN = 0.15, 0.95, 2.95, 0.2, 0.45


def projection_figure(plan: CalibrationPlan) -> Figure:
    """Std of a point's projection in its worst direction, over both images, as far away as poses are
    chosen for and infinitely far."""
    from rigsim.present.kit import style

    camera = plan.asked.rig.left
    height = _WIDTH_IN * camera.height / camera.width
    page = _TOP_IN + 2 * height + _LINE_IN + 0.15
    with style.styled():
        figure = style.new_figure(style.PAGE_WIDTH_IN, page)
        title = "How uncertain the calibration leaves each place in the pictures"
        note = "Standard deviation in the worst direction, px, of points that stand still among the boards."
        for text, down, weight in ((title, 0.12, "bold"), (note, 0.34, "normal")):
            x, y = _LEFT_IN / style.PAGE_WIDTH_IN, 1 - down / page
            figure.text(x, y, text, weight=weight, fontsize=10.5 if weight == "bold" else 9, va="top")
        for line, z_m in enumerate((plan.asked.chosen_for_m, FAR_M)):
            maps = [projection_map(plan.covariance, side, z_m) for side in (0, 1)]
            both = np.concatenate([found.std_px.ravel() for found in maps])
            ends = float(np.nanmin(both)), float(np.nanmax(both))
            bottom = page - _TOP_IN - height - line * (height + _LINE_IN)
            for side, found in enumerate(maps):
                axes = style.place(figure, _LEFT_IN + side * (_WIDTH_IN + _GAP_IN), bottom, _WIDTH_IN, height)
                mesh = _draw(axes, found, ends)
                where = "infinitely far away" if z_m == FAR_M else f"{plain(z_m)} m away"
                axes.set_title(f"{('left', 'right')[side]} image, {where}", fontsize=9, pad=3)
            bar_axes = style.place(figure, _LEFT_IN + 2 * _WIDTH_IN + _GAP_IN + 0.08, bottom, 0.1, height)
            middle = float(np.sqrt(ends[0] * ends[1]))
            bar = figure.colorbar(mesh, cax=bar_axes)
            bar.set_ticks(
                [ends[0], middle, ends[1]], labels=[number(x, 2) for x in (ends[0], middle, ends[1])]
            )
            bar.ax.minorticks_off()
            bar.ax.tick_params(labelsize=8)
            bar.ax.grid(visible=False)
    return figure


def _draw(axes: Axes, found: ProjectionMap, ends: tuple[float, float]) -> QuadMesh:
    from matplotlib.colors import LogNorm

    from rigsim.present.kit import style

    mesh = axes.pcolormesh(
        *(found.u_px, found.v_px, np.ma.masked_invalid(found.std_px)),
        cmap=style.heat_map(),
        norm=LogNorm(ends[0], max(ends[1], ends[0] * 1.001)),
        rasterized=True,
    )
    style.show_as_picture(axes)
    return mesh
