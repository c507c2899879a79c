"""What of a recommended rig must be held how tightly: the tolerance study at the design's own requirement."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from rigsim.errors import InvalidRange
from rigsim.study import design_words as words
from rigsim.study.design import Candidate, Specification
from rigsim.study.tolerance import CLASSES, QUANTITIES, UNITS, Requirement
from rigsim.study.tolerance_yield import Recalibration, ToleranceResult, run_tolerance
from rigsim.theory.inverse import Requirement as Asked

CLASS = "machined"
"""Class whose tolerances are ranked, unless asked for otherwise."""
_RIGS = 300
_POINTS = 60


@dataclass(frozen=True, slots=True)
class ClassYield:
    """Share of rigs of one class that meet the requirement."""

    name: str
    """The class."""
    as_built: float
    """As built, 0 to 1."""
    recalibrated: float | None
    """After recalibration, 0 to 1."""


@dataclass(frozen=True, slots=True, eq=False)
class DesignTolerance:
    """The tolerance study of a recommended rig."""

    class_name: str
    """The class that is ranked."""
    result: ToleranceResult
    """Its study."""
    yields: tuple[ClassYield, ...]
    """Every class, the widest first."""
    noise_error_m: float
    """What the pixel noise alone does at the same distance, m, one standard deviation."""
    says: str
    """One sentence for those who build it."""


def design_tolerance(
    specification: Specification, pick: Candidate, class_name: str = CLASS, seed: int = 0
) -> DesignTolerance | None:
    """Rank the tolerances of `pick` against the farthest depth error asked for, and count good rigs.

    A requirement in p95 counts as one standard deviation, 1.96 times smaller. None where the cameras share
    too little of the range to judge a built rig by.

    Raises:
        InvalidRange: no such class.
    """
    if class_name not in CLASSES:
        raise InvalidRange(f"class {class_name!r}: choose one of {', '.join(CLASSES)}")
    asked = farthest_error(specification.requirements)
    required = Requirement(asked.limit / asked.per_std, asked.depth_m)
    rig, range_m = pick.rig, (specification.near_m, specification.far_m)
    compensator = Recalibration(noise_px=specification.noise_px)
    try:
        results = {
            name: run_tolerance(
                rig,
                built.tolerances(rig),
                required,
                range_m,
                recalibration=compensator,
                n_rigs=_RIGS,
                n_points=_POINTS,
                seed=seed,
                with_interactions=False,
            )
            for name, built in CLASSES.items()
        }
    except InvalidRange:
        return None
    yields = tuple(
        ClassYield(name, result.yield_before, result.yield_after) for name, result in results.items()
    )
    noise_error_m = (
        asked.depth_m**2 * specification.disparity_std_px / (pick.camera.focal_px * pick.baseline_m)
    )
    result = results[class_name]
    return DesignTolerance(
        class_name, result, yields, noise_error_m, _says(result, asked, yields, class_name)
    )


def farthest_error(requirements: Sequence[Asked]) -> Asked:
    """The depth error asked for farthest off, the smallest where several are."""
    errors = [asked for asked in requirements if asked.kind == "depth_error"]
    return max(errors, key=lambda asked: (asked.depth_m, -asked.limit / asked.per_std))


def _says(result: ToleranceResult, asked: Asked, yields: Sequence[ClassYield], class_name: str) -> str:
    worst = [item for item in result.sensitivities if math.isfinite(item.needed_equal_share)][:2]
    hold = " and ".join(
        f"{QUANTITIES[item.key]} to {'±' * result.tolerances.is_bound(item.key)}"
        f"{item.needed_equal_share:.2g} {UNITS[item.key]}".rstrip()
        for item in worst
    )
    own = next(item for item in yields if item.name == class_name)
    after = own.recalibrated or 0.0
    good = next((item.name for item in yields if item.as_built >= _GOOD), None)
    said = (
        f"To keep {words.size(result.required.error_m)} at {words.distance(asked.depth_m)} the build must "
        f"hold the {hold}: of {result.n_rigs} {class_name} rigs {words.share(own.as_built)} % meet it as "
        f"built, {words.share(after)} % once each is recalibrated"
    )
    if good is not None:
        return f"{said}; class {good} will do as built."
    if after >= _GOOD:
        return f"{said}, so build to this class and recalibrate every rig."
    better = next((item.name for item in yields if (item.recalibrated or 0.0) >= _GOOD), None)
    if better is not None:
        return f"{said}; class {better} with recalibration will do."
    return f"{said}; no class will do, so take a longer baseline or ask for less."


_GOOD = 0.95
