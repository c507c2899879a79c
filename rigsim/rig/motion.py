"""What a rig and its scene do between two pictures that are not taken at the same time."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig import given
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

MOVING = ("rig", "object")
"""What the speeds may be of."""


@dataclass(frozen=True, slots=True)
class Motion:
    """The right picture is taken `time_offset_s` after the left one; meanwhile the rig or an object moves.

    `apply` gives the one rig whose two pictures, taken at once, would be these: the calibrated rig is the
    assumed one, what comes of it the true one. Forward, down and the turn are of the rig's frame, whose z
    axis looks straight ahead and whose y axis points down; docs/explanation/motion.md derives what follows.

    Raises:
        InvalidRange: a number is none, or `moving` is neither.

    Example:
        >>> import math, rigsim
        >>> rig = rigsim.make_rig(baseline_mm=100, focal_px=1000, resolution_px=(1280, 960))
        >>> late = rigsim.Motion(0.002, turn_rate_rad_s=math.radians(30)).apply(rig)
        >>> far = [[0, 0, 1e6]]
        >>> round(float(late.project(far)[1][0, 0] - rig.project(far)[1][0, 0]), 3)  # f tan(0.06 deg)
        -1.047
    """

    time_offset_s: float
    """How much later the right picture is taken, s; negative when it is first."""
    speed_m_s: float = 0.0
    """Speed along the baseline, from the left camera to the right one, m/s."""
    forward_speed_m_s: float = 0.0
    """Speed straight ahead, m/s."""
    turn_rate_rad_s: float = 0.0
    """How fast the rig turns about its own y axis, through the middle of the baseline, rad/s; positive turns
    to the right. It is the rig that turns, whatever the speeds are of."""
    moving: str = "rig"
    """What the speeds are of: ``rig`` or ``object``."""
    vertical_speed_m_s: float = 0.0
    """Speed across the rows, down the pictures (the rig's y axis), m/s; negative is up."""

    def __post_init__(self) -> None:
        for item in fields(self):
            if item.name != "moving":
                value = given.real(getattr(self, item.name), item.name)
                if not math.isfinite(value):
                    raise InvalidRange(f"{item.name} {value}: must be a finite number")
                object.__setattr__(self, item.name, value)
        if self.moving not in MOVING:
            raise InvalidRange(f"moving {given.shown(self.moving)}: must be one of {', '.join(MOVING)}")

    def later_from_left(self, rig: StereoRig) -> Pose:
        """Maps points of the left camera's frame, as they lie when it takes its picture, to where they lie in
        that frame when the right one takes its own."""
        rig_from_left, way = rig.rig_from_left, 1.0 if self.moving == "rig" else -1.0
        along = rig_from_left.R @ rig.right_from_left.inverse.t / rig.baseline_m
        speed = self.speed_m_s * along + np.array([0.0, self.vertical_speed_m_s, self.forward_speed_m_s])
        # where the rig is, relative to things, and how it has turned
        then_from_later = Pose.from_rotvec(
            (0.0, self.turn_rate_rad_s * self.time_offset_s, 0.0), way * self.time_offset_s * speed
        )
        return rig_from_left.inverse @ then_from_later.inverse @ rig_from_left

    def apply(self, rig: StereoRig) -> StereoRig:
        """The true rig, when `rig` is the calibrated one."""
        return StereoRig(rig.left, rig.right, rig.right_from_left @ self.later_from_left(rig))
