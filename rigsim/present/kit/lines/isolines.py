"""Lines of equal predicted depth error on a plan."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from rigsim.present.kit import style
from rigsim.present.kit.footprint import Footprint
from rigsim.present.kit.format import plain
from rigsim.present.kit.plan import Window
from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig

_GRID = 140


def closed_form(rig: StereoRig, points_left: Array, noise: PixelNoise) -> Array:
    """Depth std (N,) m by the closed form of `theory`, loaded when first asked for."""
    from rigsim.theory.uncertainty import predict_depth_std

    return predict_depth_std(rig, points_left, noise)


def draw_iso_lines(axes: Axes, rig: StereoRig, view: Footprint, window: Window, noise: PixelNoise) -> bool:
    """Lines of equal predicted depth std in the plane of the rig, labelled at their right end, if any."""
    both = view.overlap(window.corners)
    if not len(both):
        return False
    x, z, std_mm = _std_mm(rig, view, window, both, noise)
    grid = np.stack(np.meshgrid(x, z), axis=-1)
    seen = (view.left.sees(grid.reshape(-1, 2)) & view.right.sees(grid.reshape(-1, 2))).reshape(std_mm.shape)
    inside = std_mm[seen & np.isfinite(std_mm) & (std_mm > 0)]
    if not len(inside):
        return False
    per_inch = (window.z_high - window.z_low) / _paper_height(axes)
    clip = Polygon(both, transform=axes.transData)
    taken = [view.nearest[1]] if view.nearest is not None else []
    top = window.z_high - 0.08 * per_inch
    for level in reversed(style.nice_levels(float(inside.min()), float(inside.max()))):
        with np.errstate(all="ignore"):
            lines = axes.contour(
                x,
                z,
                np.log(std_mm),
                [np.log(level)],
                colors=style.INK,
                linewidths=0.9,
                linestyles="solid",  # a logarithm below zero is no reason for dashes
                alpha=0.75,
                zorder=5.5,
            )
        vertices = np.concatenate([path.vertices for path in lines.get_paths()])
        vertices = vertices[view.left.sees(vertices) & view.right.sees(vertices)]
        end = vertices[np.argmax(vertices[:, 0])] if len(vertices) else None
        if end is None or end[1] > top or any(abs(end[1] - z) < 0.19 * per_inch for z in taken):
            lines.remove()
            continue
        lines.set_clip_path(clip)
        taken.append(float(end[1]))
        _label(axes, level, (end[0], end[1]), outside=bool(window.x_high - end[0] > 0.62 * per_inch))
    return True


def _std_mm(
    rig: StereoRig, view: Footprint, window: Window, both: Array, noise: PixelNoise
) -> tuple[Array, Array, Array]:
    """Grid lines x (n,) and z (m,), m, over the view of both cameras, and the depth std there, (m, n), mm."""
    near = max(float(both[:, 1].min()), 1e-3 * window.z_high)
    # rows are spaced geometrically: the depth law is a straight line there, and the contours are exact
    x = np.linspace(both[:, 0].min(), both[:, 0].max(), _GRID // 2)
    z = np.geomspace(0.7 * near, window.z_high, _GRID)
    grid = np.stack(np.meshgrid(x, [0.0], z, indexing="ij"), axis=-1).reshape(-1, 3)
    points_left = rig.rig_from_left.inverse.apply(grid)
    # one image width beyond the overlap too: the contours reach its edge and are cut there
    near_view = np.ones(len(grid), dtype=bool)
    for lens, uv in zip((rig.left, rig.right), rig.project(points_left), strict=True):
        near_view &= np.abs(uv[:, 0] - lens.cx) < 2 * lens.width
    std = np.full(len(grid), np.nan)
    std[near_view] = closed_form(rig, points_left[near_view], noise)
    return x, z, std.reshape(len(x), len(z)).T * 1e3


def _label(axes: Axes, level: float, end: tuple[float, float], *, outside: bool) -> None:
    axes.annotate(
        f"{plain(level)} mm" if level < 1000 else f"{plain(level / 1e3)} m",
        end,
        (3, 0) if outside else (-2, 1.5),
        textcoords="offset points",
        ha="left" if outside else "right",
        va="center" if outside else "bottom",
        fontsize=9,
        path_effects=style.HALO,
        zorder=8,
    )


def _paper_height(axes: Axes) -> float:
    figure = axes.get_figure(root=True)
    return float(axes.get_position().height * figure.get_size_inches()[1]) if figure is not None else 1.0
