"""The right camera's place along the left camera's y axis."""

from __future__ import annotations

from rigsim.rig.quantity import VERTICAL
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column, clean

AXIS = Axis(
    name="vertical",
    columns=(
        Column(
            "vertical_mm",
            "vertical shift",
            "mm",
            "short",
            "Right camera's place along the left one's y axis, mm; + is down.",
            empty=False,
        ),
    ),
    word="vertical shift",
    read=lambda row: (clean(row.rig.right_from_left.inverse.t[1] * 1e3) + 0.0,),
    help="Shifts of the right camera, mm: positive down.",
    help_one="Shift of the right camera: positive down. On top of where it stands.",
    metavar="LENGTH",
    kind=VERTICAL,
    scale=1e-3,
    of_rig=lambda recipe, value_m: recipe.moved(vertical_m=value_m),
    loop=8,
)
