"""A calibration from pictures as figures: where corners were, and how far off they are."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from rigsim.present.kit.format import number, percent, plain
from rigsim.rig.arrays import Array
from rigsim.study.calibrate.pictures.outliers import LIMIT
from rigsim.study.calibrate.pictures.result import CalibratedPictures

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_GAP_IN = 0.25
_TOP_IN = 0.55
_ARROW_SHARE = 0.03
"""Length of a typical residual's arrow over the picture's width."""
_MOST_BARS = 40


def pictures_figures(result: CalibratedPictures) -> Mapping[str, Callable[[], Figure]]:
    """``coverage`` and ``residuals``."""
    return {"coverage": partial(coverage_figure, result), "residuals": partial(residuals_figure, result)}


def coverage_figure(result: CalibratedPictures) -> Figure:
    """Where the corners of the pairs that count were in both pictures; cells that none reached are grey."""
    from rigsim.present.kit import style

    with style.styled():
        width_in = (style.PAGE_WIDTH_IN - _GAP_IN) / 2
        size = result.sightings.sizes
        height_in = max(width_in * h / w for w, h in size)
        figure = style.new_figure(style.PAGE_WIDTH_IN, height_in + _TOP_IN)
        for side, cells in ((0, result.coverage.left), (1, result.coverage.right)):
            axes = _picture_axes(result, figure, side, width_in, 0.0, height_in)
            w, h = size[side]
            rows, cols = cells.shape
            for row, col in zip(*np.nonzero(~cells), strict=True):
                at = (col * w / cols - 0.5, row * h / rows - 0.5)
                _rectangle(axes, at, w / cols, h / rows)
            for pair in np.flatnonzero(result.kept):
                uv = result.sightings.observed[pair, side]
                axes.plot(uv[:, 0], uv[:, 1], ".", markersize=2.2, color=(style.LEFT, style.RIGHT)[side])
            name = ("left", "right")[side]
            axes.set_title(f"{name}: {percent(result.coverage.shares[side])} % reached", fontsize=9.5)
        figure.text(
            0.0,
            1 - 0.05 / (height_in + _TOP_IN),
            "Where the corners were; grey: not reached",
            va="top",
            fontweight="bold",
            fontsize=10.5,
        )
    return figure


def residuals_figure(result: CalibratedPictures) -> Figure:
    """Residuals as arrows in both pictures, and each pair over what the others predict."""
    from rigsim.present.kit import style

    with style.styled():
        width_in = (style.PAGE_WIDTH_IN - _GAP_IN) / 2
        height_in = max(width_in * h / w for w, h in result.sightings.sizes)
        bars_in = 2.4
        total_in = height_in + _TOP_IN + bars_in
        figure = style.new_figure(style.PAGE_WIDTH_IN, total_in)
        scale = _ARROW_SHARE * result.sightings.sizes[0][0] / result.fit.rms_px
        for side in (0, 1):
            axes = _picture_axes(result, figure, side, width_in, bars_in, height_in)
            uv = result.fit.sightings.observed[:, side].reshape(-1, 2)
            off = result.fit.adjusted.residuals[:, side].reshape(-1, 2)
            known = np.isfinite(off).all(axis=1)
            axes.quiver(
                *(uv[known, 0], uv[known, 1], scale * off[known, 0], scale * off[known, 1]),
                angles="xy",
                scale_units="xy",
                scale=1.0,
                width=0.0022,
                color=(style.LEFT, style.RIGHT)[side],
            )
            rms_px = _rms(off[known])
            axes.set_title(f"{('left', 'right')[side]}: {number(rms_px)} px rms", fontsize=9.5)
        figure.text(
            0.0,
            1 - 0.05 / total_in,
            f"How far corners are off, {plain(scale, 2)} times enlarged",
            va="top",
            fontweight="bold",
            fontsize=10.5,
        )
        _bars(result, figure)
    return figure


def _picture_axes(
    result: CalibratedPictures, figure: Figure, side: int, width_in: float, bottom_in: float, height_in: float
) -> Axes:
    """Axes in which one camera's pixels stand as in its picture."""
    from rigsim.present.kit import style

    w, h = result.sightings.sizes[side]
    own_in = width_in * h / w
    axes = style.place(figure, side * (width_in + _GAP_IN), bottom_in + height_in - own_in, width_in, own_in)
    axes.set_xlim(-0.5, w - 0.5)
    axes.set_ylim(h - 0.5, -0.5)
    axes.set_xticks([])
    axes.set_yticks([])
    axes.grid(visible=False)
    for spine in axes.spines.values():
        spine.set_visible(True)
    return axes


def _rectangle(axes: Axes, at: tuple[float, float], width: float, height: float) -> None:
    from matplotlib.patches import Rectangle

    axes.add_patch(Rectangle(at, width, height, facecolor="#E8E8E8", edgecolor="white", linewidth=0.6))


def _bars(result: CalibratedPictures, figure: Figure) -> None:
    """Each pair's residual over what the others predict."""
    from rigsim.present.kit import style

    checks = [check for check in result.pictures if np.isfinite(check.ratio)]
    worst = sorted(checks, key=lambda check: -check.ratio)[:_MOST_BARS]
    checks = [check for check in checks if check in worst]
    axes = style.place(figure, 0.6, 0.95, style.PAGE_WIDTH_IN - 0.65, 1.1)
    top = max([check.ratio for check in checks], default=LIMIT)
    shown = min(max(1.1 * top, 1.1 * LIMIT), 5.0)
    for k, check in enumerate(checks):
        color = style.VERMILION if check.verdict == "outlier" else style.BLUE
        axes.bar(k, min(check.ratio, shown), width=0.7, color=color)
        if check.ratio > shown:
            axes.text(
                k,
                shown * 0.97,
                number(check.ratio),
                ha="center",
                va="top",
                color="white",
                fontsize=8,
                rotation=90,
            )
    axes.axhline(1.0, color=style.BLACK, linewidth=0.9)
    axes.axhline(LIMIT, color=style.VERMILION, linewidth=0.9, linestyle="--")
    axes.set_xlim(-0.6, len(checks) - 0.4)
    axes.set_ylim(0, shown)
    axes.set_xticks(range(len(checks)), [check.name for check in checks], rotation=45, ha="right", fontsize=7)
    axes.grid(visible=False, axis="x")
    axes.set_ylabel("over predicted")
    axes.set_title(
        "Each pair as a rig from the others predicts it: 1 is right, dashed is the limit", fontsize=9.5
    )


def _rms(off: Array) -> float:
    return float(np.sqrt(np.mean(np.sum(off**2, axis=1)))) if len(off) else float("nan")
