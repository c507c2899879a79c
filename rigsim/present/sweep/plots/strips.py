"""Strips of ratios under a chart: 1 is perfect agreement, and what lies beyond the strip is marked there."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator
from matplotlib.transforms import Transform, blended_transform_factory

from rigsim.present.kit import style
from rigsim.present.kit.format import number, plain
from rigsim.rig.arrays import Array

_NARROWEST, _WIDEST_LINEAR = 0.02, 0.95
_WIDEST = 100.0  # times; beyond, a ratio only says that something is broken
_STRAY, _STRAY_FROM = 4.0, 0.3  # times as far from 1 as three quarters of the others, and at least so far
_TICKS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100)


def scale_strip(axes: Axes, ratios: Array, low: Array, high: Array) -> None:
    """Centre a strip on 1, as wide as the ratios and most of their intervals need.

    Logarithmic when the ratios are off by more than a factor of two; a few that stray far from the
    others are left beyond the strip, for `mark_beyond`.
    """
    core = _core(_sizes(ratios - 1))
    if core > _WIDEST_LINEAR:
        with np.errstate(divide="ignore", invalid="ignore"):
            factor = np.exp(1.25 * _core(_sizes(np.log(ratios))))
        factor = float(np.clip(factor, 2.0, _WIDEST))
        axes.set_yscale("log")
        axes.set_ylim(1 / factor, factor)
        ticks = [tick for tick in _TICKS if 1 / factor <= tick <= factor]
        step = 3 if len(ticks) > 5 else 1
        middle = ticks.index(1)
        axes.yaxis.set_major_locator(FixedLocator(ticks[middle % step :: step]))
    else:
        interval = 1.15 * _share(_sizes(np.stack([low, high]) - 1), 90)
        half = min(max(1.3 * core, interval, _NARROWEST), 1.0)
        axes.set_ylim(1 - half, 1 + half)
        axes.yaxis.set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10]))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: plain(value, 4)))
    axes.axhline(1, color="#555555", linewidth=0.9)


def within(axes: Axes, ratios: Array) -> Array:
    """The ratios that lie in the strip; NaN in place of those that `mark_beyond` stands in for."""
    low, high = axes.get_ylim()
    return np.asarray(np.where((ratios >= low) & (ratios <= high), ratios, np.nan))


def mark_beyond(axes: Axes, x: Array, ratios: Array, color: str, transform: Transform) -> None:
    """An arrow at the strip's edge and the number for every ratio beyond it; `transform` places x."""
    low, high = axes.get_ylim()
    along = blended_transform_factory(transform, axes.transAxes)
    for beyond, edge, arrow in ((ratios > high, 0.93, "^"), (ratios < low, 0.07, "v")):
        for place, ratio in zip(x[beyond], ratios[beyond], strict=True):
            axes.plot(
                [place],
                [edge],
                arrow,
                color=color,
                markersize=6,
                markeredgecolor=style.INK,
                markeredgewidth=0.7,
                transform=along,
                clip_on=False,
                zorder=7,
                scalex=False,
                scaley=False,
                label="_beyond",
            )
            axes.annotate(
                number(ratio, 2),
                (place, edge),
                (5, 0),
                xycoords=along,
                textcoords="offset points",
                va="center",
                fontsize=8,
                path_effects=style.HALO,
                zorder=7,
            )


def _sizes(deviation: Array) -> Array:
    return np.asarray(np.abs(deviation[np.isfinite(deviation)]))


def _share(sizes: Array, share: float) -> float:
    return float(np.percentile(sizes, share)) if sizes.size else 0.0


def _core(sizes: Array) -> float:
    """The largest of those that do not stray from the others; there must be a gap before a stray one."""
    most = _share(sizes, 100)
    core = _share(sizes[sizes <= max(_STRAY * _share(sizes, 75), _STRAY_FROM)], 100)
    return most if most <= 2 * core else core
