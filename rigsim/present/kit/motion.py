"""What moves during a time offset, and what that does, in words."""

from __future__ import annotations

import math

from rigsim.present.kit.format import length_mm, number
from rigsim.rig.motion import Motion
from rigsim.study.calc.motion import MotionAt


def motion_sentence(found: MotionAt, motion: Motion, depth_mm: float, seen: bool) -> str:
    """The answer: how wrong the depth is, by how much of disparity and rows, and about what the rig turns."""
    at = f"At {length_mm(depth_mm)}"
    shifts = (
        f"the disparity is off by {_signed(-found.along_px)} px and the rows by {_signed(found.across_px)} px"
    )
    error_mm = found.depth_error_m * 1e3
    if not seen:
        says = f"{at} the two cameras do not both see the point on the left optical axis."
    elif math.isnan(error_mm):
        says = f"{at} no depth is left: {shifts}."
    elif error_mm == 0 == found.along_px:
        says = f"{at} the depth is right: {shifts}."
    else:
        side = "large" if error_mm > 0 else "small"
        share = number(100 * abs(error_mm) / depth_mm, 2)
        says = f"{at} the depth comes out {length_mm(abs(error_mm))} ({share} %) too {side}: {shifts}."
    most_mm = found.most_depth_error_m * 1e3
    if not math.isnan(most_mm):
        says += (
            f" Over the image it is up to {length_mm(abs(most_mm))}, {number(abs(found.most_along_px))} px "
            f"and {number(abs(found.most_across_px))} px."
        )
    if motion.turn_rate_rad_s:
        side, sign = ("right", "positive") if motion.turn_rate_rad_s > 0 else ("left", "negative")
        says += f" The rig turns to the {side} ({sign} turn rate), about the middle of its baseline."
    return says


def moves(motion: Motion) -> list[str]:
    """What moves, and how: empty for nothing."""
    speeds = [
        f"{speed:g} m/s {way}"
        for speed, way in (
            (motion.speed_m_s, "along the baseline"),
            (motion.forward_speed_m_s, "straight ahead"),
            (motion.vertical_speed_m_s, "down the pictures, across the rows"),
        )
        if speed
    ]
    said = [f"the {motion.moving} moves at {' and '.join(speeds)}"] if speeds else []
    if motion.turn_rate_rad_s:
        side = "right" if motion.turn_rate_rad_s > 0 else "left"
        said.append(f"the rig turns {side} at {abs(math.degrees(motion.turn_rate_rad_s)):g} deg/s")
    return said


def motion_in_words(motion: Motion) -> str:
    """The motion, and the pictures' offset."""
    when = f"the right picture {abs(motion.time_offset_s) * 1e3:g} ms"
    when += " earlier" if motion.time_offset_s < 0 else " later"
    return f"{', '.join(moves(motion)) or 'nothing moves'}; {when}"


def _signed(value: float) -> str:
    text = number(value)
    return f"+{text}" if value > 0 and text[0].isdigit() else text
