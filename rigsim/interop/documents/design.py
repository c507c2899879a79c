"""What `rigsim design --json` prints and design.json holds."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Literal, cast

from pydantic import Field

from rigsim.interop.documents.base import Part, SeenRig
from rigsim.interop.documents.text import clean
from rigsim.interop.documents.tolerance import Quantity, Required, quantities_part, required_part
from rigsim.study.design import words as labels
from rigsim.study.design.proof import Proof, held_to, recommended, verdict
from rigsim.study.design.solve import Candidate as Picked
from rigsim.study.design.solve import Design
from rigsim.study.design.tolerance import DesignTolerance as Held
from rigsim.theory.inverse import BaselineBound as End
from rigsim.theory.inverse import Interval, Requirement, RequirementKind

Kind = RequirementKind
"""A requirement's name."""

Preference = Literal["buildable", "smallest", "cheapest", "most-accurate"]

Unit = Literal["mm", "px", "fraction", "deg", "standard deviations"]
"""What a requirement's numbers are in."""


class Camera(Part):
    """A sensor behind a lens."""

    name: str
    """What it is called; empty without a sensor's name."""
    focal_px: float
    """Focal length, px."""
    width_px: int
    """Image width, px."""
    height_px: int
    """Image height, px."""
    hfov_deg: float
    """Horizontal field of view, degrees."""
    sensor: str | None
    """The sensor, by name; null where none was asked for."""
    focal_mm: float | None
    """Focal length, mm; null without a sensor."""


class Candidate(SeenRig):
    """A rig that meets the requirements by the formulas."""

    name: str
    """What its camera is called; empty without a sensor's name."""
    sensor: str | None
    """The sensor, by name; null where none was asked for."""
    focal_mm: float | None
    """Focal length, mm; null without a sensor."""
    depth_error_far_mm: float
    """Root mean square depth error at the far end that noise makes, mm."""


class Recommended(Candidate):
    """The rig to take."""

    verified: bool
    """Whether the simulation confirmed it."""
    reason: str
    """Why, or why not."""
    margin: float
    """Distance of the baseline from its nearest limit, as a share of the baseline."""
    noise_share: float
    """What pixel noise takes of the variance of the depth error asked for; of the worst of several."""
    class_name: Literal["printed", "machined", "calibrated"] | None = Field(alias="class")
    """The widest class of which 95 of 100 rigs keep the farthest depth error with noise, else the class asked
    for; null where no built rig can be judged."""
    class_state: Literal["as_built", "recalibrated"] | None
    """How: as built, or once every rig is recalibrated."""
    class_enough: bool | None
    """Whether 95 of 100 are good; null where that is not told."""
    yield_pct: float | None
    """Good rigs of that class in that state, noise and build together, %."""
    limited_by: str | None
    """What limits that yield: a quantity, by its key as in `tolerance.quantities`, or `noise`."""


class Proved(Candidate):
    """A rig that was rendered and simulated."""

    verified: bool
    """Whether that confirmed it."""
    reason: str
    """Why, or why not."""
    sensor: str | None
    """What the pictures were taken with; null where none was."""
    measured_method: str | None
    """What was measured in them; null when nothing was."""


class Bound(Part):
    """An end of the recommended rig's interval of baselines."""

    baseline_mm: float
    """Where it is, mm."""
    requirement: Kind | None
    """The requirement that puts it there; null when none does."""
    says: str
    """The same in words."""


class Binding(Part):
    """What keeps the baseline from being shorter or longer."""

    shortest: Bound
    longest: Bound


class Achieved(Part):
    """A requirement, and what the recommended rig makes of it; all in `unit`."""

    requirement: Kind
    """Its name."""
    statistic: Literal["std", "p95"]
    """What a depth error means: its root mean square (std), or what 95 of 100 stay under."""
    at_mm: float | None
    """Distance that it holds at, mm; null where it holds anywhere."""
    unit: Unit
    """Unit of the numbers below."""
    bound: Literal["at least", "at most"]
    """Which way it binds."""
    required: float
    """What was asked for."""
    achieved: float
    """What the rig does by the formulas."""
    simulated: float | None
    """What it did in the scene; null where that was not simulated."""
    shown_by: Literal["points", "plane", "rays", "pictures", "cameras"] | None
    """What showed it; null without a proof."""
    points_n: int
    """Points of the scene that rests on; 0 where it rests on none."""
    nearest_mm: float | None
    """Depth of the nearest of what showed it, mm; null where no points or plane did."""
    farthest_mm: float | None
    """Depth of the farthest, mm; more than 1.25 times off the distance where the scene has too few nearer."""
    measured: float | None
    """What was measured in the pictures; null where nothing was."""
    measured_n: int
    """Matches that rests on."""
    met: bool
    """Whether it is met, by all that is known."""
    verdict: Literal["met", "not_met", "not_shown"]
    """The same; not_shown where the scene has nothing that could show it."""


class Feasible(Camera):
    """A camera with which some baselines meet every requirement."""

    baseline_min_mm: float
    """The shortest, mm."""
    baseline_max_mm: float
    """The longest, mm."""
    binding_min: Kind | None
    """The requirement that makes it the shortest."""
    binding_max: Kind | None
    """The requirement that makes it the longest."""


class CountedYield(Part):
    """Rigs of one class that meet the requirement with their noise."""

    as_built: float
    """Share as built, 0 to 1."""
    as_built_se: float
    """Its standard error."""
    as_built_rigs: int
    """How many were built."""
    as_built_enough: bool | None
    """Whether at least 95 of 100 are good; null where that is not told."""
    recalibrated: float
    """Share after a recalibration that does not use the tolerances, 0 to 1."""
    recalibrated_se: float
    """Its standard error."""
    recalibrated_rigs: int
    """How many were recalibrated."""
    recalibrated_enough: bool | None
    """Whether at least 95 of 100 are good; null where that is not told."""


class Tried(Part):
    """One thing changed, for the class that comes nearest."""

    says: str
    """What was changed."""
    yields: float = Field(alias="yield")
    """Share of good rigs then, 0 to 1."""
    yield_se: float
    """Its standard error."""
    enough: bool | None
    """Whether at least 95 of 100 are good; null where that is not told."""


class DesignTolerance(Part):
    """What must be held how tightly for the recommended rig to keep its depth error."""

    class_name: str = Field(alias="class")
    """Class of the tolerances."""
    required: Required
    rigs: int
    """How many were built."""
    points: int
    """Points that each was judged by."""
    distances_mm: list[float]
    """Distances of the quantities' depth errors, mm."""
    quantities: list[Quantity]
    """The worst first."""
    noise_mm: float
    """RMS depth error at the required distance that pixel noise alone makes, mm."""
    yields: dict[str, CountedYield] = Field(alias="yield")
    """Share of good rigs with their noise, by class."""
    tried: list[Tried]
    """What was changed where no class will do; empty where one does, or where it is not told."""
    says: str
    """The same in words."""


class DesignDocument(Part):
    """The rigs that meet requirements, and one of them recommended and proved."""

    recommended: Recommended
    binding: Binding
    requirements: list[Achieved]
    """Those asked for and those implied."""
    range_mm: tuple[float, float]
    """Near and far end of the working range, mm."""
    build_share: float
    """Share of a depth error's variance that a pick was to leave for the build."""
    noise_px: float
    """Standard deviation of one pixel coordinate, px."""
    noise_source: Literal["given", "assumed", "measured"]
    """Where that comes from."""
    noise_says: str
    """The same in words."""
    preference: Preference
    """What --prefer asked for."""
    cameras_tried: int
    """How many, feasible or not."""
    feasible: list[Feasible]
    """Those with which some baseline meets every requirement."""
    pareto: list[Candidate]
    """Pareto-optimal rigs; best first."""
    proof: list[Proved]
    """Rigs that were rendered and simulated, in that order."""
    tolerance: DesignTolerance | None
    """Null where it was not looked into."""


def design_document(
    design: Design,
    proofs: Sequence[Proof],
    tolerance: Held | None,
    outcome: Callable[[Proof], str],
) -> dict[str, Any]:
    """The answer, as docs/reference/design.md says; `outcome` says how a rig was verified or why not."""
    pick = recommended(design, proofs)
    spec = design.specification
    return DesignDocument(
        recommended=Recommended(
            **_rig(pick),
            verified=any(proof.verified for proof in proofs),
            reason=_reason(pick, proofs, outcome),
            margin=clean(pick.margin),
            noise_share=clean(pick.noise_share),
            **_class(tolerance),
        ),
        binding=Binding(shortest=_bound(pick.interval.lower), longest=_bound(pick.interval.upper)),
        requirements=[_achieved(asked, pick, design, proofs) for asked in spec.requirements],
        range_mm=(clean(spec.near_m * 1e3), clean(spec.far_m * 1e3)),
        build_share=clean(spec.build_share),
        noise_px=clean(spec.noise_px),
        noise_source=spec.noise_source,
        noise_says=spec.noise_says,
        preference=cast("Preference", design.preference),
        cameras_tried=len(design.intervals),
        feasible=[_feasible(interval) for interval in design.feasible],
        pareto=[Candidate(**_rig(candidate)) for candidate in design.pareto],
        proof=[
            Proved(
                **_rig(proof.candidate) | {"sensor": proof.sensor or None},
                verified=proof.verified,
                reason=outcome(proof),
                measured_method=proof.method or None,
            )
            for proof in proofs
        ],
        tolerance=None if tolerance is None else _tolerance(tolerance),
    ).model_dump(by_alias=True)


def _reason(pick: Picked, proofs: Sequence[Proof], outcome: Callable[[Proof], str]) -> str:
    if not proofs:
        return "not verified: no proof was asked for"
    # of a rig that failed with less noise first, what was found last
    return outcome(next((proof for proof in reversed(proofs) if proof.candidate == pick), proofs[-1]))


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


def _tolerance(tolerance: Held) -> DesignTolerance:
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
                says=item.says,
                yields=item.count.share,
                yield_se=item.count.standard_error,
                enough=item.count.is_enough,
            )
            for item in tolerance.advice
        ],
        says=tolerance.says,
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


def _achieved(asked: Requirement, pick: Picked, design: Design, proofs: Sequence[Proof]) -> Achieved:
    unit, scale = _UNITS[asked.kind]
    predicted = asked.achieved(pick.camera, pick.baseline_m, design.specification.disparity_std_px)
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
