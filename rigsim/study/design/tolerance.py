"""What of a recommended rig must be held how tightly, and which class of builders makes it: noise included.

A built rig is good when its own depth errors, over the image that both cameras see and over its pixel noise,
keep the farthest requirement: their root mean square, or for p95 their 95th percentile. A class will do when
at least 95 of 100 of its rigs are good, and enough of them were built to tell.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from rigsim.errors import InvalidRange
from rigsim.study.design import words as words
from rigsim.study.design.buildable import expected, farthest_error, judged_by
from rigsim.study.design.help import Attempt, Best, attempts, help_sentence
from rigsim.study.design.solve import Candidate, Specification
from rigsim.study.tolerance.count import Count, count_good
from rigsim.study.tolerance.predicted import NOISE
from rigsim.study.tolerance.run import Build, Recalibration, ToleranceResult, run_tolerance
from rigsim.study.tolerance.sensitivities import CLASSES, QUANTITIES, UNITS
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
    says: str
    """What the build must hold, and who holds it, in sentences."""
    limited_by: str
    """What limits the yield of the class `told`: a quantity's key, or ``noise``."""

    @property
    def told(self) -> tuple[str, str, Count]:
        """The widest class that will do, else the own one: its name, ``as_built`` or ``recalibrated``,
        whichever is more, and its count."""
        return self.recommended or _better(next(y for y in self.yields if y.name == self.class_name))

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
    seed: int = 0,
    others: Sequence[Candidate] = (),
) -> DesignTolerance | None:
    """Rank the builder's tolerances of `pick` against the farthest depth error asked for; count good rigs.

    Where no class will do, it is tried what would: `others` are other rigs that meet the specification. None
    where the cameras share too little of the range to judge a built rig by.
    """
    builder = specification.builder
    class_name = builder.class_name
    asked, required = farthest_error(specification.requirements), judged_by(specification.requirements)
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
    says = f"{_must_hold(result, asked)} {_who(yields, class_name)} {help_sentence(best, advice)}".strip()
    held = DesignTolerance(class_name, result, yields, result.judged.noise_mm / 1e3, advice, says, "")
    name, state, _ = held.told
    limit = expected(rig, specification, name, state == "recalibrated")
    return replace(held, limited_by=NOISE if limit is None else limit.limited_by)


def _better(item: ClassYield) -> tuple[str, str, Count]:
    states = (("as_built", item.as_built), ("recalibrated", item.recalibrated))
    state, count = max(states, key=lambda pair: pair[1].share)
    return item.name, state, count


def _best(yields: Sequence[ClassYield]) -> Best:
    found = [
        Best(item.name, recalibrated, count)
        for item in yields
        for recalibrated, count in ((False, item.as_built), (True, item.recalibrated))
    ]
    return max(found, key=lambda best: best.count.share)


def _must_hold(result: ToleranceResult, asked: Asked) -> str:
    p95 = " (p95)" if asked.is_p95 else ""
    kept = f"{words.value(asked, asked.limit)}{p95} at {words.distance(asked.depth_m)}"
    worst = [item for item in result.sensitivities if math.isfinite(item.needed_equal_share)][:2]
    if not worst or worst[0].needed_equal_share == 0:
        return f"Pixel noise alone exceeds {kept}: no build can meet it."
    hold = " and ".join(
        f"{QUANTITIES[item.key]} to {'±' * result.tolerances.is_bound(item.key)}"
        f"{item.needed_equal_share:.2g} {UNITS[item.key]}".rstrip()
        for item in worst
    )
    return (
        f"For 95 of 100 rigs to stay within {kept}, pixel noise included, hold {hold} (when all quantities "
        "take equal shares of the build error)."
    )


def _who(yields: Sequence[ClassYield], class_name: str) -> str:
    own = next(item for item in yields if item.name == class_name)
    said = (
        f"Of {class_name} rigs {words.share(own.as_built.share)} % meet it as built, "
        f"{words.share(own.recalibrated.share)} % after recalibration"
    )
    for state, how in (("as_built", "as built"), ("recalibrated", "recalibrated")):
        for item in yields:
            count: Count = getattr(item, state)
            if count.is_enough:
                return f"{said}; class {item.name}, {how}, is enough ({words.share(count.share)} %)."
    for state, how in (("as_built", "as built"), ("recalibrated", "recalibrated")):
        for item in yields:
            count = getattr(item, state)
            if count.is_enough is None:
                low, high = count.interval
                return (
                    f"{said}; not enough to tell whether class {item.name}, {how}, is enough: "
                    f"{100 * low:.1f} to {100 * high:.1f} % of its rigs meet it, 95 % are required."
                )
    return f"{said}; no class is enough: a yield of 95 % is required."
