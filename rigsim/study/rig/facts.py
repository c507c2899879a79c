"""What a rig is: the numbers that tell one from another."""

from __future__ import annotations

from dataclasses import dataclass

from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from rigsim.study.rig.shape import Arrangement, arrangement, relative_turn_deg
from rigsim.study.rig.sight import DEPTHS_M, overlap_shares

PINHOLE = "pinhole"
"""The lens model of a camera that has none."""


@dataclass(frozen=True, slots=True)
class RigFacts:
    """A rig as it stands."""

    rig: StereoRig
    """The rig."""
    arrangement: Arrangement
    """How the cameras lie to each other, in the left picture's directions."""
    vergence_deg: float
    """Angle between the optical axes across, deg; positive when they meet in front."""
    pitch_deg: float
    """By which the right camera looks further up than the left one, deg."""
    roll_deg: float
    """By which it is turned clockwise against it, as it looks, deg."""
    doffs_px: float | None
    """``cx_right - cx_left`` of a rectified rig, px; None of any other."""
    overlap: tuple[tuple[float, float], ...]
    """Z along the left camera's axis, m, and the share of its picture that both show there."""


def facts_of_rig(rig: StereoRig) -> RigFacts:
    """All that is told of a rig."""
    yaw_deg, pitch_deg, roll_deg = relative_turn_deg(rig)
    return RigFacts(
        rig,
        arrangement(rig),
        0.0 - yaw_deg,
        pitch_deg,
        roll_deg,
        rig.doffs_px if rig.is_rectified else None,
        tuple(zip(DEPTHS_M, overlap_shares(rig), strict=True)),
    )


def model_of(camera: Intrinsics) -> str:
    """The name of a camera's lens model: ``pinhole``, ``brown``, ..."""
    return PINHOLE if camera.lens is None else camera.lens.model
