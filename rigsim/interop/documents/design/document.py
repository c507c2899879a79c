"""The document that `rigsim design --json` prints, made from a design."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Protocol, cast

from rigsim.interop.documents.base import golden_part
from rigsim.interop.documents.design.models import (
    Achieved,
    Binding,
    Bound,
    Candidate,
    CountedCalibration,
    CountedYield,
    DesignDocument,
    DesignTolerance,
    Feasible,
    Housing,
    Kind,
    LeastImage,
    Preference,
    Proved,
    Recommended,
    Tried,
    Unit,
)
from rigsim.interop.documents.text import clean
from rigsim.interop.documents.tolerance.document import quantities_part, required_part
from rigsim.rig.catalogue.sensors import sensor_preset
from rigsim.study.design import words as labels
from rigsim.study.design.buildable import smallest_resolution
from rigsim.study.design.help import Attempt
from rigsim.study.design.least import least_size
from rigsim.study.design.proof import Proof, held_to, recommended, verdict
from rigsim.study.design.solve import Candidate as Picked
from rigsim.study.design.solve import Design, Specification
from rigsim.study.design.tolerance import DesignTolerance as Held
from rigsim.study.golden.compare import GoldenReport
from rigsim.theory.inverse import BaselineBound as End
from rigsim.theory.inverse import Interval, Requirement

_UNITS: dict[Kind, tuple[Unit, float]] = {
    "depth_error": ("mm", 1e3),
    "cover": ("mm", 1e3),
    "cover_height": ("mm", 1e3),
    "max_baseline": ("mm", 1e3),
    "min_baseline": ("mm", 1e3),
    "max_disparity": ("px", 1.0),
    "overlap": ("fraction", 1.0),
    "fov": ("deg", math.degrees(1)),
    "vfov": ("deg", math.degrees(1)),
    "pixels": ("px", 1.0),
    "far_disparity": ("standard deviations", 1.0),
}


class Words(Protocol):
    """The sentences of the document, made by whoever calls: `rigsim.present.design.words` has them all."""

    def outcome(self, proof: Proof) -> str:
        """How a rig was verified, or why not."""

    def noise(self, specification: Specification) -> str:
        """Where the noise comes from."""

    def attempt(self, tried: Attempt) -> str:
        """What was changed where no class will do."""

    def tolerance_says(self, tolerance: Held) -> str:
        """What the build must hold, and who holds it."""


def design_document(
    design: Design,
    proofs: Sequence[Proof],
    tolerance: Held | None,
    words: Words,
    golden: GoldenReport | None = None,
) -> dict[str, Any]:
    """The answer, as docs/reference/design.md says; `words` has its sentences."""
    pick = recommended(design, proofs)
    spec = design.specification
    smallest = smallest_resolution(design)
    least = least_size(pick, spec)
    return DesignDocument(
        recommended=Recommended(
            **_rig(pick),
            verified=any(proof.verified for proof in proofs),
            reason=_reason(pick, proofs, words),
            margin=clean(pick.margin),
            noise_share=clean(pick.noise_share),
            calibration_share=clean(pick.calibration_share),
            **_class(tolerance),
        ),
        binding=Binding(shortest=_bound(pick.interval.lower), longest=_bound(pick.interval.upper)),
        calibration=None
        if spec.calibration is None
        else CountedCalibration(file=spec.calibration.of.name, source=spec.calibration.of.source),
        housing=_housing(pick),
        requirements=[_achieved(asked, pick, design, proofs) for asked in spec.asked_of(pick.camera)],
        range_mm=(clean(spec.near_m * 1e3), clean(spec.far_m * 1e3)),
        build_share=clean(spec.build_share),
        noise_px=clean(spec.noise_px),
        noise_source=spec.noise_source,
        noise_says=words.noise(spec),
        preference=cast("Preference", design.preference),
        cameras_tried=len(design.intervals),
        feasible=[_feasible(interval) for interval in design.feasible],
        smallest_resolution=None if smallest is None else Candidate(**_rig(smallest)),
        least_size=None
        if least is None
        else LeastImage(
            width_px=least.width_px, height_px=least.height_px, baseline_mm=clean(least.baseline_m * 1e3)
        ),
        pareto=[Candidate(**_rig(candidate)) for candidate in design.pareto],
        proof=[
            Proved(
                **_rig(proof.candidate) | {"sensor": proof.sensor or None},
                verified=proof.verified,
                reason=words.outcome(proof),
                scene=proof.scene.replace("`", ""),
                measured_method=proof.method or None,
            )
            for proof in proofs
        ],
        tolerance=None if tolerance is None else _tolerance(tolerance, words),
        golden=golden_part(golden),
    ).model_dump(by_alias=True)


def _reason(pick: Picked, proofs: Sequence[Proof], words: Words) -> str:
    if not proofs:
        return "not verified: no proof was asked for"
    # of a rig that failed with less noise first, what was found last
    return words.outcome(next((proof for proof in reversed(proofs) if proof.candidate == pick), proofs[-1]))


def _class(tolerance: Held | None) -> dict[str, Any]:
    """The class that will do or was asked for, how, its yield and what limits it; null where none is told."""
    if tolerance is None:
        return dict.fromkeys(("class", "class_state", "class_enough", "yield_pct", "limited_by"))
    name, state, count = tolerance.told
    return {
        "class": name,
        "class_state": state,
        "class_enough": count.is_enough,
        "yield_pct": clean(100 * count.share),
        "limited_by": tolerance.limited_by,
    }


def _rig(candidate: Picked) -> dict[str, Any]:
    return {
        "baseline_mm": clean(candidate.baseline_m * 1e3),
        **_camera(candidate.interval),
        "depth_error_far_mm": clean(candidate.far_error_m * 1e3),
    }


def _tolerance(tolerance: Held, words: Words) -> DesignTolerance:
    """What must be held how tightly, and the yields of the classes."""
    result = tolerance.result
    return DesignTolerance(
        class_name=tolerance.class_name,
        required=required_part(result),
        rigs=result.n_rigs,
        points=result.n_points,
        distances_mm=[item.depth_m * 1e3 for item in result.depths],
        quantities=quantities_part(result),
        noise_mm=clean(tolerance.noise_error_m * 1e3),
        yields={
            item.name: CountedYield(
                as_built=item.as_built.share,
                as_built_se=item.as_built.standard_error,
                as_built_rigs=item.as_built.rigs,
                as_built_enough=item.as_built.is_enough,
                recalibrated=item.recalibrated.share,
                recalibrated_se=item.recalibrated.standard_error,
                recalibrated_rigs=item.recalibrated.rigs,
                recalibrated_enough=item.recalibrated.is_enough,
            )
            for item in tolerance.yields
        },
        tried=[
            Tried(
                says=words.attempt(item),
                yields=item.count.share,
                yield_se=item.count.standard_error,
                enough=item.count.is_enough,
            )
            for item in tolerance.advice
        ],
        says=words.tolerance_says(tolerance),
    )


def _camera(interval: Interval) -> dict[str, Any]:
    camera = interval.camera
    return {
        "name": camera.name,
        "focal_px": clean(camera.focal_px),
        "width_px": camera.width_px,
        "height_px": camera.height_px,
        "hfov_deg": clean(math.degrees(camera.hfov_rad)),
        "sensor": camera.sensor or None,
        "focal_mm": None if camera.focal_mm is None else clean(camera.focal_mm),
    }


def _housing(pick: Picked) -> Housing | None:
    housing = sensor_preset(pick.camera.sensor).housing if pick.camera.body_m else None
    if housing is None:
        return None
    return Housing(width_mm=housing.width_mm, camera=housing.camera, source=housing.source)


def _feasible(interval: Interval) -> Feasible:
    return Feasible(
        **_camera(interval),
        baseline_min_mm=clean(interval.lower.baseline_m * 1e3),
        baseline_max_mm=clean(interval.upper.baseline_m * 1e3),
        binding_min=_label(interval.lower.requirement),
        binding_max=_label(interval.upper.requirement),
    )


def _bound(end: End) -> Bound:
    return Bound(
        baseline_mm=clean(end.baseline_m * 1e3),
        requirement=_label(end.requirement),
        says=labels.whole(end.requirement),
    )


def _label(requirement: Requirement | None) -> Kind | None:
    return requirement.kind if requirement else None


def _achieved(asked: Requirement, pick: Picked, design: Design, proofs: Sequence[Proof]) -> Achieved:
    unit, scale = _UNITS[asked.kind]
    predicted = asked.achieved(pick.camera, pick.baseline_m, design.specification.disparity_std_px)
    noise, left, _ = design.specification.parts(asked, pick) if asked.calibration else (None, None, 0.0)
    held = held_to(asked, pick, proofs)
    told = verdict(asked, pick, proofs, design.specification)
    return Achieved(
        requirement=asked.kind,
        statistic="p95" if asked.per_std != 1 else "std",
        at_mm=clean(asked.depth_m * 1e3) if asked.depth_m > 0 else None,
        unit=unit,
        bound="at least" if asked.at_least else "at most",
        required=clean(asked.limit * scale),
        achieved=clean(predicted * scale),
        by_noise=None if noise is None else clean(noise * scale),
        by_calibration=None if left is None else clean(left * scale),
        simulated=None if held is None else _known(held.simulated * scale),
        shown_by=None if held is None else held.shown_by,
        points_n=0 if held is None else held.n_points,
        nearest_mm=None if held is None else _known(held.nearest_m * 1e3),
        farthest_mm=None if held is None else _known(held.farthest_m * 1e3),
        measured=None if held is None else _known(held.measured * scale),
        measured_n=0 if held is None else held.n_measured,
        met=told == "met",
        verdict=told,
    )


def _known(value: float) -> float | None:
    return clean(value) if math.isfinite(value) else None
