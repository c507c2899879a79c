"""A calibration's part in a design: what the calibration of one rig leaves of the rigs that are tried."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import rms
from rigsim.study.design import words as words
from rigsim.study.tolerance.joint.cause import CalibrationTolerance
from rigsim.study.tolerance.sensitivities import shared_points
from rigsim.theory.calibration.disparity import CalibrationDisparity
from rigsim.theory.inverse import Camera, Requirement

_FARTHEST = 3000.0
_DISTANCES = 40
_POINTS = 96
_SIZE_OFF = 1.25
"""Ratio of baselines from which it is worth a word that boards are taken to grow along."""
_VIEW_OFF = 1.1
"""The same of fields of view."""


@dataclass(frozen=True, slots=True, eq=False)
class DesignCalibration:
    """What a calibration of a rig like the one to be found leaves."""

    of: CalibrationTolerance
    """The calibration."""
    disparity: CalibrationDisparity
    """What it leaves of a disparity."""


def design_calibration(of: CalibrationTolerance) -> DesignCalibration:
    """What it leaves of a disparity at all distances, counted from the left camera.

    Raises:
        InvalidRange: its rig's cameras share nothing at any distance.
    """
    covariance = of.covariance
    rig, found = covariance.rig, []
    for baselines in np.geomspace(1.0, _FARTHEST, _DISTANCES):
        z_m = float(baselines) * rig.baseline_m
        try:
            points = shared_points(rig, z_m, _POINTS)
        except InvalidRange:
            continue
        std_m = rms(covariance.depth_std(points, from_camera=True))
        found.append((float(baselines), std_m * rig.left.fx * rig.baseline_m / z_m**2))
    if not found:
        raise InvalidRange(f"{of.name}: its rig's cameras share no part of their pictures at any distance")
    return DesignCalibration(of, CalibrationDisparity(*np.array(found).T))


def counted(requirement: Requirement, calibration: DesignCalibration) -> Requirement:
    """The requirement with what the calibration leaves in it; one that is of no depth error as it is."""
    if requirement.kind != "depth_error":
        return requirement
    return replace(requirement, calibration=calibration.disparity)


def calibration_remarks(
    calibration: DesignCalibration | None, camera: Camera, baseline_m: float
) -> Iterator[Remark]:
    """Where the rig recommended is another than the calibrated one, so that something is assumed."""
    if calibration is None:
        return
    rig, name = calibration.of.covariance.rig, calibration.of.name
    ratio = baseline_m / rig.baseline_m
    if max(ratio, 1 / ratio) > _SIZE_OFF:
        yield Remark(
            "other_baseline",
            f"{name} is of a rig with {words.size(rig.baseline_m)} of baseline, the one recommended has"
            f" {words.size(baseline_m)}: its error is carried over as px of disparity, which takes a board"
            f" and distances {ratio:.2g} times as large; rigsim calibrate plan says what yours leaves",
        )
    views = _half_view(rig), camera.width_px / 2 / camera.focal_px
    wider = views[1] / views[0]
    if max(wider, 1 / wider) > _VIEW_OFF:
        own, other = (2 * math.degrees(math.atan(view)) for view in views)
        yield Remark(
            "other_view",
            f"{name} is of a rig that sees {own:.3g}° across, the one recommended sees {other:.3g}°: its"
            " error is carried over as px at the same place of the picture, which is a guess; rigsim"
            " calibrate plan says what yours leaves",
        )


def _half_view(rig: StereoRig) -> float:
    return rig.left.width / 2 / rig.left.fx
