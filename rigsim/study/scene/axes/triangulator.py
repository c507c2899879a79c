"""The method under test; its names are in `rigsim.study.triangulators.registry`."""

from __future__ import annotations

from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column

AXIS = Axis(
    name="triangulator",
    columns=(Column("triangulator", "triangulator", "", "text", "The method under test.", empty=False),),
    word="triangulator",
    read=lambda row: (row.triangulator,),
    help="Triangulators; commas.",
)
