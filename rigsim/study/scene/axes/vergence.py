"""The toe-in angle between the two optical axes."""

from __future__ import annotations

from dataclasses import replace

from rigsim.rig.quantity import VERGENCE
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column, clean

AXIS = Axis(
    name="vergence",
    columns=(
        Column(
            "vergence_deg",
            "vergence",
            "deg",
            "short",
            "Toe-in angle between the optical axes, degrees.",
            empty=False,
        ),
    ),
    word="vergence",
    read=lambda row: (clean(row.rig.vergence_deg) + 0.0,),
    help="Toe-in angles, deg.",
    help_one="Toe-in angle between the two optical axes.",
    metavar="DEG",
    kind=VERGENCE,
    of_rig=lambda recipe, value_deg: replace(recipe, vergence_deg=value_deg),
    loop=3,
    field="vergences_deg",
)
