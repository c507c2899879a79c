"""The proof of a design: the pick is rendered, simulated and measured as in a sweep, then held to the word.

Every requirement is held to what the placed rig shows (`rigsim.study.design_checks`); the formulas have no
part in it. A pick is verified when every requirement holds in the simulation, no measured depth error misses
by more than two of its standard errors, and the sweep's own verdict flags nothing.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rigsim.rig.noise import PixelNoise
from rigsim.study import design_words as words
from rigsim.study.agreement import kind_of, reason_of
from rigsim.study.design import Candidate, Design, Specification, solve
from rigsim.study.design_checks import Check, Sight, check

if TYPE_CHECKING:
    from rigsim.study.design_room import Room
    from rigsim.study.plan import Plan
    from rigsim.study.result import Showcase
    from rigsim.theory.inverse import Camera

ATTEMPTS = 3
"""Candidates that are tried before giving up."""


@dataclass(frozen=True, slots=True, eq=False)
class Proof:
    """What became of one candidate."""

    candidate: Candidate
    """The rig."""
    checks: tuple[Check, ...]
    """Every requirement."""
    verified: bool
    """Whether simulation and pixels keep what the formulas promised, and no witness objects."""
    why: str
    """One sentence: how it was verified, or why not."""
    show: Showcase | None
    """Its points and pictures; None where the scene has nothing to simulate."""
    sensor: str = ""
    """What the pictures were taken with."""
    method: str = ""
    """What was measured in them; empty when nothing was."""


def prove(
    design: Design, room: Room, noise: PixelNoise | None = None, attempts: int = ATTEMPTS
) -> tuple[Proof, ...]:
    """Prove the candidates in their order until one is verified.

    Args:
        design: what the formulas say.
        room: where.
        noise: what is simulated; the specification's by default.
        attempts: candidates tried at most.

    Returns:
        One proof a candidate tried, the last one verified if any is.

    Raises:
        RenderMismatch: the renderer disagrees with the rig or with rays.
        RenderUnavailable: the renderer asked for does not work here.
    """
    proofs: list[Proof] = []
    for candidate in design.candidates[:attempts]:
        proofs.append(_prove(candidate, design, room, noise or PixelNoise(design.specification.noise_px)))
        if proofs[-1].verified or proofs[-1].show is None:
            break
    return tuple(proofs)


def settle_and_prove(
    specification: Specification, cameras: Sequence[Camera], preference: str, room: Room
) -> tuple[Design, tuple[Proof, ...]]:
    """The design with its own sensor's noise, and its proofs: when pixels miss, their noise is taken instead.

    Raises:
        InvalidRig: no rig meets the requirements with the noise measured last.
        RenderMismatch: as `prove`.
        RenderUnavailable: as `prove`.
    """
    from rigsim.study.design_room import measure_noise, settle

    design = settle(specification, cameras, preference, room)
    proofs: list[Proof] = []
    for _ in range(ATTEMPTS):
        tried = [(proof.candidate.camera, proof.candidate.baseline_m) for proof in proofs]
        left = [c for c in design.candidates if (c.camera, c.baseline_m) not in tried]
        if not left:
            break
        noise = PixelNoise(design.specification.noise_px)
        proofs.append(_prove(left[0], design, room, noise))
        if proofs[-1].verified or proofs[-1].show is None:
            break
        if any(held.is_missed_by_pixels for held in proofs[-1].checks):
            when = f"by {words.camera(left[0].camera)}, which missed with less"
            found = measure_noise(specification, left[0], room, when)
            if found.noise_px > design.specification.noise_px:
                design = solve(found, cameras, preference)
    return design, tuple(proofs)


def _prove(candidate: Candidate, design: Design, room: Room, noise: PixelNoise) -> Proof:
    trial = room.trial(candidate)
    label, matches = trial.fitting.label, trial.matches
    if trial.seen is None:
        return Proof(candidate, (), False, f"not verified: {trial.why}", None, label)
    row, show, centres_apart_m = room.row(candidate, noise)
    sight = Sight(
        rig=show.rig,
        centres_apart_m=centres_apart_m,
        picture_px=(show.image_left.shape[1], show.image_left.shape[0]),
        points_left=show.points_left[show.visible],
        depth_rmse_m=show.depth_rmse_m[show.visible],
        noise=show.noise,
        n_trials=room.plan.n_trials,
        measured=matches,
    )
    rng = room.plan.stream("percentile", room.plan.scene, show.rig, repr(show.noise))
    checks = tuple(check(asked, sight, rng) for asked in design.specification.requirements)
    why = _objection(checks, str(row["agreement"]), room.plan)
    method = matches.method if matches is not None and len(matches.outlier) else ""
    verified = not why
    if verified:
        why = grounds(checks, room.plan, method, label)
    return Proof(
        candidate, checks, verified, why if verified else f"not verified: {why}", show, label, method
    )


def grounds(checks: Sequence[Check], plan: Plan, method: str, label: str) -> str:
    """How a pick was verified: on what was simulated and measured, each point counted once."""
    errors = [held for held in checks if held.requirement.kind == "depth_error"]
    # two requirements of one distance rest on the same points
    n_points = len(frozenset[int]().union(*(held.points for held in errors)))
    n_measured = len(frozenset[int]().union(*(held.matches for held in errors)))
    simulated = (
        f"verified: simulated in `{plan.scene}` on {n_points} points {_where(errors)}, "
        f"{plan.n_trials} trials each"
    )
    if n_measured:
        return f"{simulated}, and measured on {n_measured} {method} in the pictures (sensor: {label})"
    return f"{simulated}; the pictures have too little to measure near those distances"


def _where(errors: Sequence[Check]) -> str:
    """Where the points lie: near the distances, or else how far off."""
    widened = {
        held.requirement.depth_m: f"at {words.span(held.nearest_m, held.farthest_m)} "
        f"(too few are closer to {words.distance(held.requirement.depth_m)})"
        for held in errors
        if held.is_widened
    }
    if all(held.is_widened for held in errors):
        return " and ".join(widened.values())
    return " and ".join(["near the distances asked for", *widened.values()])


def _objection(checks: Sequence[Check], agreement: str, plan: Plan) -> str:
    """Why the proof fails; empty when it does not."""
    for held in checks:
        asked = held.requirement
        if math.isnan(held.simulated):
            return (
                f"the scene has too few points near {words.distance(asked.depth_m)}; choose another --scene"
            )
        if not held.is_met:
            return (
                f"the {words.name(asked)} simulates to {words.value(asked, held.simulated, 3)}, "
                f"asked for {words.value(asked, asked.limit, 3)}"
            )
    for held in checks:
        if held.is_missed_by_pixels:
            asked = held.requirement
            return (
                f"the {words.name(asked)} simulates to {words.value(asked, held.simulated, 3)} as asked for, "
                f"but measures {words.value(asked, held.measured, 3)} in the pictures "
                f"({held.n_measured} matches), more than the {words.value(asked, asked.limit, 3)} allowed"
            )
    return reason_of(agreement) if kind_of(agreement) == "flagged" else ""
