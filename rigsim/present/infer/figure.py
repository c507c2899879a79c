"""The picture of an inference: the depth errors, the laws that may be behind them, and another rig's."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from rigsim.present.kit.format import number, plain
from rigsim.rig.arrays import Array
from rigsim.study.infer.run import CONFIDENCE, Inference, Transfer, depth_gain, law_factor

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_HEIGHT_IN = 4.3
_FINE = 100
_MARGIN = 1.25
_INTERVAL = f"its {100 * CONFIDENCE:.0f} % interval"


def inference_png(inference: Inference, carried: Transfer | None = None) -> bytes:
    """PNG of `inference_figure`."""
    from rigsim.present.kit import style

    return style.to_png(inference_figure(inference, carried))


def inference_figure(inference: Inference, carried: Transfer | None = None) -> Figure:
    """Depth errors over distance with stereo noise's law and two others; beside it another rig's."""
    from rigsim.present.kit import style

    with style.styled():
        figure = style.new_figure(style.PAGE_WIDTH_IN, _HEIGHT_IN)
        wide = 2.65 if carried is not None else 5.6
        given = style.place(figure, 0.75, 1.6, wide, 2.3)
        _draw_given(given, inference, columns=1 if carried is not None else 2)
        if carried is not None:
            other = style.place(figure, 4.35, 1.6, 2.65, 2.3)
            _draw_carried(other, inference, carried)
    return figure


def _draw_given(axes: Axes, inference: Inference, columns: int) -> None:
    from rigsim.present.kit import style

    errors, sigma = inference.errors, inference.disparity_std_px
    # the noise of a point is that of the depth where it is measured
    z, stds_mm = errors.means_m, 1e3 * errors.stds_m
    fine = _between(z)
    gain_mm = 1e3 * inference.explained_gain(fine)
    axes.plot(fine, sigma * gain_mm, color=style.BLUE, label=f"stereo noise, {number(sigma)} px of disparity")
    if not math.isnan(inference.low_px):
        low_mm, high_mm = inference.low_px * gain_mm, inference.high_px * gain_mm
        axes.fill_between(fine, low_mm, high_mm, color=style.BLUE, alpha=0.18, linewidth=0, label=_INTERVAL)
    drawn = [stds_mm, sigma * gain_mm]
    if inference.fit is not None:
        for law, power, colour, dashes in (
            ("linear", 1.0, style.ORANGE, "--"),
            ("constant", 0.0, style.GREEN, ":"),
        ):
            values_mm = 1e3 * law_factor(errors, power) * fine**power
            axes.plot(fine, values_mm, color=colour, linestyle=dashes, label=f"{law} law")
            drawn.append(values_mm)
    spread_mm = np.zeros_like(stds_mm)
    if errors.counts is not None:
        # a standard deviation of n values has this standard error, to first order
        spread_mm = stds_mm / np.sqrt(2 * (errors.counts - 1))
        drawn += [stds_mm - spread_mm, stds_mm + spread_mm]
    axes.errorbar(
        z,
        stds_mm,
        yerr=spread_mm if errors.counts is not None else None,
        color=style.INK,
        linestyle="none",
        marker="o",
        capsize=3,
        label="given" if errors.counts is None else "given, with standard error",
        zorder=5,
    )
    axes.set_title("Given errors")
    _finish(axes, fine, np.concatenate(drawn), columns)
    if errors.biases_m is not None:
        axes.set_xlabel("mean measured depth, m")


def _draw_carried(axes: Axes, inference: Inference, carried: Transfer) -> None:
    from rigsim.present.kit import style

    fine = _between(carried.depths_m)
    gain_mm = 1e3 * depth_gain(carried.rig, fine)
    drawn = [inference.disparity_std_px * gain_mm]
    axes.plot(fine, drawn[0], color=style.PURPLE, label="same stereo noise")
    if not math.isnan(inference.low_px):
        low_mm, high_mm = inference.low_px * gain_mm, inference.high_px * gain_mm
        axes.fill_between(fine, low_mm, high_mm, color=style.PURPLE, alpha=0.25, linewidth=0, label=_INTERVAL)
        drawn += [low_mm, high_mm]
    for trusted, face, label in (
        (True, style.PURPLE, ""),
        (False, "white", "disparity under 4 sigma"),
    ):
        chosen = carried.trusted == trusted
        if chosen.any():
            axes.plot(
                carried.depths_m[chosen],
                1e3 * carried.stds_m[chosen],
                color=style.PURPLE,
                markerfacecolor=face,
                linestyle="none",
                marker="s",
                label=label or None,
            )
    lens = carried.rig.left
    rig = "The same rig" if carried.rig == inference.rig else "Another rig"
    axes.set_title(f"{rig}: {plain(carried.rig.baseline_m * 1e3)} mm, {plain(lens.fx, 4)} px")
    _finish(axes, fine, np.concatenate(drawn), 1)


def _finish(axes: Axes, z: Array, drawn_mm: Array, columns: int) -> None:
    from rigsim.present.kit import style

    positive = drawn_mm[drawn_mm > 0]
    low, high = float(positive.min()) / _MARGIN, float(positive.max()) * _MARGIN
    style.plain_axis(axes, "x", z[0], z[-1], style.scale_of(z, 2), max_ticks=5)
    style.plain_axis(axes, "y", low, high, style.scale_of(np.array([low, high]), 4))
    axes.set_xlabel("distance, m")
    axes.set_ylabel("standard deviation of depth, mm")
    axes.legend(loc="upper left", bbox_to_anchor=(-0.02, -0.2), ncols=columns, labelspacing=0.25)


def _between(depths_m: Array) -> Array:
    """Distances from below the nearest to beyond the farthest."""
    return np.geomspace(depths_m.min() / _MARGIN, depths_m.max() * _MARGIN, _FINE)
