"""The right camera's turn about its y axis."""

from __future__ import annotations

import math

from rigsim.rig.quantity import YAW
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column, clean

AXIS = Axis(
    name="yaw",
    columns=(
        Column(
            "yaw_deg",
            "yaw",
            "deg",
            "short",
            "Right camera's turn against the left one, about its y axis, deg; + is right.",
            empty=False,
        ),
    ),
    word="yaw",
    read=lambda row: (clean(math.degrees(row.rig.right_from_left.inverse.rotvec_rad[1])) + 0.0,),
    help="Turns of the right camera, deg: positive looks further right.",
    help_one="Turn of the right camera: positive looks further right. On top of the pose it has.",
    metavar="DEG",
    kind=YAW,
    of_rig=lambda recipe, value_deg: recipe.moved(yaw_rad=math.radians(value_deg)),
    loop=5,
)
