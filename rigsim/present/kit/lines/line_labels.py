"""Names along the lines of a plot, turned to their slope, clear of one another and of other lines."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.text import Text
from matplotlib.textpath import TextPath

from rigsim.present.kit import style
from rigsim.rig.arrays import Array, Mask

_SIZE_PT = 9.0
_OFF_PT = 7.5  # middle of the text from the line
_PLACES = (0.5, 0.35, 0.65, 0.2, 0.8, 0.12, 0.88, 0.27, 0.73, 0.43, 0.57)
_TOUCHES_LABEL = 1000


@dataclass(frozen=True, slots=True)
class Named:
    """A line with its name."""

    x: Array
    """Abscissae (n,), data."""
    y: Array
    """Ordinates (n,), data."""
    text: str
    """The name."""
    color: str
    """Colour of both."""


@dataclass(frozen=True, slots=True)
class _Box:
    """A turned rectangle on paper, in points."""

    middle: Array
    angle: float
    width: float
    height: float

    def contains(self, points: Array) -> Mask:
        away = np.asarray(points) - self.middle
        along = away @ (math.cos(self.angle), math.sin(self.angle))
        across = away @ (-math.sin(self.angle), math.cos(self.angle))
        return np.asarray((np.abs(along) <= self.width / 2) & (np.abs(across) <= self.height / 2))

    def grid(self) -> Array:
        """Points all over it."""
        along, across = np.meshgrid(
            np.linspace(-0.5, 0.5, 25) * self.width, np.linspace(-0.5, 0.5, 5) * self.height
        )
        c, s = math.cos(self.angle), math.sin(self.angle)
        turned = np.column_stack([(c * along - s * across).ravel(), (s * along + c * across).ravel()])
        return np.asarray(self.middle + turned)


def label_lines(
    axes: Axes,
    lines: Sequence[Named],
    keep_clear: Sequence[tuple[float, float]] = (),
    avoid: Array | None = None,
) -> list[Text]:
    """Write each line's name beside it; axes limits and scales must be final.

    Args:
        axes: where.
        lines: the lines; one that is not in view gets no name.
        keep_clear: places, data, that no name may cover.
        avoid: places (n, 2), data, that a name covers only when it must, such as those of a shaded area.

    Returns:
        The names written.
    """
    frame = axes.get_window_extent()
    figure = axes.get_figure(root=True)
    per_pt = (figure.dpi if figure is not None else 72.0) / 72
    low, high = np.array([frame.x0, frame.y0]) / per_pt, np.array([frame.x1, frame.y1]) / per_pt
    paper = [_on_paper(axes, line, per_pt) for line in lines]
    clear = [axes.transData.transform(np.array([place]))[0] / per_pt for place in keep_clear]
    shaded = np.empty((0, 2)) if avoid is None else axes.transData.transform(avoid) / per_pt
    taken: list[_Box] = []
    written: list[Text] = []
    for place, line in enumerate(lines):
        inside = (paper[place] >= low).all(axis=1) & (paper[place] <= high).all(axis=1)
        if inside.sum() < 2:
            continue
        others = np.concatenate([shaded, *(points for i, points in enumerate(paper) if i != place)])
        size = TextPath((0.0, 0.0), line.text, size=_SIZE_PT).get_extents()
        boxes = _boxes(paper[place][inside], size.width + 6, _SIZE_PT + 3)
        best = min(boxes, key=lambda box: _cost(box, others, taken, clear, low, high))
        taken.append(best)
        # held by data, not by pixels: the figure may be saved at another resolution
        x, y = axes.transData.inverted().transform(best.middle[None] * per_pt)[0]
        written.append(
            axes.text(
                x,
                y,
                line.text,
                rotation=math.degrees(best.angle),
                rotation_mode="anchor",
                ha="center",
                va="center",
                fontsize=_SIZE_PT,
                color=line.color,
                path_effects=style.HALO,
                zorder=6.5,
            )
        )
    return written


def _on_paper(axes: Axes, line: Named, per_pt: float) -> Array:
    """The line in points, densely: no two neighbours more than a point or two apart."""
    corners = axes.transData.transform(np.column_stack([line.x, line.y])) / per_pt
    steps = np.hypot(*np.diff(corners, axis=0).T)
    length = np.concatenate([[0.0], np.cumsum(steps)])
    at = np.linspace(0.0, length[-1], int(min(max(length[-1], 2), 4000)))
    return np.column_stack([np.interp(at, length, corners[:, i]) for i in (0, 1)])


def _boxes(points: Array, width: float, height: float) -> list[_Box]:
    """Where the name may stand, what is liked best first: at several places, on either side."""
    boxes = []
    for share in _PLACES:
        at = share * (len(points) - 1)
        half = min(width / 2, at, len(points) - 1 - at)
        start, stop = points[int(at - half)], points[math.ceil(at + half)]
        run = stop - start
        angle = math.atan2(run[1], run[0])
        if abs(angle) > math.pi / 2 + 1e-6:  # never upside down
            angle -= math.copysign(math.pi, angle)
        across = np.array([-math.sin(angle), math.cos(angle)])
        boxes += [_Box(points[int(at)] + side * _OFF_PT * across, angle, width, height) for side in (1, -1)]
    return boxes


def _cost(
    box: _Box, others: Array, taken: Sequence[_Box], clear: Sequence[Array], low: Array, high: Array
) -> float:
    grid = box.grid()
    outside = int((~((grid >= low) & (grid <= high)).all(axis=1)).sum())
    covered = sum(int(other.contains(grid).sum()) for other in taken)
    near = sum(int((np.hypot(*(grid - place).T) < 12).sum()) for place in clear)
    return float(_TOUCHES_LABEL * (outside + covered + near) + int(box.contains(others).sum()))
