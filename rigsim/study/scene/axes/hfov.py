"""The horizontal field of view."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rigsim.rig.quantity import HFOV
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column, clean

if TYPE_CHECKING:
    from rigsim.rig.intrinsics import Intrinsics
    from rigsim.study.scene.recipe import Recipe


def _change(recipe: Recipe, hfov_deg: float) -> Recipe:
    from rigsim.study.scene.recipe import with_focal

    def lens(before: Intrinsics) -> Intrinsics:
        return with_focal(before, type(before).from_hfov(before.width, before.height, hfov_deg).fx)

    return recipe.lenses(lens)


AXIS = Axis(
    name="hfov",
    columns=(
        Column(
            "hfov_deg", "field of view", "deg", "angle", "Horizontal field of view, degrees.", empty=False
        ),
    ),
    word="field of view",
    read=lambda row: (clean(row.rig.left.hfov_deg),),
    help="Horizontal fields of view, deg.",
    help_one="Horizontal field of view, instead of --focal.",
    metavar="DEG",
    kind=HFOV,
    of_rig=_change,
    loop=2,
    field="hfovs_deg",
)
