"""The distance between the cameras."""

from __future__ import annotations

from dataclasses import replace

from rigsim.rig.quantity import BASELINE
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column, clean

AXIS = Axis(
    name="baseline",
    columns=(
        Column("baseline_mm", "baseline", "mm", "short", "Distance between the cameras, mm.", empty=False),
    ),
    word="baseline",
    read=lambda row: (clean(row.rig.baseline_m * 1e3),),
    help="Baselines, mm: 50:500 (10 values), 50:500:25, 50:500/4, 60,120, 0.12m.",
    help_one="Distance between the cameras: 150 (mm), 15cm, 0.15m.",
    metavar="LENGTH",
    kind=BASELINE,
    scale=1e-3,
    of_rig=lambda recipe, value_m: replace(recipe, baseline_m=value_m),
    loop=4,
    field="baselines_m",
)
