"""A design as one JSON document; the schema stands in docs/design.md."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from rigsim.study import design_words as words
from rigsim.study.design import Candidate, Design
from rigsim.study.design_proof import Proof
from rigsim.theory.inverse import Bound, Interval, Requirement


def recommended(design: Design, proofs: Sequence[Proof]) -> Candidate:
    """The rig to take: the one verified, else the first that the formulas name."""
    return next((proof.candidate for proof in proofs if proof.verified), design.candidates[0])


def design_document(design: Design, proofs: Sequence[Proof]) -> dict[str, Any]:
    """The whole answer: recommended, binding, requirements, feasible, pareto, proof; JSON values only."""
    pick = recommended(design, proofs)
    verified = any(proof.verified for proof in proofs)
    spec = design.specification
    return {
        "recommended": {
            **_rig(pick),
            "verified": verified,
            "reason": proofs[-1].why if proofs else "not verified: no proof was asked for",
            "margin": _clean(pick.margin),
        },
        "binding": {"shortest": _bound(pick.interval.lower), "longest": _bound(pick.interval.upper)},
        "requirements": [_achieved(asked, pick, design, proofs) for asked in spec.requirements],
        "range_mm": [_clean(spec.near_m * 1e3), _clean(spec.far_m * 1e3)],
        "noise_px": spec.noise_px,
        "preference": design.preference,
        "cameras_tried": len(design.intervals),
        "feasible": [_interval(interval) for interval in design.feasible],
        "pareto": [_rig(candidate) for candidate in design.pareto],
        "proof": [
            {**_rig(proof.candidate), "verified": proof.verified, "reason": proof.why} for proof in proofs
        ],
    }


def _rig(candidate: Candidate) -> dict[str, Any]:
    return {
        "baseline_mm": _clean(candidate.baseline_m * 1e3),
        **_camera(candidate.interval),
        "depth_error_far_mm": _clean(candidate.far_error_m * 1e3),
    }


def _camera(interval: Interval) -> dict[str, Any]:
    camera = interval.camera
    return {
        "name": camera.name,
        "focal_px": _clean(camera.focal_px),
        "width_px": camera.width_px,
        "height_px": camera.height_px,
        "hfov_deg": _clean(math.degrees(camera.hfov_rad)),
    }


def _interval(interval: Interval) -> dict[str, Any]:
    return {
        **_camera(interval),
        "baseline_min_mm": _clean(interval.lower.baseline_m * 1e3),
        "baseline_max_mm": _clean(interval.upper.baseline_m * 1e3),
        "binding_min": _label(interval.lower.requirement),
        "binding_max": _label(interval.upper.requirement),
    }


def _bound(bound: Bound) -> dict[str, Any]:
    return {
        "baseline_mm": _clean(bound.baseline_m * 1e3),
        "requirement": _label(bound.requirement),
        "says": words.whole(bound.requirement),
    }


def _label(requirement: Requirement | None) -> str | None:
    return requirement.kind if requirement else None


def _achieved(asked: Requirement, pick: Candidate, design: Design, proofs: Sequence[Proof]) -> dict[str, Any]:
    unit, scale = {
        "depth_error": ("mm", 1e3),
        "cover": ("mm", 1e3),
        "max_baseline": ("mm", 1e3),
        "max_disparity": ("px", 1.0),
        "overlap": ("fraction", 1.0),
        "fov": ("deg", math.degrees(1)),
        "pixels": ("px", 1.0),
        "far_disparity": ("standard deviations", 1.0),
    }[asked.kind]
    predicted = asked.achieved(pick.camera, pick.baseline_m, design.specification.disparity_std_px)
    simulated = next(
        (
            held.simulated_m * scale
            for proof in proofs
            if proof.candidate == pick
            for held in proof.checks
            if held.requirement == asked and math.isfinite(held.simulated_m)
        ),
        None,
    )
    return {
        "requirement": asked.kind,
        "statistic": "p95" if asked.per_std != 1 else "std",
        "at_mm": _clean(asked.depth_m * 1e3) if asked.depth_m > 0 else None,
        "unit": unit,
        "bound": "at least" if asked.at_least else "at most",
        "required": _clean(asked.limit * scale),
        "achieved": _clean(predicted * scale),
        "simulated": None if simulated is None else _clean(simulated),
    }


def _clean(value: float) -> float:
    """Without the last digits' rounding noise."""
    return float(f"{value:.12g}")
