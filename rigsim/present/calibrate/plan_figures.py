"""How a planned calibration's depth error follows the number of pictures, as a figure."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from rigsim.present.calibrate.words import board_words
from rigsim.present.kit.format import number, plain
from rigsim.rig.arrays import Array
from rigsim.study.calibrate.enough import chosen_depth
from rigsim.study.calibrate.plan.result import CalibrationPlan

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.figure import Figure

_HEIGHT_IN = 3.4


def curve_figure(plan: CalibrationPlan) -> Figure:
    """Depth std against the number of pictures: chosen poses, poses at random, with pixel noise, the goal."""
    from rigsim.present.kit import style

    asked, noise_mm = plan.asked, chosen_depth(plan).observation_m * 1e3
    with style.styled():
        figure = style.new_figure(style.PAGE_WIDTH_IN, _HEIGHT_IN)
        axes = style.place(figure, 0.75, 0.55, 4.0, _HEIGHT_IN - 0.95)
        entries: list[tuple[Artist, str]] = []
        for values_mm, label, color, mark in _curves(plan):
            known = np.isfinite(values_mm)
            pictures = np.array([point.pictures for point in plan.curve], dtype=np.float64)[known]
            (line,) = axes.plot(pictures, values_mm[known], color=color, marker=mark, markersize=3)
            entries.append((line, label))
        noise = axes.axhline(noise_mm, color=style.GREY, linestyle=":")
        entries.append((noise, f"pixel noise alone: {number(noise_mm)} mm"))
        if asked.goal is not None:
            goal_mm = asked.goal.error_m * 1e3
            goal = axes.axhline(goal_mm, color=style.GREEN, linestyle="--")
            entries.append((goal, f"asked for: {plain(goal_mm)} mm"))
            if plan.needed.count is not None:
                enough = axes.axvline(plan.needed.count, color=style.GREEN, linewidth=0.9)
                entries.append((enough, f"enough: {plan.needed.count} pictures"))
        last = plan.curve[-1].pictures
        style.plain_axis(axes, "x", plan.curve[0].pictures * 0.95, last * 1.05, style.scale_of([2, last]))
        style.plain_axis(axes, "y", *_range_mm(plan), "log")
        axes.set_xlabel("pictures by each camera")
        axes.set_ylabel(f"depth std at {plain(asked.chosen_for_m)} m, mm")
        axes.set_title(f"How many pictures of the {board_words(asked.board)}", pad=8)
        style.legend(figure, entries, 4.95, _HEIGHT_IN - 0.5)
    return figure


def _curves(plan: CalibrationPlan) -> list[tuple[Array, str, str, str]]:
    """Values, mm, label, colour and mark of each curve."""
    from rigsim.present.kit import style

    joint, calibration, random = (
        np.array([getattr(point, name) for point in plan.curve]) * 1e3
        for name in ("joint_m", "calibration_m", "random_m")
    )
    chosen = isinstance(plan.asked.poses, int)
    curves = [
        (joint, "with pixel noise", style.BLACK, "^"),
        (random, "calibration, poses at random", style.ORANGE, "s"),
        (calibration, "calibration, these poses", style.BLUE, "o"),
    ]
    return curves if chosen else [curves[0], curves[2]]


def _range_mm(plan: CalibrationPlan) -> tuple[float, float]:
    values = [value for p in plan.curve for value in (p.calibration_m, p.joint_m, p.random_m)]
    values.append(chosen_depth(plan).observation_m)
    if plan.asked.goal is not None:
        values.append(plan.asked.goal.error_m)
    known = [value * 1e3 for value in values if math.isfinite(value) and value > 0]
    # what the first few pictures leave open must not hide the rest
    high = min(max(known), 100 * float(np.median(known)))
    return min(known) * 0.8, high * 1.3
