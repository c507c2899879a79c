"""The plan of a rig: cameras, fields of view, points and lines of equal error, seen from above."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from rigsim.present.kit import style
from rigsim.present.kit.footprint import Footprint, footprint
from rigsim.present.kit.format import length, length_mm, plain
from rigsim.present.kit.lines.isolines import closed_form, draw_iso_lines
from rigsim.present.kit.plan import (
    BOTH,
    Window,
    draw_cameras,
    draw_near_zone,
    draw_nearest,
    draw_views,
    fill,
    finish,
)
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import inner_range

_MAIN_LEFT, _MAIN_BOTTOM, _MAIN_WIDTH = 0.62, 1.12, 4.75
_FEW = 12
_MANY = 300
_NO_ERROR_M = 1e-9


def topdown_figure(
    rig: StereoRig,
    points_left: npt.ArrayLike,
    *,
    visible: npt.ArrayLike | None = None,
    depth_error_m: npt.ArrayLike | None = None,
    noise: PixelNoise | None = None,
    rays: bool = False,
    title: str = "",
) -> Figure:
    """Draw the rig from above, in metres, x to the right and forward up the page.

    Args:
        rig: the rig; rectified, verged or any other.
        points_left: points (N, 3) m in the left camera's frame; NaN rows are left out.
        visible: whether both cameras see a point, (N,); all by default. Others are hollow and grey.
        depth_error_m: depth error of each point, (N,) m, its colour; by default the predicted one.
        noise: pixel noise for the lines of equal predicted error; no lines without it.
        rays: draw the line of sight of both cameras to every point, for a handful of points.
        title: heading of the figure.
    """
    noisy = noise is not None and noise.disparity_std_px > 0
    points = _points(rig, points_left, visible, depth_error_m, noise)
    view = footprint(rig)
    window = _window(view, rig, points.xz)
    shape = (window.z_high - window.z_low) / (window.x_high - window.x_low)
    height = float(np.clip(_MAIN_WIDTH * shape, 3.2, 6.2))
    window = fill(window, _MAIN_WIDTH / height)
    with style.styled():
        figure = style.new_figure(style.PAGE_WIDTH_IN, _MAIN_BOTTOM + height + (0.42 if title else 0.15))
        axes = style.place(figure, _MAIN_LEFT, _MAIN_BOTTOM, _MAIN_WIDTH, height)
        finish(axes, window)
        if title:
            axes.set_title(title, pad=8)
        draw_views(axes, view, window)
        iso = noise is not None and noisy and draw_iso_lines(axes, rig, view, window, noise)
        if view.nearest is None:
            axes.text(0.5, 0.5, "the cameras share no view", transform=axes.transAxes, ha="center")
        draw_nearest(axes, view)
        draw_cameras(axes, view, 0.022 * (window.z_high - window.z_low), rig.baseline_m)
        if rays:
            _draw_rays(axes, points, view)
        colored = _draw_points(axes, points)
        if colored is not None:
            name = "predicted depth std" if depth_error_m is None else "RMS depth error of a point"
            _color_bar(figure, colored, name)
        draw_near_zone(figure, rig, view, _MAIN_BOTTOM, min(1.9, height - 1.75))
        lost, single = bool(points.lost.any()) and noisy, not points.seen.all()
        _legend(figure, view, _MAIN_BOTTOM + height, single=single, lost=lost, iso=iso)
    return figure


@dataclass(frozen=True, slots=True, eq=False)
class _Points:
    """Points (N, 2) m of the plan, whether both cameras see them, and their depth errors, m."""

    xz: Array
    seen: Mask
    error_m: Array

    @property
    def known(self) -> Mask:
        """Seen points with an error."""
        return np.asarray(self.seen & np.isfinite(self.error_m))

    @property
    def lost(self) -> Mask:
        """Seen points without one."""
        return np.asarray(self.seen & ~np.isfinite(self.error_m))

    @property
    def few(self) -> bool:
        """Whether each can be labelled."""
        return len(self.xz) <= _FEW

    @property
    def size(self) -> float:
        """Area of a mark, square points."""
        return 70.0 if self.few else float(np.clip(9000 / len(self.xz), 5, 24))


def _points(
    rig: StereoRig,
    points_left: npt.ArrayLike,
    visible: npt.ArrayLike | None,
    depth_error_m: npt.ArrayLike | None,
    noise: PixelNoise | None,
) -> _Points:
    """The finite points as they lie on the plan."""
    points = np.asarray(points_left, dtype=np.float64).reshape(-1, 3)
    seen = np.ones(len(points), bool) if visible is None else np.asarray(visible, dtype=np.bool_).reshape(-1)
    if depth_error_m is not None:
        error = np.asarray(depth_error_m, dtype=np.float64).reshape(-1)
    elif noise is not None and noise.disparity_std_px > 0 and len(points):
        error = closed_form(rig, points, noise)
    else:
        error = np.full(len(points), np.nan)
    xz = rig.rig_from_left.apply(points)[:, [0, 2]]
    finite = np.isfinite(xz).all(axis=1)
    return _Points(xz[finite], seen[finite], error[finite])


def _window(view: Footprint, rig: StereoRig, xz: Array) -> Window:
    """Points, cameras and the nearest overlap, with air around them."""
    reach = float(xz[:, 1].max()) if len(xz) else 0.0
    near = view.nearest[1] if view.nearest is not None else 0.0
    reach = max(reach * 1.08, near * 1.5, 2.5 * rig.baseline_m)
    centers = np.stack([view.left.center, view.right.center])
    low = min(float(centers[:, 1].min()), float(xz[:, 1].min()) if len(xz) else 0.0, 0.0)
    z_low = low - max(0.05 * (reach - low), 0.3 * rig.baseline_m)
    half = 0.0
    box = np.array([[-9.0, 0.0], [9.0, 0.0], [9.0, 1.0], [-9.0, 1.0]]) * reach
    both = view.overlap(box)
    if len(both):
        half = float(np.abs(both[:, 0]).max()) * 1.06
    half = float(np.clip(half, 0.45 * reach, 0.80 * reach))
    if len(xz):
        half = max(half, float(np.abs(xz[:, 0]).max()) * 1.06)
    half = max(half, float(np.abs(centers[:, 0]).max()) * 1.3)
    return Window(-half, half, z_low, reach)


def _draw_rays(axes: Axes, points: _Points, view: Footprint) -> None:
    """Lines of sight to the first few points."""
    for camera, color in ((view.left, style.LEFT), (view.right, style.RIGHT)):
        for point in points.xz[:_FEW]:
            axes.plot(*np.stack([camera.center, point]).T, color=color, linewidth=1.2, zorder=4)


def _draw_points(axes: Axes, points: _Points) -> PathCollection | None:
    """Points, the seen ones coloured by their error; returns the coloured artist that needs a colour bar."""
    single = points.xz[~points.seen]
    if len(single):
        axes.scatter(
            single[:, 0],
            single[:, 1],
            s=points.size,
            facecolors="none",
            edgecolors="#8A8A8A",
            linewidths=0.6,
            zorder=4,
            rasterized=len(points.xz) > _MANY,
            gid="seen-by-one",
        )
    if points.lost.any():
        axes.scatter(
            points.xz[points.lost, 0],
            points.xz[points.lost, 1],
            s=points.size,
            c=style.GREY,
            marker="x",
            linewidths=0.8,
            zorder=4,
            gid="not-found",
        )
    known = points.known
    if not known.any():
        return None
    if (points.error_m[known] > _NO_ERROR_M).any():
        return _draw_colored(axes, points)
    axes.scatter(  # without noise there is nothing to colour
        points.xz[known, 0],
        points.xz[known, 1],
        s=points.size,
        c=style.INK,
        linewidths=0,
        zorder=5,
        rasterized=len(points.xz) > _MANY,
        gid="exact",
    )
    return None


def _draw_colored(axes: Axes, points: _Points) -> PathCollection | None:
    """Points with their errors: as colours, and as numbers when they are few."""
    xz, error_mm = points.xz[points.known], points.error_m[points.known] * 1e3
    artist = axes.scatter(
        xz[:, 0],
        xz[:, 1],
        c=error_mm,
        s=points.size,
        cmap=style.heat_map(),
        norm=LogNorm(*_color_limits(error_mm)),
        linewidths=0.8 if points.few else 0.0,
        edgecolors="white",
        zorder=5,
        rasterized=len(points.xz) > _MANY,
        gid="points",
    )
    if not points.few:
        return artist
    for point, value in zip(xz, error_mm, strict=True):
        left_half = point[0] <= np.mean(axes.get_xlim())
        axes.annotate(
            f"depth {length(point[1])}\n± {length_mm(value)}",
            point,
            (9 if left_half else -9, 0),
            textcoords="offset points",
            ha="left" if left_half else "right",
            va="center",
            fontsize=9,
            path_effects=style.HALO,
            zorder=8,
        )
    return None


def _color_limits(error_mm: Array) -> tuple[float, float]:
    """Limits of the colour scale: all but the outermost hundredth, at least a factor of two apart."""
    positive = error_mm[error_mm > _NO_ERROR_M * 1e3]
    low, high = inner_range(positive)
    if high < 2 * low:
        middle = (low * high) ** 0.5
        low, high = middle / 2**0.5, middle * 2**0.5
    return low, high


def _color_bar(figure: Figure, artist: PathCollection, name: str) -> None:
    axes = style.place(figure, _MAIN_LEFT, 0.48, _MAIN_WIDTH, 0.13)
    bar = figure.colorbar(artist, cax=axes, orientation="horizontal", extend="both")
    low, high = _color_limits(np.asarray(artist.get_array(), dtype=np.float64))
    ticks = style.nice_levels(low, high)
    if len(ticks) > 8:
        ticks = style.nice_levels(low, high, (1,))
    elif len(ticks) < 3:
        ticks = style.nice_levels(low, high, (1, 1.5, 2, 3, 4, 5, 7))
    axes.xaxis.set_major_locator(FixedLocator(ticks))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: plain(value)))
    axes.grid(False)
    bar.set_label(f"{name}, mm", labelpad=3)


def _legend(figure: Figure, view: Footprint, top: float, *, single: bool, lost: bool, iso: bool) -> None:
    def patch(color: str, alpha: float, hatch: str | None = None, edge: str = "none") -> Patch:
        return Patch(facecolor=color, alpha=alpha, hatch=hatch, edgecolor=edge, linewidth=0.6)

    entries: list[tuple[Artist, str]] = [
        (Line2D([], [], color=style.LEFT), "left camera"),
        (Line2D([], [], color=style.RIGHT), "right camera"),
    ]
    if view.nearest is not None:
        entries.append((patch(BOTH, 0.4), "seen by both"))
    if view.blind is not None:
        entries.append((patch("white", 1.0, "/////", style.GREY), "blind zone"))
    if view.nearest is not None:
        entries.append((Line2D([], [], color=style.GREEN, linestyle=(0, (4, 2))), "nearest overlap"))
    if iso:
        entries.append((Line2D([], [], color=style.INK, linewidth=0.9), "predicted error"))
    for shown, marker, label in ((single, "o", "seen by one only"), (lost, "x", "not triangulated")):
        if shown:
            mark = Line2D(
                [], [], marker=marker, linestyle="none", markerfacecolor="none", markeredgecolor="#8A8A8A"
            )
            entries.append((mark, label))
    style.legend(figure, entries, _MAIN_LEFT + _MAIN_WIDTH + 0.06, top)
