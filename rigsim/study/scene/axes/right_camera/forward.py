"""The right camera's place along the left camera's z axis."""

from __future__ import annotations

from rigsim.rig.quantity import FORWARD
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column, clean

AXIS = Axis(
    name="forward",
    columns=(
        Column(
            "forward_mm",
            "forward shift",
            "mm",
            "short",
            "Right camera's place along the left one's z axis, mm; + is forward.",
            empty=False,
        ),
    ),
    word="forward shift",
    read=lambda row: (clean(row.rig.right_from_left.inverse.t[2] * 1e3) + 0.0,),
    help="Shifts of the right camera, mm: positive forward.",
    help_one="Shift of the right camera: positive forward. On top of where it stands.",
    metavar="LENGTH",
    kind=FORWARD,
    scale=1e-3,
    of_rig=lambda recipe, value_m: recipe.moved(axial_m=value_m),
    loop=9,
)
