"""The plan of a rig: cameras, fields of view, points and lines of equal error, seen from above."""

from __future__ import annotations

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
from rigsim.present.kit.isolines import Predict, closed_form, draw_iso_lines
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
    error_name: str = "RMS depth error of a point",
    predict: Predict | None = None,
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
        error_name: what the colours mean.
        predict: ``(rig, points_left, noise) -> depth std (N,) m``; by default the closed form of `theory`.
    """
    points = np.asarray(points_left, dtype=np.float64).reshape(-1, 3)
    seen = np.ones(len(points), bool) if visible is None else np.asarray(visible, dtype=np.bool_).reshape(-1)
    predict = predict or closed_form
    if depth_error_m is not None:
        error = np.asarray(depth_error_m, dtype=np.float64).reshape(-1)
    elif noise is not None and noise.disparity_std_px > 0 and len(points):
        error = predict(rig, points, noise)
    else:
        error = np.full(len(points), np.nan)

    xz = rig.rig_from_left.apply(points)[:, [0, 2]]
    finite = np.isfinite(xz).all(axis=1)
    xz, seen, error = xz[finite], seen[finite], error[finite]
    noisy = noise is not None and noise.disparity_std_px > 0

    view = footprint(rig)
    window = _window(view, rig, xz)
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
        iso = noise is not None and noisy and draw_iso_lines(axes, rig, view, window, noise, predict)
        if view.nearest is None:
            axes.text(0.5, 0.5, "the cameras share no view", transform=axes.transAxes, ha="center")
        draw_nearest(axes, view)
        draw_cameras(axes, view, 0.022 * (window.z_high - window.z_low), rig.baseline_m)
        colored = _draw_points(axes, xz, seen, error, rays, view)
        if colored is not None:
            _color_bar(figure, colored, error_name)
        draw_near_zone(figure, rig, view, _MAIN_BOTTOM, min(1.9, height - 1.75))
        _legend(
            figure,
            view,
            _MAIN_BOTTOM + height,
            single=bool((~seen).any()),
            lost=bool(np.isnan(error[seen]).any()) and noisy,
            iso=iso,
        )
    return figure


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


def _draw_points(
    axes: Axes, xz: Array, seen: Mask, error_m: Array, rays: bool, view: Footprint
) -> PathCollection | None:
    """Points, the seen ones coloured by their error; returns the coloured artist, if there is one."""
    if rays:
        for camera, color in ((view.left, style.LEFT), (view.right, style.RIGHT)):
            for point in xz[:_FEW]:
                axes.plot(*np.stack([camera.center, point]).T, color=color, linewidth=1.2, zorder=4)
    size = 70.0 if len(xz) <= _FEW else float(np.clip(9000 / len(xz), 5, 24))
    raster = len(xz) > 300
    single = xz[~seen]
    if len(single):
        axes.scatter(
            single[:, 0],
            single[:, 1],
            s=size,
            facecolors="none",
            edgecolors="#8A8A8A",
            linewidths=0.6,
            zorder=4,
            rasterized=raster,
            gid="seen-by-one",
        )
    known = seen & np.isfinite(error_m)
    exact = not (error_m[known] > _NO_ERROR_M).any()  # without noise there is nothing to colour
    lost = seen & ~np.isfinite(error_m)
    if lost.any():
        axes.scatter(
            xz[lost, 0],
            xz[lost, 1],
            s=size,
            c=style.GREY,
            marker="x",
            linewidths=0.8,
            zorder=4,
            gid="not-found",
        )
    if not known.any():
        return None
    if exact:
        axes.scatter(
            xz[known, 0],
            xz[known, 1],
            s=size,
            c=style.INK,
            linewidths=0,
            zorder=5,
            rasterized=raster,
            gid="exact",
        )
        return None
    error_mm = error_m[known] * 1e3
    low, high = _color_limits(error_mm)
    artist = axes.scatter(
        xz[known, 0],
        xz[known, 1],
        c=error_mm,
        s=size,
        cmap=style.heat_map(),
        norm=LogNorm(low, high),
        linewidths=0.8 if len(xz) <= _FEW else 0.0,
        edgecolors="white",
        zorder=5,
        rasterized=raster,
        gid="points",
    )
    if len(xz) <= _FEW:
        for point, value in zip(xz[known], error_mm, strict=True):
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
    return artist


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
