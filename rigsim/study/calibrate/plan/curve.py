"""How a depth follows the number of pictures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.noise import PixelNoise
from rigsim.study.calibrate.plan.asked import LEAST_POSES, MOST_POSES, PlanAsked
from rigsim.study.calibrate.plan.choose import Picks, alike, extended
from rigsim.study.calibrate.plan.held import HELD_TIMES, held_by_hand
from rigsim.study.calibrate.plan.reach import ReachedPoses
from rigsim.study.calibrate.plan.result import CurvePoint, NextPose
from rigsim.study.calibrate.plan.terms import DepthTerms, Sums, board_terms
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.uncertainty import predict_depth_std

LONG = 50
"""Pictures that the curve goes to at least."""
_DRAWS = 15
_HANDS = 2
"""Stream of random numbers."""


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
    asked: PlanAsked
    """What was asked for."""

    @classmethod
    def of(cls, asked: PlanAsked, terms: DepthTerms, reached: ReachedPoses, given: int) -> PosePool:
        """With what is derived."""
        return cls(reached, terms, given, alike(reached, asked.board), asked)

    def extended(self, picks: Picks, count: int) -> Picks:
        """`picks` and the best next ones; a board may be held where it was already."""
        return picks if len(self.reached) == self.given else extended(self.terms, self.reached, picks, count)

    def stds(self, picks: Picks) -> Array:
        """Depth std (n,) m from the calibration with the first one, two, ... of `picks`: those that were
        given exactly where they are, the others with what a warp does as hands hold them."""
        return np.asarray(np.sqrt(self.noise(picks) + self.astray(picks)))

    def noise(self, picks: Picks) -> Array:
        """Variance (n,) m^2 of the same depth from the corners' noise alone."""
        return self.terms.axis_noise(self.terms.boards.chosen(picks).running())

    def astray(self, picks: Picks) -> Array:
        """Variance (n,) m^2 of it that a warp makes which nobody looks for."""
        terms, places = self.terms, np.array(picks, dtype=np.intp)
        if not terms.flatness_m:
            return np.zeros(len(picks))
        chosen = places >= self.given
        if not chosen.any():
            return np.asarray(terms.astray(terms.boards.chosen(picks).running())[:, 0])
        found = [
            terms.astray(board_terms(self.asked, held, terms.measure, terms.frame).running())[:, 0]
            for held in holds(self.asked, self.reached.chosen(places), chosen)
        ]
        return np.asarray(np.mean(found, axis=0))

    def sums(self, picks: Picks) -> Sums:
        """Of some poses."""
        return self.terms.boards.chosen(picks).total()


def holds(asked: PlanAsked, reached: ReachedPoses, by_hand: Mask) -> Iterator[ReachedPoses]:
    """The poses as they are held, again and again: those `by_hand` (n,) a little elsewhere each time."""
    for again in range(HELD_TIMES):
        rng = np.random.default_rng([asked.seed, _HANDS, again])
        held = held_by_hand(asked, reached.poses, reached.seen, rng)
        R = np.where(by_hand[:, None, None], held.R, reached.poses.R)
        t = np.where(by_hand[:, None], held.t, reached.poses.t)
        yield ReachedPoses(BoardPoses(R, t), reached.seen)


def observation_std(asked: PlanAsked, z_m: float) -> float:
    """Depth std on the left axis from the noise of a match alone, m."""
    return float(predict_depth_std(asked.rig, [[0.0, 0.0, z_m]], PixelNoise(asked.noise_px))[0])


def curve(asked: PlanAsked, pool: PosePool, picks: Picks, rng: np.random.Generator) -> tuple[CurvePoint, ...]:
    """From the fewest pictures to as many as `picks`, which are best first."""
    stds, random = pool.stds(picks), _random_stds(pool, len(picks), rng)
    joint = np.hypot(stds, observation_std(asked, asked.chosen_for_m))
    return tuple(
        CurvePoint(k + 1, float(stds[k]), float(random[k]), float(joint[k]))
        for k in range(LEAST_POSES - 1, len(picks))
    )


def first_that_meets(asked: PlanAsked, pool: PosePool, first: Picks) -> tuple[int | None, Picks]:
    """The fewest of `first`, and of the best that follow, that meet the goal's depth error; and all tried."""
    picks = first
    if asked.goal is None:
        return None, picks
    observation = observation_std(asked, asked.goal.z_m)
    # hands are asked seldom: they take their time
    step = MOST_POSES if pool.terms.flatness_m else LONG // 2
    while True:
        met = np.hypot(pool.stds(picks), observation) <= asked.goal.error_m
        met[: LEAST_POSES - 1] = False
        if met.any():
            count = int(np.argmax(met)) + 1
            return count, picks[: max(count, len(first))]
        more = pool.extended(picks, min(len(picks) + step, MOST_POSES))
        if len(more) <= len(picks):
            return None, picks
        picks = more


def next_pose(pool: PosePool, picks: Picks) -> NextPose | None:
    """Where one more board does the most beside `picks`; None where none can be held anywhere.

    Somewhere else than they are, if that helps the depth on the axis; where one was already, if not.
    """
    sums, terms = pool.sums(picks), pool.terms
    now = terms.axis_noise(sums)
    places = np.arange(len(pool.reached))
    for allowed in (places[~pool.close[picks].any(axis=0)], places[pool.given :]):
        if not allowed.size:
            continue
        with_it = sums.plus(terms.boards.chosen(allowed))
        axis = terms.axis_noise(with_it)
        if not (axis < now).any():
            continue
        best = int(np.argmin(np.where(axis < now, terms.loss(with_it), np.inf)))
        found = pool.reached.chosen(allowed[best : best + 1])
        left, right = found.seen[0]
        gain = float(np.sqrt(axis[best] / now))
        if terms.flatness_m:
            gain = float(pool.stds([*picks, int(allowed[best])])[-1] / pool.stds(picks)[-1])
        return NextPose(found.poses.rows[0], (bool(left), bool(right)), gain)
    return None


def _random_stds(pool: PosePool, count: int, rng: np.random.Generator) -> Array:
    """Median depth std (count,) m of the first one, two, ... of random poses that both cameras see."""
    both = np.flatnonzero(pool.reached.both)
    both = both[both >= pool.given]
    if not both.size:
        return np.full(count, np.inf)
    draws = [
        # a place comes again only where there are too few
        rng.permutation(np.concatenate([rng.permutation(both) for _ in range(-(-count // both.size))]))[
            :count
        ]
        for _ in range(_DRAWS)
    ]
    running = [pool.terms.boards.chosen(list(draw)).running() for draw in draws]
    noise = np.median([pool.terms.axis_noise(sums) for sums in running], axis=0)
    # they are no more where somebody wanted them than hands are
    astray = np.mean([pool.terms.astray(sums)[:, 0] for sums in running], axis=0)
    return np.asarray(np.sqrt(noise + astray))
