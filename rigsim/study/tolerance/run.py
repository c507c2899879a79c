"""Thousands of rigs built within tolerance, each measured with the one that was assumed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig import extent
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.built import DepthErrors, Rigs, depth_errors, draw
from rigsim.study.tolerance.judge import make_judge
from rigsim.study.tolerance.recalibration.compensator import Compensator
from rigsim.study.tolerance.recalibration.session import Build, Recalibration, make_compensator
from rigsim.study.tolerance.sensitivities import (
    BuildRequirement,
    Causes,
    Sensitivity,
    Tolerances,
    causes,
    sensitivities,
    shared_points,
)

if TYPE_CHECKING:
    from rigsim.study.tolerance.sobol import Interactions

__all__ = [
    "Build",
    "DepthErrors",
    "Recalibration",
    "Rigs",
    "ToleranceResult",
    "draw",
    "make_compensator",
    "run_tolerance",
]


@dataclass(frozen=True, slots=True, eq=False)
class ToleranceResult:
    """What must be held how tightly, and how many rigs are good."""

    rig: StereoRig
    """The assumed rig."""
    tolerances: Tolerances
    """What it may be off by."""
    required: BuildRequirement
    """What it is judged by."""
    recalibration: Recalibration | None
    """What the compensator had; None for none."""
    sensitivities: tuple[Sensitivity, ...]
    """The worst first."""
    depths: tuple[DepthErrors, ...]
    """Near to far; the requirement's is among them."""
    interactions: Interactions | None
    """Sobol indices at the judged depth; None where a rig of theirs loses a point, none errs,
    or they were not asked for."""
    n_rigs: int
    """Rigs built."""
    n_points: int
    """Points each was judged by, over all depths."""
    known_lengths_m: tuple[float, ...] = ()
    """Lengths that the compensator knows: three across the image, near to far, and one along the depth; none
    without one."""
    noise_px: float = 0.0
    """Standard deviation of one pixel coordinate when rigs measure, px."""

    @property
    def judged(self) -> DepthErrors:
        """The depth of the requirement."""
        return next(item for item in self.depths if item.depth_m == self.required.depth_m)

    @property
    def rows_worst(self) -> DepthErrors:
        """The depth at which rows are farthest apart, as built."""
        return max(self.depths, key=lambda item: item.built.row_rms_px)

    def rows_px(self, state: str) -> Array | None:
        """The largest row misalignment (n,) px of each rig over the depths: ``built``, ``recalibrated`` or
        ``informed``; None without such a recalibration."""
        found: list[Rigs | None] = [getattr(item, state) for item in self.depths]
        known = [rigs.row_px for rigs in found if rigs is not None]
        return np.asarray(np.max(known, axis=0)) if known else None

    @property
    def calibration_axis_m(self) -> tuple[float, float]:
        """Standard deviation, m, of a depth on the left axis at the judged distance that a calibration
        leaves: as the left camera counts it, and against its boards; NaN without one."""
        calibration = self.tolerances.calibration
        if calibration is None:
            return math.nan, math.nan
        point = [[0.0, 0.0, self.required.depth_m]]
        in_camera = calibration.covariance.depth_std(point, from_camera=True)
        return float(in_camera[0]), float(calibration.covariance.depth_std(point)[0])

    @property
    def yield_before(self) -> float:
        """Share of rigs that meet the requirement as built, with pixel noise."""
        return float(self.judged.built.good.mean())

    @property
    def yield_after(self) -> float | None:
        """Share of rigs that meet it after a recalibration that knows nothing beforehand."""
        return None if self.judged.recalibrated is None else float(self.judged.recalibrated.good.mean())

    @property
    def yield_informed(self) -> float | None:
        """The same after a recalibration that knows the tolerances beforehand."""
        return None if self.judged.informed is None else float(self.judged.informed.good.mean())


def run_tolerance(
    build: Build,
    required: BuildRequirement,
    range_m: tuple[float, float],
    *,
    n_rigs: int = 10_000,
    n_points: int = 500,
    seed: int = 0,
    with_interactions: bool = True,
) -> ToleranceResult:
    """Rank the tolerances, build `n_rigs` within them, and count those that meet the requirement.

    Args:
        build: what is built, and how it is used.
        required: depth error and distance.
        range_m: near and far end; the middle is half way.
        n_rigs: rigs to build.
        n_points: points over all depths.
        seed: of the random numbers.
        with_interactions: find the Sobol indices too.

    Raises:
        InvalidRange: no tolerance, a range or count that cannot be, or a depth that not both cameras see.
    """
    depths_m = _depths_m(range_m, required)
    extent.BUILT_RIGS.check(n_rigs)
    extent.JUDGED_POINTS.check(n_points)
    if n_points < 4 * len(depths_m):
        raise InvalidRange(f"points {n_points}: must be >= {4 * len(depths_m)}, 4 a depth")
    rig, noise_px = build.rig, build.noise_px
    off = causes(rig, build.tolerances)
    per_depth = math.ceil(n_points / len(depths_m))
    planes = {depth: shared_points(rig, depth, per_depth) for depth in depths_m}
    rng = np.random.default_rng(seed)
    built = draw(off, n_rigs, rng)
    compensators = _compensators(build, off, range_m)
    judges = [make_judge(rig, points, required, noise_px) for points in planes.values()]
    found = None
    if with_interactions:
        from rigsim.study.tolerance.sobol import interactions  # half a second of scipy.stats

        found = interactions(rig, off, planes[required.depth_m], np.random.default_rng([seed, 1]))
    return ToleranceResult(
        rig,
        build.tolerances,
        required,
        build.recalibration,
        tuple(sensitivities(rig, off, planes, required, noise_px)),
        depth_errors(rig, off, planes, judges, built, compensators, rng),
        found,
        n_rigs,
        sum(map(len, planes.values())),
        tuple(compensators[0].lengths_m.tolist()) if compensators else (),
        noise_px,
    )


def _depths_m(range_m: tuple[float, float], required: BuildRequirement) -> list[float]:
    """Depths at which rigs are judged, near to far."""
    near_m, far_m = range_m
    if not 0 < near_m < far_m < math.inf:
        raise InvalidRange(f"range {near_m * 1e3:g}:{far_m * 1e3:g} mm: must be 0 < near < far")
    return sorted({near_m, (near_m + far_m) / 2, far_m, required.depth_m})


def _compensators(build: Build, off: Causes, range_m: tuple[float, float]) -> tuple[Compensator, ...]:
    """One that knows nothing beforehand and one that knows the tolerances; none with nothing to do."""
    if build.recalibration is None or off.after_calibration.all():
        return ()
    return tuple(
        make_compensator(build.rig, off, build.recalibration, range_m, informed=informed)
        for informed in (False, True)
    )
