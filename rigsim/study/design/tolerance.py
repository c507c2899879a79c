"""What of a recommended rig must be held how tightly, and which class of builders makes it: noise included.

A built rig is good when its own depth errors, over the image that both cameras see and over its pixel noise,
keep the farthest requirement: their root mean square, or for p95 their 95th percentile. A class will do when
at least 95 of 100 of its rigs are good, and enough of them were built to tell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rigsim.errors import InvalidRange
from rigsim.study.design.help import Attempt, Best, attempts
from rigsim.study.design.solve import Candidate, Specification
from rigsim.study.tolerance.count import Count, count_good
from rigsim.study.tolerance.run import Build, Recalibration, ToleranceResult, run_tolerance
from rigsim.study.tolerance.sensitivities import CLASSES, BuildRequirement
from rigsim.theory.inverse import Requirement as Asked

CLASS = "machined"
"""Class whose tolerances are ranked, unless asked for otherwise."""
_RIGS = 2000
_POINTS = 240


@dataclass(frozen=True, slots=True)
class ClassYield:
    """Rigs of one class that meet the requirement with their pixel noise."""

    name: str
    """The class."""
    as_built: Count
    """As built."""
    recalibrated: Count
    """After a recalibration that knows nothing beforehand."""


@dataclass(frozen=True, slots=True, eq=False)
class DesignTolerance:
    """The tolerance study of a recommended rig."""

    class_name: str
    """The class that is ranked."""
    result: ToleranceResult
    """Its study, without recalibration."""
    yields: tuple[ClassYield, ...]
    """Every class, the widest first."""
    noise_error_m: float
    """What the pixel noise alone does at the same distance, m, root mean square."""
    advice: tuple[Attempt, ...]
    """What was tried where no class will do."""
    asked: Asked
    """The depth error that is required, as it was asked for."""
    best: Best
    """The class that comes nearest."""

    @property
    def recommended(self) -> tuple[str, str, Count] | None:
        """The widest class that will do, ``as_built`` or ``recalibrated``, and its count; None for none."""
        for state in ("as_built", "recalibrated"):
            for item in self.yields:
                count: Count = getattr(item, state)
                if count.is_enough:
                    return item.name, state, count
        return None


def design_tolerance(
    specification: Specification,
    pick: Candidate,
    class_name: str = CLASS,
    seed: int = 0,
    others: Sequence[Candidate] = (),
) -> DesignTolerance | None:
    """Rank the tolerances of `pick` against the farthest depth error asked for, and count good rigs.

    Where no class will do, it is tried what would: `others` are other rigs that meet the specification. None
    where the cameras share too little of the range to judge a built rig by.

    Raises:
        InvalidRange: no such class.
    """
    if class_name not in CLASSES:
        raise InvalidRange(f"class {class_name!r}: choose one of {', '.join(CLASSES)}")
    asked = farthest_error(specification.requirements)
    required = BuildRequirement(asked.limit, asked.depth_m, asked.is_p95)
    rig, range_m, noise_px = pick.rig, (specification.near_m, specification.far_m), specification.noise_px
    session = Recalibration(noise_px=noise_px)
    try:
        result = run_tolerance(
            Build(rig, CLASSES[class_name].tolerances(rig), noise_px),
            required,
            range_m,
            n_rigs=_RIGS,
            n_points=_POINTS,
            seed=seed,
            with_interactions=False,
        )
        yields = tuple(
            ClassYield(
                name,
                *(
                    count_good(
                        Build(rig, built.tolerances(rig), noise_px, recalibration),
                        required,
                        range_m,
                        seed=seed,
                    )
                    for recalibration in (None, session)
                ),
            )
            for name, built in CLASSES.items()
        )
    except InvalidRange:
        return None
    advice: tuple[Attempt, ...] = ()
    best = _best(yields)
    if not any(
        count.is_enough is not False for item in yields for count in (item.as_built, item.recalibrated)
    ):
        advice = attempts(specification, pick, best, required, others, seed)
    return DesignTolerance(class_name, result, yields, result.judged.noise_mm / 1e3, advice, asked, best)


def farthest_error(requirements: Sequence[Asked]) -> Asked:
    """The depth error asked for farthest off, the smallest where several are."""
    errors = [asked for asked in requirements if asked.kind == "depth_error"]
    return max(errors, key=lambda asked: (asked.depth_m, -asked.limit / asked.per_std))


def _best(yields: Sequence[ClassYield]) -> Best:
    found = [
        Best(item.name, recalibrated, count)
        for item in yields
        for recalibrated, count in ((False, item.as_built), (True, item.recalibrated))
    ]
    return max(found, key=lambda best: best.count.share)
