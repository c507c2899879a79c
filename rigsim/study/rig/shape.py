"""How the two cameras of a rig stand to each other."""

from __future__ import annotations

import math
from typing import Literal, TypeAlias

import numpy as np

from rigsim.rig.stereo import StereoRig

Arrangement: TypeAlias = Literal["horizontal", "vertical", "diagonal"]

_STEEP = math.tan(math.radians(22.5))


def relative_turn_deg(rig: StereoRig) -> tuple[float, float, float]:
    """Yaw, pitch and roll, deg, of the right camera as seen from the left one.

    Turns of its body, yaw first, then pitch about its new x axis, then roll about its new optical axis, with
    `Perturbation`'s signs: yaw positive looks further right, pitch further up, roll clockwise as it looks.
    ``-yaw`` is `StereoRig.vergence_deg`.
    """
    R = rig.right_from_left.R.T  # the right camera's axes are its columns, in the left camera's frame
    yaw = math.atan2(R[0, 2], R[2, 2])
    pitch = math.asin(min(max(-R[1, 2], -1.0), 1.0))
    roll = math.atan2(R[1, 0], R[1, 1])
    return math.degrees(yaw) + 0.0, math.degrees(pitch) + 0.0, math.degrees(roll) + 0.0  # no -0


def arrangement(rig: StereoRig) -> Arrangement:
    """Where the right camera lies beside, above, below or aslant of the left one, as the left one's rows and
    columns go: within 22.5 deg of a row or of a column; what it lies ahead does not count."""
    x, y, _ = np.abs(rig.right_from_left.inverse.t)
    if y <= _STEEP * x:
        return "horizontal"
    return "vertical" if x <= _STEEP * y else "diagonal"


def sides_exchanged(rig: StereoRig) -> bool:
    """Whether both cameras of a horizontal pair see the other one on the wrong side."""
    right_in_left, left_in_right = rig.right_from_left.inverse.t, rig.right_from_left.t
    sideways = all(abs(place[0]) == np.abs(place).max() for place in (right_in_left, left_in_right))
    return bool(sideways and right_in_left[0] < 0 < left_in_right[0])
