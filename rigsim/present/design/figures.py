"""Plots of a design: the feasible region, the Pareto front, and the pick from above."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal, TypeAlias

import numpy as np
from matplotlib.artist import Artist
from matplotlib.collections import QuadMesh
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from rigsim.present.kit import style
from rigsim.present.kit.format import plain
from rigsim.present.kit.lines.line_labels import Named, label_lines
from rigsim.present.kit.topdown import topdown_figure
from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.study.design import words as words
from rigsim.study.design.proof import Proof
from rigsim.study.design.region import limit_lines
from rigsim.study.design.solve import Candidate, Design, Specification
from rigsim.theory.inverse import Camera, baseline_interval
from rigsim.theory.inverse_error import noise_error

_LEFT, _BOTTOM, _WIDTH, _HEIGHT = 0.75, 0.6, 4.2, 3.5
Dash: TypeAlias = Literal["-", "--", "-.", ":"]
"""How a line is drawn."""
_DASHES: tuple[Dash, ...] = ("-", "--", "-.", ":")
_REGION_WIDTH, _REGION_HEIGHT = 5.4, 4.4
_SPAN = 2.0  # the region is drawn for focal lengths within this factor of the pick's


def region_figure(design: Design, pick: Candidate) -> Figure:
    """Baselines against focal lengths for the pick's image size, with each requirement's line."""
    spec, chip = design.specification, pick.camera
    f = np.geomspace(chip.focal_px / _SPAN, chip.focal_px * _SPAN, 241)
    cameras = [replace(chip, focal_px=float(focal)) for focal in f]
    intervals = [baseline_interval(camera, spec.requirements, spec.noise_px) for camera in cameras]
    low_mm = pick.interval.lower.baseline_m * 1e3 / 2.5
    high_mm = max(pick.interval.upper.baseline_m, pick.baseline_m) * 1e3 * 2.5
    B = np.geomspace(low_mm, high_mm, 241)
    share = spec.far_m * spec.disparity_std_px / (f[None, :] * B[:, None] / 1e3)
    error = spec.far_m * np.vectorize(noise_error, otypes=[float])(share) * 1e3
    allowed = np.array(
        [
            (not i.failed) & (i.lower.baseline_m * 1e3 <= B) & (i.upper.baseline_m * 1e3 >= B)
            for i in intervals
        ]
    ).T
    with style.styled():
        figure = style.new_figure(style.PAGE_WIDTH_IN, _BOTTOM + _REGION_HEIGHT + 0.35)
        axes = style.place(figure, _LEFT, _BOTTOM, _REGION_WIDTH, _REGION_HEIGHT)
        axes.grid(False)
        axes.set_title(f"Feasible rigs with {chip.width_px}x{chip.height_px} px", pad=8)
        shown = np.ma.masked_where(~allowed, error)
        norm = LogNorm(*_ends(np.asarray(error[allowed]) if allowed.any() else error))
        mesh = axes.pcolormesh(
            f, B, shown, cmap=style.heat_map(), norm=norm, shading="nearest", rasterized=True
        )
        _region_bar(figure, mesh, _ends(error[allowed]))
        lines = _limit_lines(spec, f, chip, (low_mm, high_mm))
        for line, dash in lines:
            axes.plot(line.x, line.y, color=line.color, linestyle=dash)
        star = (chip.focal_px, pick.baseline_m * 1e3)
        axes.plot(*star, **_STAR)
        axes.annotate(
            "recommended",
            star,
            (9, -3),
            textcoords="offset points",
            ha="left",
            va="top",
            path_effects=style.HALO,
            zorder=8,
        )
        style.plain_axis(axes, "x", float(f[0]), float(f[-1]), "log")
        style.plain_axis(axes, "y", low_mm, high_mm, "log", 8)
        axes.set_xlabel("focal length, px", labelpad=2)
        axes.set_ylabel("baseline, mm")
        beside = float(star[0] * (f[-1] / f[0]) ** 0.08), float(star[1] * (high_mm / low_mm) ** -0.03)
        shaded = np.column_stack([part[allowed][::7] for part in np.meshgrid(f, B)])
        label_lines(axes, [line for line, _ in lines], (star, beside), shaded)
    return figure


def _region_bar(figure: Figure, mesh: QuadMesh, ends: tuple[float, float]) -> None:
    axes = style.place(figure, _LEFT + _REGION_WIDTH + 0.12, _BOTTOM, 0.13, 1.8)
    bar = figure.colorbar(mesh, cax=axes)
    bar.set_label("depth error at\nthe far end, mm")
    axes.grid(False)
    ticks = style.nice_levels(*ends)
    if len(ticks) < 3:
        ticks = list(MaxNLocator(4, steps=[1, 2, 2.5, 5, 10]).tick_values(*ends))
    axes.yaxis.set_major_locator(FixedLocator([t for t in ticks if ends[0] <= t <= ends[1]]))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: plain(value, 4)))


def _limit_lines(
    spec: Specification, focal_px: Array, chip: Camera, span_mm: tuple[float, float]
) -> list[tuple[Named, Dash]]:
    """Each requirement's line over focal lengths, where it lies within the figure, and its dashes."""
    lines: list[tuple[Named, Dash]] = []
    for limit in limit_lines(spec, chip, focal_px, (span_mm[0] / 1e3, span_mm[1] / 1e3)):
        color, dash = style.LINES[limit.place % len(style.LINES)], _DASHES[limit.place % len(_DASHES)]
        name = words.whole(limit.requirement).replace("<=", "≤").replace(">=", "≥")
        lines.append((Named(limit.focal_px, limit.baseline_m * 1e3, name, color), dash))
    return lines


def pareto_figure(design: Design, pick: Candidate) -> Figure:
    """Depth error at the far end against baseline; colour is the field of view, size the pixels."""
    with style.styled():
        figure = style.new_figure(style.PAGE_WIDTH_IN, _BOTTOM + _HEIGHT + 0.35)
        axes = style.place(figure, _LEFT, _BOTTOM, _WIDTH, _HEIGHT)
        axes.set_title("Trade-offs between feasible rigs", pad=8)
        beaten = [c for c in design.candidates if c not in design.pareto]
        for candidates, filled in ((beaten, False), (design.pareto, True)):
            if candidates:
                x = [c.baseline_m * 1e3 for c in candidates]
                y = [c.far_error_m * 1e3 for c in candidates]
                sizes = [14 + 22 * c.camera.pixels / 1e6 for c in candidates]
                if filled:
                    color = [math.degrees(c.camera.hfov_rad) for c in candidates]
                    marks = axes.scatter(
                        x,
                        y,
                        s=sizes,
                        c=color,
                        cmap=style.heat_map(),
                        edgecolors="white",
                        linewidths=0.6,
                        zorder=3,
                    )
                else:
                    axes.scatter(x, y, s=sizes, facecolors="none", edgecolors=style.GREY, zorder=2)
        axes.plot(pick.baseline_m * 1e3, pick.far_error_m * 1e3, **_STAR)
        bar_axes = style.place(figure, _LEFT + _WIDTH + 0.12, _BOTTOM, 0.13, 1.5)
        figure.colorbar(marks, cax=bar_axes).set_label("field of view, °")
        bar_axes.grid(False)
        b = np.array([c.baseline_m * 1e3 for c in design.candidates])
        e = np.array([c.far_error_m * 1e3 for c in design.candidates])
        spans: tuple[tuple[Literal["x", "y"], Array], ...] = (("x", b), ("y", e))
        for which, values in spans:
            low, high = float(values.min()) / 1.15, float(values.max()) * 1.15
            style.plain_axis(axes, which, low, high, style.scale_of(values, 4))
        axes.set_xlabel("baseline, mm", labelpad=2)
        axes.set_ylabel("depth error at the far end, mm")
        entries: list[tuple[Artist, str]] = [
            (Line2D([], [], linestyle="", **_STAR), "recommended"),
            (Line2D([], [], linestyle="", marker="o", color=style.BLUE), "Pareto-optimal"),
            (
                Line2D([], [], linestyle="", marker="o", markerfacecolor="none", markeredgecolor=style.GREY),
                "feasible, beaten",
            ),
            *(
                (
                    Line2D([], [], linestyle="", marker="o", color=style.LIGHT_GREY, markersize=size**0.5),
                    f"{mp} MP",
                )
                for mp, size in ((1, 36), (5, 124))
            ),
        ]
        style.legend(figure, entries, _LEFT + _WIDTH + 0.12, _BOTTOM + _HEIGHT)
    return figure


def plan_figure(design: Design, pick: Candidate, proofs: Sequence[Proof]) -> Figure:
    """The pick from above, with the points of its proof, the working range, and the required coverage."""
    spec = design.specification
    show = next((p.show for p in proofs if p.candidate == pick), None)
    if show is not None:
        # one point more, at the far end: the scene may end before it
        end = np.array([[pick.baseline_m / 2, 0.0, spec.far_m]])
        figure = topdown_figure(
            show.rig,
            np.concatenate([show.points_left, end]),
            visible=np.append(show.visible, True),
            depth_error_m=np.append(show.depth_rmse_m, pick.far_error_m),
            noise=show.noise,
        )
    else:
        ends = [[pick.baseline_m / 2, 0.0, spec.near_m], [pick.baseline_m / 2, 0.0, spec.far_m]]
        figure = topdown_figure(pick.rig, ends, noise=PixelNoise(spec.noise_px))
    axes = figure.axes[0]
    for depth_m, name in ((spec.near_m, "near end"), (spec.far_m, "far end")):
        axes.axhline(depth_m, color=style.PURPLE, linestyle="--", linewidth=1.2, zorder=4)
        x_low, x_high = axes.get_xlim()
        axes.text(
            x_low + 0.015 * (x_high - x_low),
            depth_m,
            name,
            color=style.PURPLE,
            fontsize=9,
            va="bottom" if depth_m == spec.near_m else "top",
            path_effects=style.HALO,
            zorder=6,
        )
    for asked in spec.requirements:
        if asked.kind == "cover":
            half = asked.limit / 2
            axes.plot([-half, half], [asked.depth_m] * 2, color=style.ORANGE, linewidth=4, zorder=5)
            axes.text(
                0.0,
                asked.depth_m,
                "required coverage",
                color=style.INK,
                fontsize=9,
                ha="center",
                va="top",
                path_effects=style.HALO,
                zorder=6,
            )
    return figure


_STAR: dict[str, Any] = {
    "marker": "*",
    "markersize": 15,
    "color": style.ORANGE,
    "markeredgecolor": style.INK,
    "zorder": 7,
}


def _ends(values: np.typing.NDArray[np.float64]) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    return (low, high) if high > 1.001 * low else (0.9 * low, 1.1 * high)
