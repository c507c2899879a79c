"""What a plan says."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.remark import Remark
from rigsim.study.calibrate.depths import DepthStd
from rigsim.study.calibrate.plan.asked import PlanAsked
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.covariance import CalibrationCovariance


@dataclass(frozen=True, slots=True)
class CurvePoint:
    """What so many pictures leave of the depth at `PlanAsked.chosen_for_m`, on the axis."""

    pictures: int
    """Pictures by each camera."""
    calibration_m: float
    """Standard deviation from the calibration alone, m, with the plan's poses, best first; infinite where
    they leave it open."""
    random_m: float
    """The same with as many poses at random: the median of several draws; infinite likewise."""
    joint_m: float
    """With the pixel noise of a match, of the plan's poses."""


@dataclass(frozen=True, slots=True, eq=False)
class NextPose:
    """Where one more board does the most."""

    left_from_board: Array
    """Rotation vector, rad, and translation, m, (6,)."""
    seen: tuple[bool, bool]
    """Whether the left and the right camera see it whole."""
    gain: float
    """Depth std from the calibration with it over the one without."""


@dataclass(frozen=True, slots=True)
class Remedy:
    """Something that could be done about a goal that no number of pictures meets."""

    code: str
    """What is changed: ``tilt`` (to 45 deg), ``board`` (twice as large), ``range`` (from half the nearest
    distance on), ``corner_noise`` (half of it), ``flatness`` (a flat board)."""
    joint_m: float
    """The depth std with it and the most pictures, noise of a match included, m."""


@dataclass(frozen=True, slots=True)
class PicturesNeeded:
    """How many pictures the goal takes."""

    count: int | None
    """The fewest; None where no number of them does, or none was asked for."""
    hindrance: str = ""
    """Code of what stands in the way: ``observation`` (pixel noise alone is above), or that of the remedy
    that helps the most; empty where nothing does."""
    observation_m: float = math.nan
    """Depth std at the goal's depth from the noise of a match alone, m."""
    most_pictures_m: float = math.nan
    """Joint depth std with `MOST_POSES` pictures where those do not meet the goal, m."""
    remedies: tuple[Remedy, ...] = ()
    """What was tried then, the most helpful first."""


@dataclass(frozen=True, slots=True)
class Inseparable:
    """Two parameters that the boards hardly tell apart."""

    first: str
    second: str
    correlation: float


@dataclass(frozen=True, slots=True, eq=False)
class CalibrationPlan:
    """A planned calibration, and what it leaves."""

    asked: PlanAsked
    """What was asked for."""
    poses: BoardPoses
    """Where the board is held, best first unless they were given."""
    seen: Mask
    """Which cameras see each whole, (n, 2)."""
    covariance: CalibrationCovariance
    """What the pictures leave of the rig."""
    depths: tuple[DepthStd, ...]
    """What that does to depths."""
    curve: tuple[CurvePoint, ...]
    """How the depth follows the number of pictures."""
    needed: PicturesNeeded
    """How many meet the goal."""
    next_pose: NextPose | None
    """Where one more board does the most; None where no place that can be reached helps."""
    inseparable: tuple[Inseparable, ...]
    """Pairs of parameters that are correlated the most, the strongest first."""
    remarks: tuple[Remark, ...]
    """What is odd about it."""
