"""Rigs that can be built: how many of a class's rigs do what is asked, pixel noise and build together.

Candidates are judged to first order (`rigsim.study.tolerance.first_order.predicted`), as there are many;
the one that is recommended is built rig by rig (`rigsim.study.design.tolerance`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from rigsim.errors import InvalidRange
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.first_order.predicted import Expected, expect
from rigsim.study.tolerance.recalibration.session import Build, Recalibration
from rigsim.study.tolerance.sensitivities import CLASSES, BuildRequirement, Tolerances, with_values
from rigsim.theory.inverse import Requirement

if TYPE_CHECKING:
    from rigsim.study.design.solve import Candidate, Design, Specification

CLASS = "machined"
"""Class of builders, unless asked for otherwise."""
ENOUGH = 0.97
"""Expected share of good rigs with which 95 of 100 will be good, whatever the first order leaves out."""


@dataclass(frozen=True, slots=True)
class Builder:
    """Who builds the rig, and where it is used."""

    class_name: str = CLASS
    """One of `CLASSES`."""
    tolerances: tuple[tuple[str, float], ...] = ()
    """Tolerances in place of the class's, by their keys."""
    bounds: frozenset[str] = frozenset()
    """Which of those are bounds."""

    def __post_init__(self) -> None:
        if self.class_name not in CLASSES:
            raise InvalidRange(f"class {self.class_name!r}: choose one of {', '.join(CLASSES)}")

    def of(self, rig: StereoRig, class_name: str = "") -> Tolerances:
        """The tolerances of `rig`, of the own class or another one."""
        base = CLASSES[class_name or self.class_name].tolerances(rig)
        if not self.tolerances:
            return base
        given = dict(self.tolerances)
        return with_values(base, {**given, "bounds": (base.bounds - set(given)) | self.bounds})


MACHINISTS = Builder()
"""The usual one."""


def farthest_error(requirements: Sequence[Requirement]) -> Requirement:
    """The depth error asked for farthest off, the smallest where several are."""
    errors = [asked for asked in requirements if asked.kind == "depth_error"]
    return max(errors, key=lambda asked: (asked.depth_m, -asked.limit / asked.per_std))


def judged_by(specification: Specification) -> BuildRequirement:
    """What a built rig is held to."""
    asked = farthest_error(specification.requirements)
    return BuildRequirement(asked.limit, asked.depth_m, asked.is_p95, specification.row_px)


def buildable_first(candidates: Iterable[Candidate], specification: Specification) -> list[Candidate]:
    """The first of `candidates` that enough builders would make well comes first; where none is, the one
    that most would. The others keep their order."""
    left = list(candidates)
    poor: list[tuple[float, Candidate]] = []
    for place, candidate in enumerate(left):
        good = expected_share(candidate, specification)
        if good >= ENOUGH:
            return [candidate, *left[place + 1 :], *(other for _, other in sorted(poor, key=_worst_last))]
        poor.append((good, candidate))
    return [candidate for _, candidate in sorted(poor, key=_worst_last)]


def smallest_resolution(design: Design) -> Candidate | None:
    """The candidate with the fewest pixels, where resolutions were left open; with ``buildable``, of those
    that enough builders would make well. None where there is none, or only one resolution."""
    if not leaves_resolution_open(design):
        return None
    few_first = sorted(design.candidates, key=lambda candidate: candidate.camera.pixels)
    if design.preference != "buildable":
        return next(iter(few_first), None)
    return next((one for one in few_first if expected_share(one, design.specification) >= ENOUGH), None)


def leaves_resolution_open(design: Design) -> bool:
    """Whether cameras of several resolutions were tried."""
    return len({(one.camera.width_px, one.camera.height_px) for one in design.intervals}) > 1


def _worst_last(item: tuple[float, Candidate]) -> float:
    return -round(item[0], 2)


def expected_share(candidate: Candidate, specification: Specification) -> float:
    """Share of the class's rigs that is good, as built or recalibrated, whichever is more."""
    return _expected(candidate, specification)


@lru_cache(1024)
def _expected(candidate: Candidate, specification: Specification) -> float:
    best = 0.0
    for recalibrated in (False, True):
        found = expected(candidate.rig, specification, specification.builder.class_name, recalibrated)
        best = max(best, 0.0 if found is None else found.good)
        if best >= ENOUGH:
            break
    return best


def expected(
    rig: StereoRig, specification: Specification, class_name: str, recalibrated: bool
) -> Expected | None:
    """What to expect of a class's rigs; None where they share too little of the range to be judged."""
    session = Recalibration(noise_px=specification.noise_px) if recalibrated else None
    build = Build(rig, specification.builder.of(rig, class_name), specification.noise_px, session)
    try:
        return expect(build, judged_by(specification), (specification.near_m, specification.far_m))
    except InvalidRange:
        return None
