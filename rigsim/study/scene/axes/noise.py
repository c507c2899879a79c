"""The noise of the simulated pixel positions."""

from __future__ import annotations

from dataclasses import replace

from rigsim.rig.quantity import NOISE
from rigsim.study.scene.axes.axis import Axis
from rigsim.study.scene.column import Column

AXIS = Axis(
    name="noise",
    columns=(
        Column(
            "noise_px",
            "pixel noise",
            "px",
            "short",
            "Standard deviation of one pixel coordinate, px.",
            empty=False,
        ),
    ),
    word="noise",
    read=lambda row: (row.noise.std_px,),
    help="Noise per pixel coordinate, px standard deviation.",
    kind=NOISE,
    default="0.25",
    of_noise=lambda noise, value_px: replace(noise, std_px=value_px),
)
