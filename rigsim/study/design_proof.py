"""The proof of a design: the pick is rendered, simulated and measured as in a sweep, then held to the word.

A requirement at a distance is held to the simulated points nearest that distance: each may err by what is
asked for times (its depth / that distance) squared, the law that the requirement itself is solved by, and
their RMS error is compared with the RMS of what they may. The prediction has no part in that comparison.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rigsim.errors import InvalidScene
from rigsim.rig.arrays import Array
from rigsim.study import design_words as words
from rigsim.study.design import Candidate, Design
from rigsim.theory.inverse import Requirement

if TYPE_CHECKING:
    from rigsim.study.plan import Plan
    from rigsim.study.result import SweepResult

ATTEMPTS = 3
"""Candidates that are tried before giving up."""
FEWEST_POINTS = 100
"""Points that a requirement is held to at least."""
_WINDOW = 1.25  # points within this factor of the distance
_REACH = 2.0  # farther off than this factor, points say nothing about the distance


@dataclass(frozen=True, slots=True)
class Check:
    """One depth error, asked for and simulated."""

    requirement: Requirement
    """What was asked for."""
    simulated_m: float
    """Simulated error, scaled to the requirement's distance and statistic, m; NaN without points."""
    n_points: int
    """Points it rests on."""
    nearest_m: float
    """Depth of the nearest of them, m."""
    farthest_m: float
    """Depth of the farthest of them, m."""

    @property
    def is_met(self) -> bool:
        """Whether the simulated error is small enough; never without points."""
        return self.simulated_m <= self.requirement.limit


@dataclass(frozen=True, slots=True, eq=False)
class Proof:
    """What became of one candidate."""

    candidate: Candidate
    """The rig."""
    checks: tuple[Check, ...]
    """Every depth error asked for."""
    verified: bool
    """Whether the simulation keeps what the formulas promised, and no witness objects."""
    why: str
    """One sentence: how it was verified, or why not."""
    result: SweepResult | None
    """The sweep of this one rig; None where the scene has nothing to simulate."""


def prove(design: Design, plan: Plan, attempts: int = ATTEMPTS) -> tuple[Proof, ...]:
    """Prove the candidates in their order until one is verified.

    Args:
        design: what the formulas say.
        plan: as for a sweep; its range and noise should be the specification's.
        attempts: candidates tried at most.

    Returns:
        One proof a candidate tried, the last one verified if any is.

    Raises:
        InvalidScene: the scene cannot be used.
        RenderUnavailable: the renderer asked for does not work here.
    """
    proofs: list[Proof] = []
    for candidate in design.candidates[:attempts]:
        proofs.append(_prove(candidate, design, plan))
        if proofs[-1].verified or proofs[-1].result is None:
            break
    return tuple(proofs)


def _prove(candidate: Candidate, design: Design, plan: Plan) -> Proof:
    from rigsim.sim.simulator import Simulator  # heavy, and the formulas alone need none of it
    from rigsim.study.sweep import sweep

    try:
        result = sweep([candidate.rig], plan)
    except InvalidScene as error:
        Simulator(plan.scene, plan.mount, plan.renderer).close()  # raises again when the scene is to blame
        return Proof(candidate, (), False, f"not verified: {error}", None)
    show = result.showcase
    depth_m = show.points_left[show.visible, 2]
    error_m = show.depth_rmse_m[show.visible]
    known = np.isfinite(error_m)
    checks = tuple(
        check(asked, depth_m[known], error_m[known])
        for asked in design.specification.requirements
        if asked.kind == "depth_error"
    )
    agreement = str(result.rows["agreement"].iloc[0])
    why = _objection(checks, agreement)
    if why:
        return Proof(candidate, checks, False, f"not verified: {why}", result)
    n_points = sum(held.n_points for held in checks)
    return Proof(
        candidate,
        checks,
        True,
        f"verified: simulated in `{plan.scene}` on {n_points} points at the distances asked for, "
        f"{plan.n_trials} trials each",
        result,
    )


def check(asked: Requirement, depth_m: Array, rmse_m: Array) -> Check:
    """Hold a depth error to simulated points.

    Args:
        asked: the requirement.
        depth_m: true depth of the points, (N,) m.
        rmse_m: RMS depth error of each over its trials, (N,) m.
    """
    away = np.abs(np.log(depth_m / asked.depth_m))
    order = np.argsort(away, kind="stable")
    count = max(int((away <= math.log(_WINDOW)).sum()), FEWEST_POINTS)
    chosen = order[:count]
    chosen = chosen[away[chosen] <= math.log(_REACH)]
    if len(chosen) < FEWEST_POINTS:
        return Check(asked, math.nan, len(chosen), math.nan, math.nan)
    scale = (depth_m[chosen] / asked.depth_m) ** 2
    simulated_m = math.sqrt(float(np.mean(rmse_m[chosen] ** 2)) / float(np.mean(scale**2))) * asked.per_std
    near, far = float(depth_m[chosen].min()), float(depth_m[chosen].max())
    return Check(asked, simulated_m, len(chosen), near, far)


def _objection(checks: Sequence[Check], agreement: str) -> str:
    """Why the proof fails; empty when it does not."""
    for held in checks:
        asked = held.requirement
        if not held.n_points or math.isnan(held.simulated_m):
            return (
                f"the scene has too few points near {words.distance(asked.depth_m)}; choose another --scene"
            )
        if not held.is_met:
            return (
                f"the {words.name(asked)} simulates to {words.size(held.simulated_m)}, "
                f"asked for {words.size(asked.limit)}"
            )
    return "" if agreement == "agrees" else agreement.removeprefix("flagged: ")
