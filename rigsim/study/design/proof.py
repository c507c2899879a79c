"""The proof of a design: the pick is rendered, simulated and measured as in a sweep, then held to the word.

Every requirement is held to what the placed rig shows (`rigsim.study.design.checks`); the formulas have no
part in it. A pick is verified when every requirement holds in the simulation, no measured depth error misses
by more than two of its standard errors, and the sweep's own verdict flags nothing. The next to be tried lies
farther along the same camera's interval, away from what failed; then come other cameras.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from rigsim.rig.noise import PixelNoise
from rigsim.study.agreement.agreement import Agreement
from rigsim.study.design import words as words
from rigsim.study.design.checks import RequirementCheck, RigInScene, check
from rigsim.study.design.solve import Candidate, Design, Specification, solve
from rigsim.study.saying import saying
from rigsim.study.sweep.requirement import RowVerdict
from rigsim.theory.inverse import GATES, LOWER

if TYPE_CHECKING:
    from rigsim.study.design.room import Room
    from rigsim.study.scene.showcase import Showcase
    from rigsim.theory.inverse import Camera


from rigsim.theory.inverse import Requirement

CAMERAS = 3
"""Cameras that are tried before giving up, each at up to three baselines."""
ROUNDS = 3
"""Times that a noise shown by the pixels is taken instead of the one assumed."""


@dataclass(frozen=True, slots=True)
class Objection:
    """Why a candidate is not verified."""

    kind: Literal["nothing-seen", "too-few-points", "missed", "missed-by-pixels", "flagged"]
    """What failed: the rig sees nothing; the scene has too few points near a distance; the simulation or the
    pixels miss a requirement; the witnesses disagree."""
    check: RequirementCheck | None = None
    """The requirement that could not be held, or was missed."""
    agreement: Agreement | None = None
    """What flags it."""
    cause: str = ""
    """The message of the error that left nothing to see."""


@dataclass(frozen=True, slots=True, eq=False)
class Proof:
    """What became of one candidate."""

    candidate: Candidate
    """The rig."""
    checks: tuple[RequirementCheck, ...]
    """Every requirement."""
    objection: Objection | None
    """Why it is not verified; None when simulation and pixels keep what the formulas promised and no witness
    objects."""
    show: Showcase | None
    """Its points and pictures; None where the scene has nothing to simulate."""
    scene: str = ""
    """Where it was tried, as in a sentence: "`boards`", or "a scene made for 0.8 to 1.2 m"."""
    n_trials: int = 0
    """Trials of each simulated point."""
    sensor: str = ""
    """What the pictures were taken with."""
    method: str = ""
    """What was measured in them; empty when nothing was."""

    @property
    def verified(self) -> bool:
        """Whether nothing objects."""
        return self.objection is None

    @property
    def lacks_points(self) -> bool:
        """Whether the scene has too few points at a distance where something is asked for."""
        return any(math.isnan(held.simulated) for held in self.checks)

    @property
    def wants(self) -> int:
        """1 where what failed asks for a longer baseline, -1 for a shorter one, 0 where neither is told."""
        missed = [held for held in self.checks if not held.is_met or held.is_missed_by_pixels]
        longer = any(held.requirement.kind in LOWER for held in missed)
        shorter = any(held.requirement.kind not in LOWER | GATES for held in missed)
        return int(longer) - int(shorter)


def prove(
    design: Design, room: Room, noise: PixelNoise | None = None, cameras: int = CAMERAS
) -> tuple[Proof, ...]:
    """Prove candidates, the first one first, until one is verified.

    Args:
        design: what the formulas say.
        room: where.
        noise: what is simulated; the specification's by default.
        cameras: cameras tried at most.

    Returns:
        One proof a candidate tried, the last one verified if any is.

    Raises:
        RenderMismatch: the renderer disagrees with the rig or with rays.
        RenderUnavailable: the renderer asked for does not work here.
    """
    proofs: list[Proof] = []
    while (candidate := following(design, proofs, cameras)) is not None:
        proofs.append(_prove(candidate, design, room, noise or PixelNoise(design.specification.noise_px)))
        if proofs[-1].verified:
            break
    return tuple(proofs)


def following(
    design: Design,
    proofs: Sequence[Proof],
    cameras: int = CAMERAS,
    gone: Collection[tuple[Camera, float]] = (),
) -> Candidate | None:
    """The candidate to try after those that failed: the same camera farther along, then others; or None.

    Where the last one failed for want of a longer baseline, only longer ones of its camera are worth a try,
    and likewise shorter ones. Where the scene had too little to show, none is. `gone` are cameras and
    baselines that failed before.
    """
    left = [c for c in design.candidates if (c.camera, c.baseline_m) not in gone]
    if not proofs:
        return next(iter(left), None)
    last, tried = proofs[-1], {proof.candidate.camera for proof in proofs}
    if last.show is None:
        return None
    if not last.lacks_points:
        done = {p.candidate.baseline_m for p in proofs if p.candidate.camera == last.candidate.camera}
        along = [c for c in left if c.camera == last.candidate.camera and c.baseline_m not in done]
        if last.wants != 0:
            along = [c for c in along if (c.baseline_m - last.candidate.baseline_m) * last.wants > 0]
        if along:
            return min(along, key=lambda c: abs(math.log(c.baseline_m / last.candidate.baseline_m)))
    if len(tried) >= cameras:
        return None
    return next((c for c in left if c.camera not in tried), None)


def settle_and_prove(
    specification: Specification, cameras: Sequence[Camera], preference: str, room: Room
) -> tuple[Design, tuple[Proof, ...]]:
    """The design with its own sensor's noise, and its proofs: when pixels miss, their noise is taken instead.

    Raises:
        InvalidRig: no rig meets the requirements with the noise measured last.
        RenderMismatch: as `prove`.
        RenderUnavailable: as `prove`.
    """
    from rigsim.study.design.noise import measure_noise, settle

    design = settle(specification, cameras, preference, room)
    proofs: list[Proof] = []
    current: list[Proof] = []  # those of the noise that counts now
    rounds = 0
    # with more noise, what missed with less is not tried again
    while candidate := following(
        design, current, gone={(p.candidate.camera, p.candidate.baseline_m) for p in proofs}
    ):
        noise = PixelNoise(design.specification.noise_px)
        proofs.append(_prove(candidate, design, room, noise))
        current.append(proofs[-1])
        if proofs[-1].verified:
            break
        if rounds < ROUNDS and any(held.is_missed_by_pixels for held in proofs[-1].checks):
            rounds += 1
            when = saying("after-a-miss", camera=words.camera(candidate.camera))
            found = measure_noise(specification, candidate, room, when)
            if found.noise_px > design.specification.noise_px:
                design, current = solve(found, cameras, preference), []
    return design, tuple(proofs)


def _prove(candidate: Candidate, design: Design, room: Room, noise: PixelNoise) -> Proof:
    trial = room.trial(candidate)
    label, matches = trial.fitting.label, trial.matches
    row, show = (None, None) if trial.seen is None else room.row(candidate, noise)
    camera = candidate.camera
    sight = RigInScene(
        rig=candidate.rig,
        centres_apart_m=room.centres_apart_m,
        picture_px=(camera.width_px, camera.height_px)
        if show is None
        else (show.image_left.shape[1], show.image_left.shape[0]),
        points_left=np.empty((0, 3)) if show is None else show.points_left[show.visible],
        depth_rmse_m=np.empty(0) if show is None else show.depth_rmse_m[show.visible],
        noise=noise,
        n_trials=room.plan.n_trials,
        measured=matches,
    )
    rng = room.plan.stream("percentile", room.plan.scene, sight.rig, repr(noise))
    checks = tuple(check(asked, sight, rng) for asked in design.specification.asked_of(camera))
    unseen = Objection("nothing-seen", cause=trial.why)
    return Proof(
        candidate,
        checks,
        unseen if row is None else _objection(checks, row["agreement"]),
        show,
        room.where,
        room.plan.n_trials,
        sensor=label,
        method=matches.method if matches is not None and len(matches.outlier) else "",
    )


def _objection(checks: Sequence[RequirementCheck], agreement: Agreement) -> Objection | None:
    """Why the proof fails; None when it does not."""
    for held in checks:
        if math.isnan(held.simulated):
            return Objection("too-few-points", held)
        if not held.is_met:
            return Objection("missed", held)
    for held in checks:
        if held.is_missed_by_pixels:
            return Objection("missed-by-pixels", held)
    return Objection("flagged", agreement=agreement) if agreement.kind == "flagged" else None


def recommended(design: Design, proofs: Sequence[Proof]) -> Candidate:
    """The rig to take: the one verified, else the first that the formulas name."""
    return next((proof.candidate for proof in proofs if proof.verified), design.candidates[0])


def held_to(asked: Requirement, pick: Candidate, proofs: Sequence[Proof]) -> RequirementCheck | None:
    """What the proof of `pick` says of one requirement; None where there is none."""
    checks = (held for proof in proofs if proof.candidate == pick for held in proof.checks)
    return next((held for held in checks if held.requirement == asked), None)


def verdict(asked: Requirement, pick: Candidate, proofs: Sequence[Proof], spec: Specification) -> RowVerdict:
    """What is known of one requirement: by its proof, and by the formulas where nothing was tried."""
    held = held_to(asked, pick, proofs)
    formula = asked.is_met(asked.achieved(pick.camera, pick.baseline_m, spec.disparity_std_px))
    if proofs and (held is None or math.isnan(held.simulated)):
        return "not_shown" if formula else "not_met"
    met = formula and (held is None or (held.is_met and not held.is_missed_by_pixels))
    return "met" if met else "not_met"
