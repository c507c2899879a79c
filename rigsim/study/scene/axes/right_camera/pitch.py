"""The right camera's turn about its x axis."""

from __future__ import annotations

import math

from rigsim.rig.quantity import PITCH
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column, clean

AXIS = Axis(
    name="pitch",
    columns=(
        Column(
            "pitch_deg",
            "pitch",
            "deg",
            "short",
            "Right camera's turn against the left one, about its x axis, deg; + is up.",
            empty=False,
        ),
    ),
    word="pitch",
    read=lambda row: (clean(math.degrees(row.rig.right_from_left.inverse.rotvec_rad[0])) + 0.0,),
    help="Turns of the right camera, deg: positive looks further up.",
    help_one="Turn of the right camera: positive looks further up. On top of the pose it has.",
    metavar="DEG",
    kind=PITCH,
    of_rig=lambda recipe, value_deg: recipe.moved(pitch_rad=math.radians(value_deg)),
    loop=6,
)
