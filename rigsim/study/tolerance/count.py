"""How many built rigs are good, on as many as it takes to tell whether 95 of 100 are."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import betaincinv

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.batch import PARAMETERS, Rays, RigBatch, read_rays
from rigsim.study.tolerance.built import built_depths, draw, rigs_a_block
from rigsim.study.tolerance.first_order.needed import GOOD
from rigsim.study.tolerance.inputs import Causes
from rigsim.study.tolerance.joint.cause import JointDraw
from rigsim.study.tolerance.judge import Judge, make_judge
from rigsim.study.tolerance.recalibration.compensator import Compensator
from rigsim.study.tolerance.recalibration.session import Build, make_compensator
from rigsim.study.tolerance.rows import RowJudge, make_row_judge, row_errors_px
from rigsim.study.tolerance.sensitivities import BuildRequirement, causes, shared_points

AS_BUILT = (4000, 12_000)
"""Rigs that are built, and how many more where the first do not tell."""
RECALIBRATED = (300, 900)
"""Rigs that are recalibrated, and how many more."""
FALSE_ALARM = 0.005
"""Probability, at most, that one look calls 95 of 100 good when fewer are; or fewer when they are."""
COARSEST = 0.015
"""Standard error of a share that is exact enough."""
POINTS = 64
"""Points that each is judged by."""


@dataclass(frozen=True, slots=True)
class Count:
    """Good rigs among all that were built."""

    good: int
    """The good ones."""
    rigs: int
    """All of them."""

    @property
    def share(self) -> float:
        """Share of the good ones, 0 to 1."""
        return self.good / self.rigs

    @property
    def standard_error(self) -> float:
        """Standard error of that share; of one rig more, good or not, where all agree."""
        near = (self.good + 1) / (self.rigs + 2)
        return math.sqrt(near * (1 - near) / self.rigs)

    @property
    def interval(self) -> tuple[float, float]:
        """Where the true share lies: each end is missed with a probability of `FALSE_ALARM` at most
        (Clopper and Pearson, Biometrika 26, 1934)."""
        good, bad = self.good, self.rigs - self.good
        low = 0.0 if not good else float(betaincinv(good, bad + 1, FALSE_ALARM))
        high = 1.0 if not bad else float(betaincinv(good + 1, bad, 1 - FALSE_ALARM))
        return low, high

    @property
    def is_enough(self) -> bool | None:
        """Whether at least 95 of 100 are good; None where that is not told."""
        low, high = self.interval
        return True if low >= GOOD else False if high < GOOD else None


def count_good(
    build: Build,
    required: BuildRequirement,
    range_m: tuple[float, float],
    *,
    sizes: Sequence[int] | None = None,
    seed: int = 0,
) -> Count:
    """Build rigs within tolerance, and count those that meet the requirement with their pixel noise.

    Args:
        build: what is built, and how it is used; a recalibration knows nothing beforehand.
        required: depth error and distance, and maybe the row misalignment.
        range_m: near and far end, for the recalibration and the rows.
        sizes: rigs of each look; the next is taken only where those before do not tell.
        seed: of the random numbers.

    Raises:
        InvalidRange: no tolerance, or a depth that not both cameras see.
    """
    rig, recalibration = build.rig, build.recalibration
    off = causes(rig, build.tolerances)
    points = shared_points(rig, required.depth_m, POINTS)
    judge = make_judge(rig, points, required, build.noise_px)
    rows = None
    if required.row_px is not None:
        ends = (shared_points(rig, depth_m, POINTS) for depth_m in range_m)
        rows = make_row_judge(required.row_px, (points, *ends))
    compensator = None
    known: dict[int, float] = {}
    if recalibration is not None and not off.after_calibration.all():
        compensator = make_compensator(rig, off, recalibration, range_m)
        known = {PARAMETERS.index(name): left for name, left in recalibration.known}
    found = Count(0, 0)
    for look, size in enumerate(sizes or (AS_BUILT if compensator is None else RECALIBRATED)):
        rng = np.random.default_rng([seed, look])
        drawn = _drawn(off, known, size, rng)
        good = _good(build, _Judges(judge, points, rows), drawn, compensator, rng)
        found = Count(found.good + int(good.sum()), found.rigs + size)
        if found.is_enough is not None and found.standard_error <= COARSEST:
            break
    return found


@dataclass(frozen=True, slots=True, eq=False)
class _Drawn:
    """What rigs are off by."""

    before: Array
    """Before a recalibration (n, 12)."""
    late: Array
    """What comes after it (n, 12)."""
    together: JointDraw | None
    """What a calibration leaves; None without one."""

    def depths(self, rig: StereoRig, block: slice, points: Array) -> tuple[Array, Array, Rays | None]:
        """As `built_depths`, of some of them."""
        together = None if self.together is None else self.together.chosen(block)
        return built_depths(rig, self.before[block] + self.late[block], points, together)


def _drawn(off: Causes, known: Mapping[int, float], n_rigs: int, rng: np.random.Generator) -> _Drawn:
    numbers = draw(off, n_rigs, rng)
    deviations = numbers[:, : len(off.keys)] * off.std
    late = deviations * off.after_calibration @ off.effect
    before = deviations * ~off.after_calibration @ off.effect
    for place, left in known.items():
        before[:, place] = left * rng.standard_normal(n_rigs)
    return _Drawn(before, late, off.together(numbers))


@dataclass(frozen=True, slots=True, eq=False)
class _Judges:
    """Who judges depths, at which points, and who judges rows."""

    depths: Judge
    points: Array
    rows: RowJudge | None

    @property
    def all_points(self) -> Array:
        """Points of both; the depths' come first."""
        return self.points if self.rows is None else self.rows.points

    def are_good(self, depths: Array, batch: RigBatch, rays: Rays) -> Mask:
        """Which rigs (n,) are good that read `depths` (n, m) m, rays as `batch` reads them."""
        good = self.depths.is_good(depths[:, : len(self.points)])
        return good if self.rows is None else good & self.rows.keeps(row_errors_px(batch, rays))


def _good(
    build: Build,
    judges: _Judges,
    drawn: _Drawn,
    compensator: Compensator | None,
    rng: np.random.Generator,
) -> Mask:
    rig, points = build.rig, judges.all_points
    size = rigs_a_block(len(points))
    batch = RigBatch(rig, np.zeros((1, len(PARAMETERS))))
    parts = []
    for start in range(0, len(drawn.before), size):
        block = slice(start, start + size)
        depths, pixels, read = drawn.depths(rig, block, points)
        rays = read or read_rays(rig, pixels)
        if compensator is not None:
            batch = RigBatch(rig, compensator.solve(*compensator.observe(drawn.before[block], rng)))
            rays = batch.rays(pixels, rays)
            depths = batch.triangulate(rays)[2]
        parts.append(judges.are_good(depths, batch, rays))
    return np.concatenate(parts)
