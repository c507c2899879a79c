"""The right camera's turn about its z axis."""

from __future__ import annotations

import math

from rigsim.rig.quantity import ROLL
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column, clean

AXIS = Axis(
    name="roll",
    columns=(
        Column(
            "roll_deg",
            "roll",
            "deg",
            "short",
            "Right camera's turn against the left one, about its z axis, deg; + is clockwise.",
            empty=False,
        ),
    ),
    word="roll",
    read=lambda row: (clean(math.degrees(row.rig.right_from_left.inverse.rotvec_rad[2])) + 0.0,),
    help="Turns of the right camera, deg: positive turns clockwise as it looks.",
    help_one="Turn of the right camera: positive turns clockwise as it looks. On top of the pose it has.",
    metavar="DEG",
    kind=ROLL,
    of_rig=lambda recipe, value_deg: recipe.moved(roll_rad=math.radians(value_deg)),
    loop=7,
)
