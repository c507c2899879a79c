"""The lens and sensor that the pictures are taken with; their names are in `rigsim.rig.catalogue.sensors`."""

from __future__ import annotations

from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column

AXIS = Axis(
    name="sensor",
    columns=(Column("sensor", "sensor", "", "text", "Lens and sensor of the pictures.", empty=False),),
    word="sensor",
    read=lambda row: (row.sensor,),
    help="Sensors; commas.",
)
