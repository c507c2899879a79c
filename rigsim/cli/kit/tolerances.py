"""Options of what a built rig may be off by."""

from __future__ import annotations

from typing import Annotated

import typer

ToleranceWord = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=VALUE",
        help="One tolerance, in place of the class's: yaw, pitch, roll (deg), baseline, axial, vertical"
        " (mm), focal, focal-left, focal-both, principal, principal-v, principal-left, principal-left-v"
        " (px), k1-right, k1-left, k1-both, time (ms), temperature (K). One standard deviation, or a"
        " bound as +-VALUE. Repeatable.",
    ),
]

MaxRowError = Annotated[
    str | None,
    typer.Option(
        metavar="PX",
        help="Largest row misalignment of one rig's rectified pair as well, root mean square over the image,"
        " at every distance of the range: 0.5px, for a matcher that searches along rows.",
    ),
]
