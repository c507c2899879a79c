"""Where the board is held, as figures: each pose in both pictures, numbered."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rigsim.present.calibrate.board_shapes import shape
from rigsim.present.calibrate.words import distance_words
from rigsim.study.calibrate.holding import holdings
from rigsim.study.calibrate.plan.result import CalibrationPlan

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_ACROSS = 4
_MOST = 60
_LEFT_IN, _TOP_IN, _GAP_IN, _LINE_IN, _NARROW_IN = 0.1, 0.62, 0.16, 0.24, 0.03


def poses_figure(plan: CalibrationPlan) -> Figure:
    """Both cameras' views of the board in each pose: what the pictures will look like."""
    from rigsim.present.kit import style

    count = min(len(plan.poses), _MOST)
    camera = plan.asked.rig.left
    pair = (style.PAGE_WIDTH_IN - 2 * _LEFT_IN - (_ACROSS - 1) * _GAP_IN) / _ACROSS
    width = (pair - _NARROW_IN) / 2
    height = width * camera.height / camera.width
    lines = -(-count // _ACROSS)
    page = _TOP_IN + lines * (height + _LINE_IN) + 0.1
    held = holdings(plan.asked.rig, plan.asked.board, plan.poses, plan.seen)
    with style.styled():
        figure = style.new_figure(style.PAGE_WIDTH_IN, page)
        more = f" (the first {count} of {len(plan.poses)})" if count < len(plan.poses) else ""
        for text, down, weight in (
            (f"Where the board is held{more}: left and right picture of each", 0.1, "bold"),
            (
                "Blue: what the left camera sees; orange: the right. Distances are to the board's middle.",
                0.31,
                "normal",
            ),
        ):
            x, y = _LEFT_IN / style.PAGE_WIDTH_IN, 1 - down / page
            figure.text(x, y, text, weight=weight, fontsize=10.5 if weight == "bold" else 9, va="top")
        for which in range(count):
            row, column = divmod(which, _ACROSS)
            left = _LEFT_IN + column * (pair + _GAP_IN)
            bottom = page - _TOP_IN - height - row * (height + _LINE_IN)
            for side in (0, 1):
                axes = style.place(figure, left + side * (width + _NARROW_IN), bottom, width, height)
                _draw(axes, plan, side, which)
                if side == 0:
                    says = f"{which + 1}   {distance_words(held[which].distance_m)}"
                    axes.set_title(says, fontsize=8.5, pad=2)
    return figure


def _draw(axes: Axes, plan: CalibrationPlan, side: int, which: int) -> None:
    from matplotlib.collections import PolyCollection

    from rigsim.present.kit import style

    rig = plan.asked.rig
    camera = (rig.left, rig.right)[side]
    found = shape(rig, side, plan.asked.board, plan.poses, which)
    color = (style.LEFT, style.RIGHT)[side] if plan.seen[which, side] else style.GREY
    if len(found.rim) > 2:
        rim = PolyCollection([found.rim], facecolors="white", edgecolors=color, linewidths=1.0)
        axes.add_collection(rim, autolim=False)
        axes.add_collection(PolyCollection(list(found.dark), facecolors=color, linewidths=0), autolim=False)
    axes.set_xlim(-0.5, camera.width - 0.5)
    axes.set_ylim(camera.height - 0.5, -0.5)
    axes.set_facecolor("#EEF0F2")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.grid(visible=False)
    for name in ("top", "right"):
        axes.spines[name].set_visible(True)
    for spine in axes.spines.values():
        spine.set_linewidth(0.5)
    axes.set_clip_on(True)
    if not np.any(plan.seen[which, side]):
        axes.text(0.5, 0.5, "not whole", transform=axes.transAxes, ha="center", va="center", fontsize=7)
