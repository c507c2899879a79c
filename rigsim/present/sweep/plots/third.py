"""The third witness in a chart: hollow diamonds, and the dashed line that its own accuracy predicts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.transforms import Transform

from rigsim.present.kit import style
from rigsim.present.sweep.measured_words import equivalent_noise_px
from rigsim.present.sweep.plots.axes import Slice
from rigsim.present.sweep.plots.strips import mark_beyond, within
from rigsim.rig.arrays import Array, Mask
from rigsim.study.agreement.agreement import blamed
from rigsim.study.scene import columns as col

Dashes: TypeAlias = tuple[float, tuple[float, ...]]
"""A line pattern as matplotlib takes it: where it starts, and lengths on and off."""
DASHES: Dashes = (0, (4, 2.5))
"""Pattern of what is predicted from the measured accuracy."""


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """What was measured along one line of a chart."""

    x: Array
    """Where its marks stand along the page (N,)."""
    measured_mm: Array
    """Measured depth error RMS (N,), mm."""
    predicted_mm: Array
    """What the measurement's own accuracy predicts (N,), mm."""
    flagged: Mask
    """Whether the measurement is flagged (N,)."""
    lines: tuple[int, ...]
    """Lines of the chart that it belongs to; several when they differ in nothing a picture shows."""

    @property
    def ratio(self) -> Array:
        """Measured over predicted (N,)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.measured_mm / self.predicted_mm

    @property
    def line(self) -> int | None:
        """The only line it belongs to; None when there are several."""
        return self.lines[0] if len(self.lines) == 1 else None


def measured_series(
    cut: Slice, parts: list[tuple[Any, pd.DataFrame]], positions: Callable[[pd.DataFrame], Array]
) -> list[Series]:
    """What was measured along the lines of a chart; what is the same for several lines comes once.

    The noise of the simulation changes nothing in the pictures: along a noise axis one mark a line stands
    at the noise it corresponds to, and lines that are noise levels share their marks.

    Args:
        cut: the slice the chart shows.
        parts: its lines with their rows, as `Slice.parts` returns them.
        positions: places of rows along the page.
    """
    along_noise = cut.x.column == col.NOISE
    if cut.lines is not None and cut.lines.column == col.NOISE and parts:
        key = cut.x.column
        every = pd.concat([part for _, part in parts]).drop_duplicates(key)
        if cut.x.numeric:
            every = every.sort_values(key, kind="stable")
        found = [_series(every, positions(every), tuple(range(len(parts))))]
    else:
        found = []
        for i, (_, part) in enumerate(parts):
            if along_noise:
                part = part[part[col.MEASURED_DEPTH_RMSE] > 0].head(1)
            x = equivalent_noise_px(part) if along_noise else positions(part)
            _join(found, _series(part, x, (i,)))
    return [series for series in found if len(series.x)]


def draw_series(axes: Axes, strip: Axes, series: Series, curve: bool, aside: Transform) -> None:
    """Draw marks and prediction into the chart, and their ratio into its strip.

    `curve` joins the predictions; otherwise each is a bar at its place. `aside` places x in the strip.
    """
    color = color_of(series)
    curve = curve and len(series.x) > 1
    known = np.isfinite(series.predicted_mm) & (series.predicted_mm > 0)
    x, predicted = series.x[known], series.predicted_mm[known]
    if curve:
        axes.plot(*style.between(x, predicted), color=color, linestyle=DASHES, linewidth=1.3, zorder=2)
    else:
        axes.scatter(
            x, predicted, marker="_", s=260, color=color, linewidths=1.4, linestyle=(0, (1.4, 1)), zorder=2
        )
    mark_beyond(strip, series.x, series.ratio, color, aside)
    ratio = within(strip, series.ratio)
    for each, y, place in ((axes, series.measured_mm, axes.transData), (strip, ratio, aside)):
        size = 34 if len(series.x) <= 20 else 18
        each.scatter(
            series.x,
            y,
            s=size,
            marker=style.MEASURED_MARK,
            facecolors="none",
            edgecolors=color,
            linewidths=1.3,
            zorder=5,
            transform=place,
            label="_measured",
        )
        style.ring(each, series.x[series.flagged], y[series.flagged], place)


def color_of(series: Series) -> str:
    """The colour of its line; ink when it belongs to several."""
    return style.INK if series.line is None else style.LINES[series.line]


def _series(part: pd.DataFrame, x: Array, lines: tuple[int, ...]) -> Series:
    measured, predicted = (
        np.asarray(part[name], dtype=np.float64)
        for name in (col.MEASURED_DEPTH_RMSE, col.PREDICTED_FROM_MEASURED_RMSE)
    )
    flagged = blamed(part, "measured")
    shown = np.isfinite(x) & np.isfinite(measured) & (measured > 0)
    return Series(x[shown], measured[shown], predicted[shown], flagged[shown], lines)


def _join(found: list[Series], series: Series) -> None:
    """Append a series, or add its line to one that says the same."""
    for i, other in enumerate(found):
        if (
            len(other.x) == len(series.x) > 0
            and np.allclose(other.x, series.x)
            and np.allclose(other.measured_mm, series.measured_mm)
        ):
            found[i] = Series(
                other.x, other.measured_mm, other.predicted_mm, other.flagged, other.lines + series.lines
            )
            return
    found.append(series)
