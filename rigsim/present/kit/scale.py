"""The colour bar under a picture."""

from __future__ import annotations

import io

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import FuncFormatter, MaxNLocator
from PIL import Image as PillowImage

from rigsim.present.kit import style
from rigsim.present.kit.format import plain
from rigsim.rig.arrays import Image

_DPI = 100
_HEIGHT_IN = 0.62
_MARGIN_IN = 0.35


def scale_strip(width_px: int, limits: tuple[float, float], label: str) -> Image:
    """A white strip (62, width_px, 3) with the viridis colour bar from low to high and its label."""
    width = width_px / _DPI
    with style.styled():
        figure = style.new_figure(width, _HEIGHT_IN)
        margin = min(_MARGIN_IN, width / 5)
        axes = style.place(figure, margin, 0.42, width - 2 * margin, 0.13)
        bar = figure.colorbar(
            ScalarMappable(Normalize(*limits), "viridis"), cax=axes, orientation="horizontal"
        )
        bar.set_label(label, labelpad=1)
        axes.grid(False)
        axes.xaxis.set_major_locator(MaxNLocator(max(1, min(8, int(width / 0.7)))))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: plain(value, 4)))
    with PillowImage.open(io.BytesIO(style.to_png(figure, dpi=_DPI))) as strip:
        return np.asarray(strip.convert("RGB").resize((width_px, strip.height)))
