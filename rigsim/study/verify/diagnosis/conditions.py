"""What sets the cases that a mistake breaks apart from those that it should break and does not."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from rigsim.rig.lens.distortion import BrownConrady
from rigsim.study.saying import Saying, saying
from rigsim.study.verify.case import Case

_SAME = 1e-9


class _Feature(NamedTuple):
    """A number of a case."""

    name: str
    """Short name."""
    unit: str
    """Unit of the number."""
    value: Callable[[Case], float]
    """Reads it."""


def _turn_deg(case: Case) -> float:
    return float(np.degrees(np.linalg.norm(case.rig.right_from_left.rotvec_rad)))


def _roll_deg(case: Case) -> float:
    R = case.rig.right_from_left.R
    return float(abs(np.degrees(np.arctan2(R[1, 0], R[0, 0]))))


def _outwards_deg(case: Case) -> float:
    pose = case.rig.right_from_left
    yaw = float(np.degrees(np.arctan2(pose.R[2, 0], pose.R[2, 2])))
    return yaw if pose.inverse.t[0] > 0 else -yaw


def _direction(axis: int) -> Callable[[Case], float]:
    """A component of the way to the right camera, as a share of it."""

    def share(case: Case) -> float:
        centre = case.rig.right_from_left.inverse.t
        return float(centre[axis] / np.linalg.norm(centre))

    return share


def _k1(case: Case) -> float:
    lenses = (case.rig.left.lens, case.rig.right.lens)
    return max((lens.k1 for lens in lenses if isinstance(lens, BrownConrady)), default=0.0)


def _off_axis_deg(case: Case) -> float:
    points = case.points_left
    return float(np.degrees(np.nanmax(np.arctan2(np.hypot(points[:, 0], points[:, 1]), points[:, 2]))))


_FEATURES: tuple[_Feature, ...] = (
    _Feature("turn", "deg", _turn_deg),
    _Feature("roll", "deg", _roll_deg),
    _Feature("turn-outwards", "deg", _outwards_deg),
    _Feature("baseline", "m", lambda case: case.rig.baseline_m),
    _Feature("share-of-x", "", _direction(0)),
    _Feature("share-of-y", "", lambda case: abs(_direction(1)(case))),
    _Feature("share-of-z", "", lambda case: abs(_direction(2)(case))),
    _Feature("k1", "", _k1),
    _Feature(
        "focal-difference",
        "%",
        lambda case: 100 * abs(case.rig.right.fx / case.rig.left.fx - 1),
    ),
    _Feature("principal-point-difference", "px", lambda case: abs(case.rig.right.cx - case.rig.left.cx)),
    _Feature("height-to-width", "", lambda case: case.rig.left.height / case.rig.left.width),
    _Feature("fx-fy-difference", "%", lambda case: 100 * abs(case.rig.left.fx / case.rig.left.fy - 1)),
    _Feature("off-axis", "deg", _off_axis_deg),
    _Feature("farthest-point", "m", lambda case: float(np.nanmax(case.points_left[:, 2]))),
    _Feature("nearest-point", "m", lambda case: float(np.nanmin(case.points_left[:, 2]))),
    _Feature("rows", "", lambda case: float(len(case))),
)


def set_apart(broken: Sequence[Case], spared: Sequence[Case]) -> Saying:
    """The feature that parts the cases with the widest gap; the names of the broken ones where none does.

    ``only with a turn between the cameras of 55 deg or more (up to 21 deg passes)``.

    Args:
        broken: cases that fail.
        spared: cases that pass although the mistake would break them.
    """
    broken, spared = ([case for case in cases if case.answerable.any()] for cases in (broken, spared))
    best, told = 0.0, None
    for feature in _FEATURES if broken and spared else ():
        fail, ok = ([feature.value(case) for case in cases] for cases in (broken, spared))
        for low, high, form in (
            (max(ok), min(fail), "only-with: or more"),
            (max(fail), min(ok), "only-with: or less"),
        ):
            gap = (high - low) / (abs(high) + abs(low) + _SAME)
            if high > low + _SAME and gap > best:
                at, passing = (high, low) if form == "only-with: or more" else (low, high)
                what = saying(f"feature: {feature.name}")
                best = gap
                told = saying(form, feature=what, at=_zeroed(at), passing=_zeroed(passing), unit=feature.unit)
    if told is not None:
        return told
    names = sorted({case.name for case in broken})
    return saying("only-in", names=tuple(names))


def _zeroed(value: float) -> float:
    return 0.0 if abs(value) < _SAME else value
