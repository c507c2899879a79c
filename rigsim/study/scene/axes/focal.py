"""The focal length."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column, clean

if TYPE_CHECKING:
    from rigsim.study.scene.recipe import Recipe


def _change(recipe: Recipe, focal_px: float) -> Recipe:
    from rigsim.study.scene.recipe import with_focal

    return recipe.lenses(lambda lens: with_focal(lens, focal_px))


AXIS = Axis(
    name="focal",
    columns=(Column("focal_px", "focal length", "px", "short", "Focal length, px.", empty=False),),
    word="focal length",
    read=lambda row: (clean(row.rig.left.fx),),
    help="Focal lengths, px; or mm with --sensor-width or --pixel-pitch.",
    help_one="Focal length: 1200 (px), or 6mm with --sensor-width or --pixel-pitch.",
    metavar="FOCAL",
    of_rig=_change,
    loop=1,
    field="focals_px",
)
