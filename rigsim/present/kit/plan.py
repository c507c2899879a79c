"""Pieces of a plan: a rig from above, drawn into axes in metres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.ticker import FuncFormatter, MaxNLocator

from rigsim.present.kit import style
from rigsim.present.kit.footprint import CameraView, Footprint
from rigsim.present.kit.format import length, plain
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig

BOTH = "#9AA7B0"
"""Colour of what both cameras see."""
_SIDE_LEFT, _SIDE_WIDTH = 5.85, 1.28


@dataclass(frozen=True, slots=True)
class Window:
    """What part of the plane is drawn, m."""

    x_low: float
    x_high: float
    z_low: float
    z_high: float

    @property
    def corners(self) -> Array:
        """Its corners (4, 2), m."""
        return np.array(
            [
                [self.x_low, self.z_low],
                [self.x_high, self.z_low],
                [self.x_high, self.z_high],
                [self.x_low, self.z_high],
            ]
        )


def fill(window: Window, aspect: float) -> Window:
    """Widen the window to the shape of the paper, so that a metre is as long across as along."""
    width, height = window.x_high - window.x_low, window.z_high - window.z_low
    if width < aspect * height:
        extra = (aspect * height - width) / 2
        return Window(window.x_low - extra, window.x_high + extra, window.z_low, window.z_high)
    return Window(window.x_low, window.x_high, window.z_low, window.z_low + width / aspect)


def draw_views(axes: Axes, view: Footprint, window: Window) -> None:
    """Both fields of view, what they share, and the blind zone between the cameras."""
    for camera, color in ((view.left, style.LEFT), (view.right, style.RIGHT)):
        seen = camera.clip(window.corners)
        if len(seen):
            axes.add_patch(Polygon(seen, facecolor=color, alpha=0.07, edgecolor="none", zorder=1))
        reach = 4 * float(np.ptp(window.corners, axis=0).max())
        for edge in (camera.left_edge, camera.right_edge):
            line = np.stack([camera.center, camera.center + reach * edge])
            axes.plot(
                line[:, 0], line[:, 1], color=color, linewidth=1.0, zorder=3, scalex=False, scaley=False
            )
    both = view.overlap(window.corners)
    if len(both):
        axes.add_patch(Polygon(both, facecolor=BOTH, alpha=0.2, edgecolor="none", zorder=1.5))
    if view.blind is not None:
        axes.add_patch(
            Polygon(
                view.blind, facecolor="white", edgecolor=style.GREY, hatch="/////", linewidth=0.6, zorder=2
            )
        )


def draw_cameras(axes: Axes, view: Footprint, size: float, baseline_m: float) -> None:
    """Bodies at the true centres, turned the true way; at least `size` (m) wide, so that they show."""
    size = max(size, 0.18 * baseline_m)
    for camera, color in ((view.left, style.LEFT), (view.right, style.RIGHT)):
        axes.add_patch(
            Polygon(_body(camera, size), facecolor=color, edgecolor="white", linewidth=0.5, zorder=6)
        )


def _body(camera: CameraView, size: float) -> Array:
    """Outline (N, 2) of a camera whose centre of projection is the middle of its front."""
    across = np.array([camera.axis[1], -camera.axis[0]])
    outline = np.array(
        [[-0.3, 0.0], [0.3, 0.0], [0.18, -0.3], [0.5, -0.3], [0.5, -1], [-0.5, -1], [-0.5, -0.3]]
    )
    outline = np.vstack([outline, [[-0.18, -0.3]]]) * size
    return np.asarray(camera.center + outline[:, :1] * across + outline[:, 1:] * camera.axis)


def draw_nearest(axes: Axes, view: Footprint) -> None:
    """The depth from which on both cameras see something."""
    if view.nearest is not None and view.nearest[1] > 0:
        axes.axhline(view.nearest[1], color=style.GREEN, linewidth=1.1, linestyle=(0, (4, 2)), zorder=3.5)


def finish(axes: Axes, window: Window) -> None:
    """Limits and labels, in metres."""
    axes.set_xlim(window.x_low, window.x_high)
    axes.set_ylim(window.z_low, window.z_high)
    axes.set_xlabel("to the right, m", labelpad=2)
    axes.set_ylabel("forward, m")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(7, steps=[1, 2, 5, 10]))
        axis.set_major_formatter(FuncFormatter(lambda value, _: plain(value, 4)))


def draw_near_zone(figure: Figure, rig: StereoRig, view: Footprint, bottom: float, height: float) -> None:
    """The first centimetres in front of the rig, to scale, in mm."""
    axes = style.place(figure, _SIDE_LEFT, bottom, _SIDE_WIDTH, height)
    baseline = rig.baseline_m
    centers = np.stack([view.left.center, view.right.center])
    far = 1.1 * baseline
    if view.nearest is not None:
        far = max(1.3 * float(view.nearest[1]), 0.6 * baseline)
    half = 0.5 * float(np.ptp(centers[:, 0])) + 0.22 * baseline
    low = float(centers[:, 1].min()) - 0.5 * baseline
    window = fill(Window(-half, half, low, max(far, low + baseline)), _SIDE_WIDTH / height)
    draw_views(axes, view, window)
    draw_nearest(axes, view)
    draw_cameras(axes, view, 0.0, baseline)
    arrow = centers - (0.0, 0.3 * baseline)
    axes.annotate(
        "", arrow[1], arrow[0], arrowprops={"arrowstyle": "<->", "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
    )
    axes.annotate(
        length(baseline),
        arrow.mean(axis=0),
        (0, -3),
        textcoords="offset points",
        ha="center",
        va="top",
        fontsize=9,
        path_effects=style.HALO,
    )
    finish(axes, window)
    in_mm = FuncFormatter(lambda value, _: plain(value * 1e3, 4))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10]))
        axis.set_major_formatter(in_mm)
    axes.grid(False)
    axes.set_xlabel("mm", labelpad=2)
    axes.set_ylabel("")
    axes.set_title("Near the rig", pad=5, fontsize=9.5)
