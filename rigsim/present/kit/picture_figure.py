"""Pictures as figures."""

from __future__ import annotations

from matplotlib.figure import Figure

from rigsim.present.kit import style
from rigsim.rig.arrays import Image

_TITLE_IN = 0.35


def picture_figure(picture: Image, title: str) -> Figure:
    """A picture (H, W, 3) as wide as a page, with a heading."""
    with style.styled():
        height, width = picture.shape[:2]
        height_in = style.PAGE_WIDTH_IN * height / width
        figure = style.new_figure(style.PAGE_WIDTH_IN, height_in + _TITLE_IN)
        axes = style.place(figure, 0.0, 0.0, style.PAGE_WIDTH_IN, height_in)
        axes.imshow(picture)
        axes.set_axis_off()
        axes.set_title(title)
    return figure
