"""What a placed rig really has of each requirement: from its points, its pictures and its rays.

None of it uses the formulas that the rig was found by. A depth error is held to the simulated points nearest
its distance: each may err by what is asked for times (its depth / that distance) squared, and the RMS (or the
95th percentile) of all of them is compared. The matches found in the pictures are held to the same. What a
rig sees at a distance is found by projecting: points of the scene near that distance where it has them, a
plane there where it has not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from rigsim.rig.arrays import Array, Ids
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import abs_p95
from rigsim.theory.inverse import Requirement
from rigsim.theory.triangulation import triangulate

if TYPE_CHECKING:
    from rigsim.study.scene.third_witness import MeasuredMatches

FEWEST_POINTS = 100
"""Simulated points that a depth error is held to at least."""
FEWEST_MATCHES = 30
"""Matches, or points of the scene, that say something about a distance at least."""
_WINDOW = 1.25  # points within this factor of the distance
_REACH = 2.0  # farther off than this factor, points say nothing about the distance
_PLANE_SAMPLES = 1 << 16
_SIGMAS = 2.0  # standard errors that a measurement may miss by
_MORE_SIGMAS = 3.0  # by so many it is more than was simulated: no more than once in 700 by chance
# standard error of an RMS and of a 95th percentile of |e|, over themselves, times sqrt(n); e normal
_RMS_SE, _P95_SE = 1 / math.sqrt(2), 0.951


@dataclass(frozen=True, slots=True, eq=False)
class RigInScene:
    """All that is known of a rig in a scene."""

    rig: StereoRig
    """The rig as it was placed."""
    centres_apart_m: float
    """Distance of the two cameras in the scene, m."""
    picture_px: tuple[int, int]
    """Width and height of the pictures drawn, px."""
    points_left: Array
    """Simulated points, (N, 3), m; seen by both cameras."""
    depth_rmse_m: Array
    """RMS depth error of each over its trials, (N,), m."""
    noise: PixelNoise
    """Noise of the simulation."""
    n_trials: int
    """Trials of each point."""
    measured: MeasuredMatches | None
    """Matches found in the pictures; None where nothing was measured."""


@dataclass(frozen=True, slots=True)
class RequirementCheck:
    """One requirement and what the rig has of it."""

    requirement: Requirement
    """What was asked for."""
    simulated: float
    """What the rig has, in the unit of the requirement's limit; NaN where nothing says so."""
    shown_by: Literal["points", "plane", "rays", "pictures", "cameras"]
    """What says so: points, plane, rays, pictures or cameras."""
    n_points: int = 0
    """Points of the scene it rests on, where it rests on them."""
    nearest_m: float = math.nan
    """Depth of the nearest of them, m."""
    farthest_m: float = math.nan
    """Depth of the farthest of them, m."""
    slack: float = 0.0
    """How coarsely `simulated` was found, in its unit."""
    measured: float = math.nan
    """The same from the pixels, for depth errors; NaN where too little was matched near the distance."""
    n_measured: int = 0
    """Matches near the distance."""
    points: frozenset[int] = field(default=frozenset(), repr=False)
    """Which of the sight's points a depth error rests on: two requirements may share them."""
    matches: frozenset[int] = field(default=frozenset(), repr=False)
    """Which of its matches, likewise."""

    @property
    def is_widened(self) -> bool:
        """Whether some of the points lie beyond a factor of 1.25 of the distance, for want of nearer ones."""
        if self.shown_by != "points" or not self.n_points:
            return False
        at_m = self.requirement.depth_m
        return max(at_m / self.nearest_m, self.farthest_m / at_m) > _WINDOW * (1 + 1e-9)

    @property
    def is_met(self) -> bool:
        """Whether the rig has what was asked for; never where nothing says so."""
        return self.requirement.is_met(
            self.simulated + (self.slack if self.requirement.at_least else -self.slack)
        )

    @property
    def is_missed_by_pixels(self) -> bool:
        """Whether the measured error is too large by more than two of its standard errors."""
        return self._is_measured_over(self.requirement.limit, _SIGMAS)

    @property
    def is_more_in_pixels(self) -> bool:
        """Whether the measured error is more than the simulated one by more than chance, kept or not: what
        is found in the pictures is noisier than what was assumed."""
        return self._is_measured_over(self.simulated, _MORE_SIGMAS)

    def _is_measured_over(self, value: float, sigmas: float) -> bool:
        if not self.n_measured or math.isnan(self.measured) or math.isnan(value):
            return False
        relative_se = (_RMS_SE if self.requirement.per_std == 1 else _P95_SE) / math.sqrt(self.n_measured)
        return self.measured > value * (1 + sigmas * relative_se)


def check(asked: Requirement, sight: RigInScene, rng: np.random.Generator) -> RequirementCheck:
    """Hold a rig to one requirement; `rng` draws the trials of a percentile."""
    rig = sight.rig
    match asked.kind:
        case "depth_error":
            return _with_measured(_depth_error(asked, sight, rng), sight)
        case "max_disparity" | "far_disparity":
            return _disparity(asked, sight)
        case "overlap" | "cover":
            return _plane(asked, rig)
        case "cover_height":
            return _plane_down(asked, rig)
        case "fov" | "vfov":
            down = asked.kind == "vfov"
            return RequirementCheck(asked, min(_fov_rad(rig.left, down), _fov_rad(rig.right, down)), "rays")
        case "pixels":
            return RequirementCheck(asked, float(math.prod(sight.picture_px)), "pictures")
        case "max_baseline" | "min_baseline":
            return RequirementCheck(asked, sight.centres_apart_m, "cameras")


def nearest_points(depth_m: Array, at_m: float, fewest: int) -> Ids:
    """Places of the depths (N,) within 1.25 of `at_m`, or the nearest `fewest` within 2; else none."""
    away = np.abs(np.log(depth_m / at_m))
    order = np.argsort(away, kind="stable")
    count = max(int((away <= math.log(_WINDOW)).sum()), fewest)
    chosen = order[:count]
    chosen = chosen[away[chosen] <= math.log(_REACH)]
    return np.asarray(chosen if len(chosen) >= fewest else chosen[:0], dtype=np.int32)


def _depth_error(asked: Requirement, sight: RigInScene, rng: np.random.Generator) -> RequirementCheck:
    known = np.flatnonzero(np.isfinite(sight.depth_rmse_m))
    points, rmse_m = sight.points_left[known], sight.depth_rmse_m[known]
    chosen = nearest_points(points[:, 2], asked.depth_m, FEWEST_POINTS)
    if not len(chosen):
        return RequirementCheck(asked, math.nan, "points")
    depth_m = points[chosen, 2]
    scale = (depth_m / asked.depth_m) ** 2
    if asked.per_std == 1:
        error_m = math.sqrt(float(np.mean(rmse_m[chosen] ** 2)) / float(np.mean(scale**2)))
    else:
        error_m = _p95_m(points[chosen], scale, sight, rng)
    near_m, far_m = float(depth_m.min()), float(depth_m.max())
    places = frozenset(known[chosen].tolist())
    whole_m = _with_calibration(asked, error_m, rig=sight.rig)
    return RequirementCheck(asked, whole_m, "points", len(chosen), near_m, far_m, points=places)


def _with_calibration(asked: Requirement, error_m: float, *, rig: StereoRig) -> float:
    """A depth error as seen, and what a calibration leaves where one is counted: the scene's is exact."""
    return math.hypot(error_m, asked.of_calibration(rig.left.fx, rig.baseline_m))


def _p95_m(points_left: Array, scale: Array, sight: RigInScene, rng: np.random.Generator) -> float:
    """95th percentile of |depth error| over points and trials, each scaled to the requirement's distance."""
    shape = (sight.n_trials, len(points_left), 2)
    uv_left, uv_right = (np.broadcast_to(uv, shape) for uv in sight.rig.project(points_left))
    noisy_left, noisy_right = sight.noise.apply(uv_left, uv_right, rng)
    found = triangulate(sight.rig, noisy_left.reshape(-1, 2), noisy_right.reshape(-1, 2))[:, 2]
    error_m = np.abs(found.reshape(shape[:2]) - points_left[:, 2]) / scale
    return abs_p95(np.where(np.isfinite(error_m), error_m, math.inf))


def _with_measured(held: RequirementCheck, sight: RigInScene) -> RequirementCheck:
    measured, asked = sight.measured, held.requirement
    if measured is None or not len(measured.outlier):
        return held
    near = np.abs(np.log(measured.points_left[:, 2] / asked.depth_m)) <= math.log(_WINDOW)
    kept = near & ~measured.outlier
    if kept.sum() < FEWEST_MATCHES:
        return held
    depth_m = measured.points_left[kept, 2]
    found = triangulate(sight.rig, measured.uv_left[kept], measured.uv_right[kept])
    error_m, scale = found[:, 2] - depth_m, (depth_m / asked.depth_m) ** 2
    if asked.per_std == 1:
        size_m = math.sqrt(float(np.mean(error_m**2)) / float(np.mean(scale**2)))
    else:
        size_m = abs_p95(error_m / scale)
    places = frozenset(np.flatnonzero(kept).tolist())
    size_m = _with_calibration(asked, size_m, rig=sight.rig)
    return replace(held, measured=size_m, n_measured=len(places), matches=places)


def _disparity(asked: Requirement, sight: RigInScene) -> RequirementCheck:
    """The largest disparity at a distance, or the smallest over its standard deviation."""
    near = np.abs(np.log(sight.points_left[:, 2] / asked.depth_m)) <= math.log(_WINDOW)
    points = sight.points_left[near]
    shown_by: Literal["points", "plane"] = "points"
    n_points = len(points)
    if n_points < FEWEST_MATCHES:
        points, shown_by, n_points = plane(sight.rig, asked.depth_m), "plane", 0
    uv_left, uv_right = sight.rig.project(points)
    # a disparity goes with one over the depth
    disparity_px = (uv_left - uv_right)[:, 0] * points[:, 2] / asked.depth_m
    if asked.kind == "max_disparity":
        value = float(disparity_px.max())
    else:
        value = float(disparity_px.min()) / sight.noise.disparity_std_px
    return RequirementCheck(
        asked, value, shown_by, n_points, float(points[:, 2].min()), float(points[:, 2].max())
    )


def _plane(asked: Requirement, rig: StereoRig) -> RequirementCheck:
    """What both cameras see of a plane: share of the left image's columns, or metres."""
    points = plane(rig, asked.depth_m)
    seen = rig.right.contains(rig.project(points)[1])
    if asked.kind == "overlap":
        return RequirementCheck(asked, float(seen.mean()), "plane", slack=2 / len(points))
    step_m = float(points[1, 0] - points[0, 0])
    return RequirementCheck(asked, float(seen.sum()) * step_m, "plane", slack=2 * step_m)


def _plane_down(asked: Requirement, rig: StereoRig) -> RequirementCheck:
    """What both cameras see of a plane from top to bottom, m: down the middle of what both see across."""
    across = plane(rig, asked.depth_m)
    shared = across[rig.right.contains(rig.project(across)[1])]
    if not len(shared):
        return RequirementCheck(asked, 0.0, "plane")
    u = float(rig.project(shared)[0][:, 0].mean())
    points = _on_plane(rig, _middles(rig.left.height), asked.depth_m, u)
    seen = rig.right.contains(rig.project(points)[1])
    step_m = float(points[1, 1] - points[0, 1])
    return RequirementCheck(asked, float(seen.sum()) * step_m, "plane", slack=2 * step_m)


def plane(rig: StereoRig, depth_m: float) -> Array:
    """Points (N, 3) m at one depth, evenly along the left image's middle row, from edge to edge."""
    return _on_plane(rig, _middles(rig.left.width), depth_m)


def _middles(length_px: int) -> Array:
    return (np.arange(_PLANE_SAMPLES) + 0.5) / _PLANE_SAMPLES * length_px - 0.5


def _on_plane(rig: StereoRig, px: Array, depth_m: float, column_px: float | None = None) -> Array:
    """Along the middle row, or down a column."""
    lens = rig.left
    if column_px is None:
        uv = np.column_stack([px, np.full(len(px), lens.cy)])
    else:
        uv = np.column_stack([np.full(len(px), column_px), px])
    return np.column_stack([lens.normalize(uv) * depth_m, np.full(len(px), depth_m)])


def _fov_rad(lens: Intrinsics, down: bool = False) -> float:
    """Angle between the rays through the borders of the middle row, or of the middle column, rad."""
    if down:
        edges = lens.normalize([[lens.cx, -0.5], [lens.cx, lens.height - 0.5]])
    else:
        edges = lens.normalize([[-0.5, lens.cy], [lens.width - 0.5, lens.cy]])
    left, right = np.column_stack([edges, np.ones(2)])
    return math.atan2(float(np.linalg.norm(np.cross(left, right))), float(left @ right))
