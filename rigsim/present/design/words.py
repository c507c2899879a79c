"""A design in words: how its pick was verified, or why not."""

from __future__ import annotations

from collections.abc import Sequence

from rigsim.present.design.tolerance import attempt as attempt
from rigsim.present.design.tolerance import tolerance_says as tolerance_says
from rigsim.present.kit import agreement
from rigsim.present.kit.sayings import Sentences, spoken
from rigsim.study.design import words as labels
from rigsim.study.design.checks import RequirementCheck
from rigsim.study.design.proof import Objection, Proof
from rigsim.study.design.solve import Specification

NOISE: Sentences = {
    "given": "given",
    "assumed": "assumed, as {why}",
    "assumed: none-given": "assumed, as none was given",
    "few-matches": "{sensor} finds fewer than {fewest} matches in the range",
    "measured": "measured in {scene} (sensor: {sensor}) on {matches} {method}, {when}",
    "round": "round {number}",
    "after-a-miss": "by {camera}, which missed with less",
}
"""Where the noise of a specification comes from."""


def noise(specification: Specification) -> str:
    """Where its noise comes from."""
    return spoken(specification.noise_from, NOISE)


def outcome(proof: Proof) -> str:
    """How a candidate was verified, or why not; without a full stop."""
    if proof.objection is not None:
        return f"not verified: {_objection(proof.objection, proof.scene)}"
    return grounds(proof.checks, proof.scene, proof.n_trials, proof.method, proof.sensor)


def grounds(checks: Sequence[RequirementCheck], scene: str, n_trials: int, method: str, sensor: str) -> str:
    """How a pick was verified: on what was simulated and measured, each point counted once."""
    errors = [held for held in checks if held.requirement.kind == "depth_error"]
    # two requirements of one distance rest on the same points
    n_points = len(frozenset[int]().union(*(held.points for held in errors)))
    n_measured = len(frozenset[int]().union(*(held.matches for held in errors)))
    simulated = (
        f"{verified_where(errors)}: simulated in {scene} on {n_points} points {_where(errors)}, "
        f"{n_trials} trials each"
    )
    if n_measured:
        return f"{simulated}, and measured on {n_measured} {method} in renderings (sensor: {sensor})"
    if not method:
        return f"{simulated}; nothing was measured in the pictures"
    return f"{simulated}; the pictures have too little to measure near those distances"


def more_in_pictures(checks: Sequence[RequirementCheck], noise_px: float) -> str:
    """That the pictures are noisier than what was promised, where a requirement is kept all the same; empty
    where they are not, or where it is not kept."""
    kept = (held for held in checks if held.is_met and not held.is_missed_by_pixels)
    more = [held for held in kept if held.is_more_in_pixels]
    if not more:
        return ""
    worst = max(more, key=lambda held: held.measured / held.simulated)
    ratio, asked = worst.measured / worst.simulated, worst.requirement
    measured, simulated = (labels.value(asked, one, 3) for one in (worst.measured, worst.simulated))
    return (
        f"But the measured {labels.name(asked)} is {measured}, {ratio:.2g} times the simulated {simulated}, "
        f"which the scatter of {worst.n_measured} matches does not explain: what is found in these pictures "
        f"has about {noise_px * ratio:.2g} px of noise per coordinate, not {noise_px:.3g}. It still meets "
        "what is asked, with less left for the build."
    )


def verified_where(errors: Sequence[RequirementCheck]) -> str:
    """Verified, and where, when that is not where it was asked for: points may be too few nearer to it."""
    widened = {
        held.requirement.depth_m: f"at {labels.span(held.nearest_m, held.farthest_m)} "
        f"(asked for at {labels.distance(held.requirement.depth_m)})"
        for held in errors
        if held.is_widened
    }
    if not widened:
        return "verified"
    nearer = [] if all(held.is_widened for held in errors) else ["near the other distances"]
    return f"verified {' and '.join([*widened.values(), *nearer])}"


def badge(proofs: Sequence[Proof]) -> str:
    """What became of the proof, in a word; empty where nothing was verified."""
    verified = next((proof for proof in proofs if proof.verified), None)
    if verified is None:
        return ""
    errors = [held for held in verified.checks if held.requirement.kind == "depth_error"]
    said = verified_where(errors)
    return f"{said[:1].upper()}{said[1:]}"


def _where(errors: Sequence[RequirementCheck]) -> str:
    """Where the points lie: near the distances, or else where `verified_where` says."""
    if all(held.is_widened for held in errors):
        return "there"
    near = "near the distances asked for"
    return f"{near}, or the nearest to them" if any(held.is_widened for held in errors) else near


def _objection(found: Objection, scene: str) -> str:
    if found.agreement is not None:
        return agreement.reason(found.agreement)
    held = found.check
    if held is None:
        return found.cause
    asked = held.requirement
    if found.kind == "too-few-points":
        return (
            f"{scene} has too few points near {labels.distance(asked.depth_m)} at any baseline; "
            "choose another --scene (auto makes one for the range)"
        )
    simulated = f"the simulated {labels.name(asked)} is {labels.value(asked, held.simulated, 3)}"
    if found.kind == "missed":
        return f"{simulated}, required is {labels.value(asked, asked.limit, 3)}"
    return (
        f"{simulated} as required, but the measured one is {labels.value(asked, held.measured, 3)} "
        f"({held.n_measured} matches in renderings), more than the "
        f"{labels.value(asked, asked.limit, 3)} allowed"
    )
