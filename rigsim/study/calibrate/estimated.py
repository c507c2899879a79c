"""What a planned calibration estimates: each free number of the rig, and what it may be off by."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rigsim.study.calibrate.plan.result import CalibrationPlan
from rigsim.theory.calibration.parameters import CAMERA


@dataclass(frozen=True, slots=True)
class Estimate:
    """One number that the calibration finds."""

    name: str
    """As of `RigParameters`."""
    value: float
    """What it is in the rig that is planned for; of the pose's turn, the rotation vector's."""
    std: float
    """Standard deviation."""
    unit: str
    """Of both: px, deg, mm; empty for a lens's coefficient."""


def estimates(plan: CalibrationPlan) -> list[Estimate]:
    """The free parameters, in their order; those that are held are left out."""
    covariance, values = plan.covariance, _values(plan)
    free = set(covariance.parameters.free_names(plan.asked.rig))
    found = []
    for name, std in zip(covariance.names, covariance.std, strict=True):
        if name in free:
            scale, unit = _measure(name)
            found.append(Estimate(name, values[name] * scale, float(std) * scale, unit))
    return found


def _values(plan: CalibrationPlan) -> dict[str, float]:
    rig, parameters = plan.asked.rig, plan.covariance.parameters
    found: dict[str, float] = {}
    for side, camera in enumerate((rig.left, rig.right)):
        lens = parameters.lens(rig, side)
        for name in parameters.names[parameters.columns(side)]:
            own = name.partition(".")[2]
            found[name] = float(getattr(camera if own in CAMERA else lens, own))
    pose, warps = rig.right_from_left, plan.asked.board.warp_m
    numbers = (*pose.rotvec_rad, *pose.t, *(warps if parameters.warped else ()))
    names = (*parameters.names[parameters.pose], *parameters.names[parameters.warp])
    return found | {name: float(value) for name, value in zip(names, numbers, strict=True)}


def _measure(name: str) -> tuple[float, str]:
    if name.endswith("_rad"):
        return math.degrees(1.0), "deg"
    if name.endswith("_m"):
        return 1e3, "mm"
    return 1.0, "px" if name.partition(".")[2] in CAMERA else ""
