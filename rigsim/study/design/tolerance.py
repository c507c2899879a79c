"""What of a recommended rig must be held how tightly, and which class of builders makes it: noise included.

A built rig is good when its own depth errors, over the image that both cameras see and over its pixel noise,
keep the farthest requirement: their root mean square, or for p95 their 95th percentile. A class will do when
at least 95 of 100 of its rigs are good, and enough of them were built to tell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from rigsim.errors import InvalidRange
from rigsim.study.design.buildable import expected, farthest_error, judged_by
from rigsim.study.design.help import Attempt, Best, attempts
from rigsim.study.design.solve import Candidate, Specification
from rigsim.study.tolerance.count import Count, count_good
from rigsim.study.tolerance.first_order.predicted import NOISE
from rigsim.study.tolerance.run import Build, Recalibration, ToleranceResult, run_tolerance
from rigsim.study.tolerance.sensitivities import CLASSES
from rigsim.theory.inverse import Requirement as Asked

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
    limited_by: str
    """What limits the yield of the class `told`: a quantity's key, or ``noise``."""

    @property
    def told(self) -> tuple[str, str, Count]:
        """The widest class that will do, else the own one: its name, ``as_built`` or ``recalibrated``,
        whichever is more, and its count."""
        return _told(self.yields, self.class_name)

    @property
    def recommended(self) -> tuple[str, str, Count] | None:
        """The widest class that will do, ``as_built`` or ``recalibrated``, and its count; None for none."""
        return _recommended(self.yields)


def design_tolerance(
    specification: Specification,
    pick: Candidate,
    seed: int = 0,
    others: Sequence[Candidate] = (),
) -> DesignTolerance | None:
    """Rank the builder's tolerances of `pick` against the farthest depth error asked for; count good rigs.

    Where no class will do, it is tried what would: `others` are other rigs that meet the specification. None
    where the cameras share too little of the range to judge a built rig by.
    """
    builder = specification.builder
    class_name = builder.class_name
    asked, required = farthest_error(specification.requirements), judged_by(specification)
    rig, range_m, noise_px = pick.rig, (specification.near_m, specification.far_m), specification.noise_px
    session = Recalibration(noise_px=noise_px)
    try:
        result = run_tolerance(
            Build(rig, builder.of(rig), noise_px),
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
                        Build(rig, builder.of(rig, name), noise_px, recalibration),
                        required,
                        range_m,
                        seed=seed,
                    )
                    for recalibration in (None, session)
                ),
            )
            for name in CLASSES
        )
    except InvalidRange:
        return None
    advice: tuple[Attempt, ...] = ()
    best = _best(yields)
    if not any(
        count.is_enough is not False for item in yields for count in (item.as_built, item.recalibrated)
    ):
        advice = attempts(specification, pick, best, required, others, seed)
    told = _told(yields, class_name)
    limit = expected(rig, specification, told[0], told[1] == "recalibrated")
    return DesignTolerance(
        class_name,
        result,
        yields,
        result.judged.noise_mm / 1e3,
        advice,
        asked,
        best,
        NOISE if limit is None else limit.limited_by,
    )


def _recommended(yields: Sequence[ClassYield]) -> tuple[str, str, Count] | None:
    for state in ("as_built", "recalibrated"):
        for item in yields:
            count: Count = getattr(item, state)
            if count.is_enough:
                return item.name, state, count
    return None


def _told(yields: Sequence[ClassYield], class_name: str) -> tuple[str, str, Count]:
    own = next(item for item in yields if item.name == class_name)
    states = (("as_built", own.as_built), ("recalibrated", own.recalibrated))
    state, count = max(states, key=lambda pair: pair[1].share)
    return _recommended(yields) or (own.name, state, count)


def _best(yields: Sequence[ClassYield]) -> Best:
    found = [
        Best(item.name, recalibrated, count)
        for item in yields
        for recalibrated, count in ((False, item.as_built), (True, item.recalibrated))
    ]
    return max(found, key=lambda best: best.count.share)
