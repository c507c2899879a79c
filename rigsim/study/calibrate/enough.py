"""From how many pictures on the calibration is no longer what matters."""

from __future__ import annotations

from collections.abc import Sequence

from rigsim.study.calibrate.depths import PLACES, DepthStd, depth_stds
from rigsim.study.calibrate.plan.result import CalibrationPlan

NOTICED = 1.05
"""Depth std by calibration and pixel noise over that by pixel noise alone, above which more pictures pay."""


def enough(plan: CalibrationPlan) -> int | None:
    """The fewest pictures whose calibration adds less than 5 % to the depth std that pixel noise makes, on
    the axis where poses are chosen for; None where none of the curve's does."""
    for point in plan.curve:
        noise_m2 = point.joint_m**2 - point.calibration_m**2
        if noise_m2 > 0 and point.joint_m**2 <= NOTICED**2 * noise_m2:
            return point.pictures
    return None


def chosen_depth(plan: CalibrationPlan) -> DepthStd:
    """What the plan leaves of the depth that its poses are chosen for, on the left optical axis."""
    return chosen_places(plan, ("axis",))[0]


def chosen_places(plan: CalibrationPlan, places: Sequence[str] = PLACES) -> tuple[DepthStd, ...]:
    """The same at several places of the picture."""
    asked = plan.asked
    return depth_stds(plan.covariance, [asked.chosen_for_m], asked.noise_px, places)
