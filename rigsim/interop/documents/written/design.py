"""A design as one JSON document; the schema stands in docs/reference/design.md."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from rigsim.interop.documents.written.tolerance import tolerance_document
from rigsim.study.design import words as words
from rigsim.study.design.proof import Proof, held_to, recommended
from rigsim.study.design.solve import Candidate, Design
from rigsim.study.design.tolerance import DesignTolerance
from rigsim.theory.inverse import Bound, Interval, Requirement


def design_document(
    design: Design, proofs: Sequence[Proof], tolerance: DesignTolerance | None = None
) -> dict[str, Any]:
    """The whole answer, as docs/reference/design.md says; JSON values only."""
    pick = recommended(design, proofs)
    verified = any(proof.verified for proof in proofs)
    spec = design.specification
    return {
        "recommended": {
            **_rig(pick),
            "verified": verified,
            "reason": _reason(pick, proofs),
            "margin": _clean(pick.margin),
            "noise_share": _clean(pick.noise_share),
            **_class(tolerance),
        },
        "binding": {"shortest": _bound(pick.interval.lower), "longest": _bound(pick.interval.upper)},
        "requirements": [_achieved(asked, pick, design, proofs) for asked in spec.requirements],
        "range_mm": [_clean(spec.near_m * 1e3), _clean(spec.far_m * 1e3)],
        "build_share": _clean(spec.build_share),
        "noise_px": _clean(spec.noise_px),
        "noise_source": spec.noise_source,
        "noise_says": spec.noise_says,
        "preference": design.preference,
        "cameras_tried": len(design.intervals),
        "feasible": [_interval(interval) for interval in design.feasible],
        "pareto": [_rig(candidate) for candidate in design.pareto],
        "proof": [
            {
                **_rig(proof.candidate),
                "verified": proof.verified,
                "reason": proof.why,
                "sensor": proof.sensor or None,
                "measured_method": proof.method or None,
            }
            for proof in proofs
        ],
        "tolerance": None if tolerance is None else tolerance_part(tolerance),
    }


def _reason(pick: Candidate, proofs: Sequence[Proof]) -> str:
    if not proofs:
        return "not verified: no proof was asked for"
    # of a rig that failed with less noise first, what was found last
    return next((proof.why for proof in reversed(proofs) if proof.candidate == pick), proofs[-1].why)


def _class(tolerance: DesignTolerance | None) -> dict[str, Any]:
    """The class that will do, how, and its yield; null for none."""
    found = None if tolerance is None else tolerance.recommended
    if found is None:
        return {"class": None, "class_state": None, "yield_pct": None}
    name, state, count = found
    return {"class": name, "class_state": state, "yield_pct": _clean(100 * count.share)}


def _rig(candidate: Candidate) -> dict[str, Any]:
    return {
        "baseline_mm": _clean(candidate.baseline_m * 1e3),
        **_camera(candidate.interval),
        "depth_error_far_mm": _clean(candidate.far_error_m * 1e3),
    }


def tolerance_part(tolerance: DesignTolerance) -> dict[str, Any]:
    """What must be held how tightly, and the yields of the classes."""
    whole = tolerance_document(tolerance.result)
    return {
        "class": tolerance.class_name,
        "required": whole["required"],
        "rigs": whole["rigs"],
        "points": whole["points"],
        "distances_mm": [item["distance_mm"] for item in whole["depths"]],
        "quantities": whole["quantities"],
        "noise_mm": _clean(tolerance.noise_error_m * 1e3),
        "yield": {
            item.name: {
                f"{state}{what}": value
                for state, count in (("as_built", item.as_built), ("recalibrated", item.recalibrated))
                for what, value in (
                    ("", count.share),
                    ("_se", count.standard_error),
                    ("_rigs", count.rigs),
                    ("_enough", count.is_enough),
                )
            }
            for item in tolerance.yields
        },
        "tried": [
            {
                "says": item.says,
                "yield": item.count.share,
                "yield_se": item.count.standard_error,
                "enough": item.count.is_enough,
            }
            for item in tolerance.advice
        ],
        "says": tolerance.says,
    }


def _camera(interval: Interval) -> dict[str, Any]:
    camera = interval.camera
    return {
        "name": camera.name,
        "focal_px": _clean(camera.focal_px),
        "width_px": camera.width_px,
        "height_px": camera.height_px,
        "hfov_deg": _clean(math.degrees(camera.hfov_rad)),
        "sensor": camera.sensor or None,
        "focal_mm": None if camera.focal_mm is None else _clean(camera.focal_mm),
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
    held = held_to(asked, pick, proofs)
    return {
        "requirement": asked.kind,
        "statistic": "p95" if asked.per_std != 1 else "std",
        "at_mm": _clean(asked.depth_m * 1e3) if asked.depth_m > 0 else None,
        "unit": unit,
        "bound": "at least" if asked.at_least else "at most",
        "required": _clean(asked.limit * scale),
        "achieved": _clean(predicted * scale),
        "simulated": None if held is None else _known(held.simulated * scale),
        "shown_by": None if held is None else held.shown_by,
        "points_n": 0 if held is None else held.n_points,
        "nearest_mm": None if held is None else _known(held.nearest_m * 1e3),
        "farthest_mm": None if held is None else _known(held.farthest_m * 1e3),
        "measured": None if held is None else _known(held.measured * scale),
        "measured_n": 0 if held is None else held.n_measured,
        "met": bool(
            asked.is_met(predicted) if held is None else held.is_met and not held.is_missed_by_pixels
        ),
    }


def _known(value: float) -> float | None:
    return _clean(value) if math.isfinite(value) else None


def _clean(value: float) -> float:
    """Without the last digits' rounding noise."""
    return float(f"{value:.12g}")
