"""The size of the pictures: the lens stays, and its focal length in px grows with the width."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from rigsim.errors import InvalidRange
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column

if TYPE_CHECKING:
    from rigsim.rig.intrinsics import Intrinsics
    from rigsim.study.scene.recipe import Recipe


def _change(recipe: Recipe, size: tuple[int, int]) -> Recipe:
    return recipe.lenses(lambda lens: _behind(lens, *size))


def _behind(lens: Intrinsics, width: int, height: int) -> Intrinsics:
    """The lens behind another pixel grid; the principal point keeps its place."""
    if width < 1 or height < 1:
        raise InvalidRange(f"resolution {width}x{height}: both sides must be >= 1 px")
    # square growth: the width sets the scale, the height is cropped or extended evenly
    scale = width / lens.width
    return replace(
        lens,
        width=width,
        height=height,
        fx=lens.fx * scale,
        fy=lens.fy * scale,
        cx=(lens.cx - (lens.width - 1) / 2) * scale + (width - 1) / 2,
        cy=(lens.cy - (lens.height - 1) / 2) * scale + (height - 1) / 2,
    )


AXIS = Axis(
    name="resolution",
    columns=(
        Column("width_px", "image width", "px", "short", "Image width, px.", empty=False, whole=True),
        Column("height_px", "image height", "px", "short", "Image height, px.", empty=False, whole=True),
    ),
    word="image width",
    read=lambda row: (row.rig.left.width, row.rig.left.height),
    help="Image sizes: 640x480,1280x960.",
    help_one="Image size, px: 1280x960.",
    metavar="WxH",
    of_rig=_change,
    loop=0,
    field="resolutions_px",
)
