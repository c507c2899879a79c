"""What a plan is asked for."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rigsim.errors import InvalidRange
from rigsim.rig.board import Board
from rigsim.rig.stereo import StereoRig
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.parameters import RigParameters

LEAST_POSES = 2
MOST_POSES = 200
"""Pictures by each camera that a plan has."""


MOST_CORNER_PX = 10.0
"""Noise of a corner beyond which nothing was found at all."""
FARTHEST_M = 1e4
"""Beyond, no stereo rig measures anything."""


def _within(value: float, name: str, unit: str, above: float | None = None, most: float = math.inf) -> None:
    low_enough = value > above if above is not None else value >= 0
    if not (low_enough and value < math.inf):
        bound = f"> {above:g}" if above is not None else ">= 0"
        raise InvalidRange(f"{name} {value:g} {unit}: must be {bound} and finite")
    if value > most:
        raise InvalidRange(f"{name} {value:g} {unit}: must be <= {most:g} {unit}")


def check_depth(z_m: float) -> None:
    """Refuse a depth that no rig measures.

    Raises:
        InvalidRange: it is not above 0, or too large.
    """
    _within(z_m * 1e3, "depth", "mm", above=0)
    if z_m > FARTHEST_M:
        raise InvalidRange(f"depth {z_m:g} m: must be <= {FARTHEST_M / 1e3:g} km")


@dataclass(frozen=True, slots=True)
class Reach:
    """Where somebody can hold the board."""

    near_m: float = 0.4
    """Least distance of the board's middle from the left camera, m."""
    far_m: float = 1.2
    """Largest one."""
    tilt_rad: float = math.radians(40)
    """Most that a board is turned away from the camera, rad."""
    margin_px: float = 10.0
    """What a corner keeps from the picture's rim, px: a finder needs its surroundings."""

    def __post_init__(self) -> None:
        if not 0 < self.near_m <= self.far_m < math.inf:
            raise InvalidRange(
                f"board range {self.near_m * 1e3:g}:{self.far_m * 1e3:g} mm: must be 0 < near <= far"
            )
        if not 0 <= self.tilt_rad < math.pi / 2:
            raise InvalidRange(f"tilt {math.degrees(self.tilt_rad):g} deg: must be >= 0 and below 90")
        if not 0 <= self.margin_px < math.inf:
            raise InvalidRange(f"margin {self.margin_px:g} px: must be >= 0")


@dataclass(frozen=True, slots=True)
class DepthGoal:
    """How well a depth is to be known, by calibration and pixel noise together."""

    error_m: float
    """Largest standard deviation, m."""
    z_m: float
    """At this depth, on the left optical axis, m."""

    def __post_init__(self) -> None:
        _within(self.error_m * 1e3, "depth error", "mm", above=0)
        check_depth(self.z_m)


@dataclass(frozen=True, slots=True, eq=False)
class PlanAsked:
    """A calibration that is to be planned."""

    rig: StereoRig
    """The rig, its lenses in the models of `parameters`."""
    parameters: RigParameters
    """What the calibration estimates."""
    board: Board
    """What is held into the pictures."""
    poses: BoardPoses | int = 20
    """Where it is held, or how many places are to be chosen."""
    reach: Reach = Reach()
    """Where it can be held."""
    corner_noise_px: float = 0.1
    """Standard deviation of one coordinate of a found corner, px."""
    noise_px: float = 0.25
    """Standard deviation of one coordinate of a match when the rig measures, px."""
    flatness_m: float = 0.0
    """Standard deviation of the board's two warps, m, when the calibration takes it for flat, or knows that
    much beforehand of a warp that it looks for."""
    goal: DepthGoal | None = None
    """What the depth is wanted to."""
    at_m: tuple[float, ...] = (1.0, 2.0, 3.0, 5.0)
    """Depths that are told, m."""
    seed: int = 0
    """Of the random numbers."""

    def __post_init__(self) -> None:
        if isinstance(self.poses, int) and not LEAST_POSES <= self.poses <= MOST_POSES:
            raise InvalidRange(
                f"{self.poses} poses: must be {LEAST_POSES} to {MOST_POSES}; one leaves a rig's numbers open"
            )
        _within(self.corner_noise_px, "corner noise", "px", above=0, most=MOST_CORNER_PX)
        _within(self.noise_px, "noise", "px")
        _within(self.flatness_m * 1e3, "flatness", "mm")
        if not self.at_m:
            raise InvalidRange("no depth to tell: must be one at least")
        for z_m in self.at_m:
            check_depth(z_m)

    @property
    def chosen_for_m(self) -> float:
        """The depth that poses are chosen for, m: the goal's, or the middle one told."""
        return self.at_m[len(self.at_m) // 2] if self.goal is None else self.goal.z_m
