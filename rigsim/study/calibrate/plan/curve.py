"""How a depth follows the number of pictures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.noise import PixelNoise
from rigsim.study.calibrate.plan.asked import LEAST_POSES, MOST_POSES, PlanAsked
from rigsim.study.calibrate.plan.choose import Picks, alike, extended
from rigsim.study.calibrate.plan.reach import ReachedPoses
from rigsim.study.calibrate.plan.result import CurvePoint, NextPose
from rigsim.study.calibrate.plan.terms import DepthTerms, Sums
from rigsim.theory.uncertainty import predict_depth_std

LONG = 50
"""Pictures that the curve goes to at least."""
_DRAWS = 15


@dataclass(frozen=True, slots=True, eq=False)
class PosePool:
    """All poses that count: first those that were given, if any, then those that could be held."""

    reached: ReachedPoses
    """The poses."""
    terms: DepthTerms
    """What they do to the depth that counts."""
    given: int
    """How many of them were given; those are not drawn at random."""
    close: Mask
    """Which are nearly the same (n, n)."""

    @classmethod
    def of(cls, asked: PlanAsked, terms: DepthTerms, reached: ReachedPoses, given: int) -> PosePool:
        """With what is derived."""
        return cls(reached, terms, given, alike(reached, asked.board))

    def extended(self, picks: Picks, count: int) -> Picks:
        """`picks` and the best next ones; a board may be held where it was already."""
        return picks if len(self.reached) == self.given else extended(self.terms, self.reached, picks, count)

    def stds(self, picks: Picks) -> Array:
        """Depth std (n,) m from the calibration with the first one, two, ... of `picks`."""
        return np.asarray(np.sqrt(self.terms.axis_variance(self.terms.boards.chosen(picks).running())))

    def sums(self, picks: Picks) -> Sums:
        """Of some poses."""
        return self.terms.boards.chosen(picks).total()


def observation_std(asked: PlanAsked, z_m: float) -> float:
    """Depth std on the left axis from the noise of a match alone, m."""
    return float(predict_depth_std(asked.rig, [[0.0, 0.0, z_m]], PixelNoise(asked.noise_px))[0])


def curve(
    asked: PlanAsked, places: PosePool, picks: Picks, rng: np.random.Generator
) -> tuple[CurvePoint, ...]:
    """From the fewest pictures to as many as `picks`, which are best first."""
    stds, random = places.stds(picks), _random_stds(places, len(picks), rng)
    joint = np.hypot(stds, observation_std(asked, asked.chosen_for_m))
    return tuple(
        CurvePoint(k + 1, float(stds[k]), float(random[k]), float(joint[k]))
        for k in range(LEAST_POSES - 1, len(picks))
    )


def first_that_meets(asked: PlanAsked, places: PosePool, picks: Picks) -> tuple[int | None, Picks]:
    """The fewest of `picks`, and of the best that follow, that meet the goal's depth error; and all tried."""
    if asked.goal is None:
        return None, picks
    observation = observation_std(asked, asked.goal.z_m)
    while True:
        met = np.hypot(places.stds(picks), observation) <= asked.goal.error_m
        met[: LEAST_POSES - 1] = False
        if met.any():
            return int(np.argmax(met)) + 1, picks
        more = places.extended(picks, min(len(picks) + LONG // 2, MOST_POSES))
        if len(more) <= len(picks):
            return None, picks
        picks = more


def next_pose(places: PosePool, picks: Picks) -> NextPose | None:
    """Where one more board does the most beside `picks`; None where none can be held anywhere."""
    if len(places.reached) == places.given:
        return None
    allowed = np.flatnonzero(~places.close[picks].any(axis=0))
    if not allowed.size:
        allowed = np.arange(places.given, len(places.reached))
    sums, terms = places.sums(picks), places.terms
    with_it = sums.plus(terms.boards.chosen(allowed))
    axis, now = terms.axis_variance(with_it), terms.axis_variance(sums)
    # not one that helps elsewhere at the axis's cost, if there is any other
    best = int(np.argmin(np.where(axis < now, terms.loss(with_it), np.inf) if (axis < now).any() else axis))
    found = places.reached.chosen(allowed[best : best + 1])
    left, right = found.seen[0]
    gain = float(np.sqrt(axis[best] / now))
    return NextPose(found.poses.rows[0], (bool(left), bool(right)), gain)


def _random_stds(places: PosePool, count: int, rng: np.random.Generator) -> Array:
    """Median depth std (count,) m of the first one, two, ... of random poses that both cameras see."""
    both = np.flatnonzero(places.reached.both)
    both = both[both >= places.given]
    if not both.size:
        return np.full(count, np.inf)
    draws = [
        # a place comes again only where there are too few
        rng.permutation(np.concatenate([rng.permutation(both) for _ in range(-(-count // both.size))]))[
            :count
        ]
        for _ in range(_DRAWS)
    ]
    return np.asarray(np.median([places.stds(list(draw)) for draw in draws], axis=0))
