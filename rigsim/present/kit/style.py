"""The look of every figure: one style, colour-blind safe, legible when printed.

Figures are made as objects and drawn by Agg or the SVG backend; pyplot and its global state are never
touched. Sizes are inches on paper, so a 9 pt label is 9 pt when the page is printed.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from html import escape
from typing import Any, Literal

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator
from matplotlib.transforms import Transform

from rigsim.present.kit.format import plain
from rigsim.rig.arrays import Array

# Okabe and Ito's palette, https://jfly.uni-koeln.de/color/: told apart by the colour-blind
BLUE, VERMILION, GREEN = "#0072B2", "#D55E00", "#009E73"
PURPLE, ORANGE, SKY, BLACK = "#CC79A7", "#E69F00", "#56B4E9", "#000000"
GREY, LIGHT_GREY, INK = "#767676", "#D0D0D0", "#222222"
LINES: tuple[str, ...] = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, BLACK)
"""Colours of up to six curves."""
MARKERS: tuple[str, ...] = ("o", "s", "^", "v", "P", "X")
"""Marks of up to six curves, so that they differ in grey too."""
LEFT, RIGHT = BLUE, VERMILION
"""Colours of the left and the right camera."""
MEASURED_MARK = "D"
"""Mark of the third witness, the one measured in the images: a hollow diamond."""

HALO = [withStroke(linewidth=2.5, foreground="white")]
"""White rim that keeps a label legible over lines."""

PAGE_WIDTH_IN = 7.2
"""Width of a figure that fills a printed A4 column, in."""

_RC: dict[Any, Any] = {
    "font.family": "DejaVu Sans",  # shipped with matplotlib, so a figure looks the same everywhere
    "font.size": 9.5,
    "axes.titlesize": 10.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 9.5,
    "axes.labelcolor": INK,
    "axes.edgecolor": "#555555",
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#E4E4E4",
    "grid.linewidth": 0.7,
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
    "xtick.color": "#444444",
    "ytick.color": "#444444",
    "legend.fontsize": 9,
    "legend.title_fontsize": 9,
    "legend.frameon": False,
    "text.color": INK,
    "lines.linewidth": 1.6,
    "lines.markersize": 5,
    "svg.fonttype": "path",
    "svg.hashsalt": "rigsim",
}


def show_as_picture(axes: Axes) -> None:
    """Rows down, no ticks, grey where there is nothing: what a map over a picture looks like."""
    axes.set_facecolor(LIGHT_GREY)
    axes.invert_yaxis()
    axes.set_xticks([])
    axes.set_yticks([])
    axes.grid(visible=False)


def heat_map() -> Colormap:
    """Colour map of fields and points: viridis without its palest end, which is lost on white paper."""
    return ListedColormap(matplotlib.colormaps["viridis"](np.linspace(0.0, 0.93, 256)), "rigsim")


AxisScale = Literal["linear", "log"]


@contextmanager
def styled() -> Iterator[None]:
    """Make and draw figures inside this context; what matplotlib was set to before is put back."""
    with matplotlib.rc_context(_RC):
        yield


def new_figure(width_in: float, height_in: float) -> Figure:
    """An empty figure on white paper."""
    return Figure(figsize=(width_in, height_in), dpi=100, facecolor="white")


def place(figure: Figure, left: float, bottom: float, width: float, height: float) -> Axes:
    """Axes at a place given in inches from the lower left corner of the page."""
    page_width, page_height = figure.get_size_inches()
    return figure.add_axes(
        (left / page_width, bottom / page_height, width / page_width, height / page_height)
    )


def legend(
    figure: Figure,
    entries: Sequence[tuple[Artist, str]],
    left: float,
    top: float,
    title: str | None = None,
    columns: int = 1,
) -> None:
    """A legend whose upper left corner stands at a place given in inches."""
    page_width, page_height = figure.get_size_inches()
    figure.legend(
        [artist for artist, _ in entries],
        [label for _, label in entries],
        title=title,
        alignment="left",
        ncols=columns,
        loc="upper left",
        bbox_to_anchor=(left / page_width, top / page_height),
        handlelength=1.5,
        handletextpad=0.5,
        labelspacing=0.35,
        borderaxespad=0.0,
    )


def between(x: Array, y: Array) -> tuple[Array, Array]:
    """The polyline through (x, y), bent as a power law where all is positive: the law between the rigs."""
    if not len(x) or not ((x > 0).all() and (y > 0).all()) or np.ptp(x) == 0:
        return x, y
    fine = np.unique(np.concatenate([x, np.geomspace(x.min(), x.max(), 100)]))
    return fine, np.exp(np.interp(np.log(fine), np.log(x), np.log(y)))


def ring(axes: Axes, x: Array, y: Array, transform: Transform) -> None:
    """Circles around flagged marks."""
    axes.scatter(
        x, y, s=120, facecolors="none", edgecolors=INK, linewidths=1.3, zorder=6, transform=transform
    )


def to_png(figure: Figure, dpi: int = 150) -> bytes:
    """The figure as PNG."""
    buffer = io.BytesIO()
    with styled():
        figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    return buffer.getvalue()


def to_svg(figure: Figure, name: str, title: str) -> str:
    """The figure as an ``<svg>`` element to put into a page.

    Args:
        figure: what to draw; artists marked as rasterised are embedded as pictures.
        name: prefix that keeps the ids of several figures in one page apart.
        title: said by screen readers in place of the picture.
    """
    buffer = io.StringIO()
    with styled():
        figure.savefig(
            buffer, format="svg", dpi=180, metadata=dict.fromkeys(("Creator", "Date", "Format", "Type"))
        )
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"\s*<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r'href="#', f'href="#{name}-', text)
    text = re.sub(r"url\(#", f"url(#{name}-", text)
    head, rest = text.split(">", 1)
    head = re.sub(r'\s(width|height|version)="[^"]*"', "", head)
    return f'{head} role="img" aria-label="{escape(title)}"><title>{escape(title)}</title>{rest}'


def scale_of(values: np.typing.ArrayLike, span: float = 8.0) -> AxisScale:
    """ "log" where positive values span a factor of `span` or more, else "linear"."""
    array = np.asarray(values, dtype=np.float64)
    array = array[np.isfinite(array)]
    return "log" if array.size and array.min() > 0 and array.max() >= span * array.min() else "linear"


def nice_levels(low: float, high: float, steps: tuple[float, ...] = (1, 2, 5)) -> list[float]:
    """The values 1, 2, 5, 10, ... (times any power of ten) within [low, high]."""
    if not (0 < low <= high < math.inf):
        return []
    exponents = range(math.floor(math.log10(low)), math.floor(math.log10(high)) + 1)
    # a decimal literal is exact where a product with a power of ten is not: 0.3, not 0.30000000000000004
    levels = [float(f"{step}e{exponent}") for exponent in exponents for step in steps]
    return [level for level in levels if low * (1 - 1e-9) <= level <= high * (1 + 1e-9)]


def plain_axis(
    axes: Axes, which: Literal["x", "y"], low: float, high: float, scale: AxisScale, max_ticks: int = 6
) -> None:
    """Set the scale, the limits and ticks in plain numbers: no powers of ten, no offsets."""
    axis = axes.xaxis if which == "x" else axes.yaxis
    (axes.set_xscale if which == "x" else axes.set_yscale)(scale)
    if scale == "log":
        choices = ((1, 1.5, 2, 3, 4, 5, 7), (1, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,))
        ticks = [nice_levels(low, high, steps) for steps in choices]
        axis.set_major_locator(FixedLocator(next((t for t in ticks if len(t) <= max_ticks), ticks[-1])))
        axis.set_minor_locator(NullLocator())
    else:
        axis.set_major_locator(MaxNLocator(max_ticks - 1, steps=[1, 2, 2.5, 5, 10]))
    axis.set_major_formatter(FuncFormatter(lambda value, _: plain(value, 4)))
    (axes.set_xlim if which == "x" else axes.set_ylim)(low, high)
