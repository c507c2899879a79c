"""What the build of a recommended rig must hold, who holds it, and what would help, in sentences."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rigsim.digits import short
from rigsim.present.kit.sayings import Sentences, spoken
from rigsim.present.tolerance.words import motion_sentence
from rigsim.study.design import words as words
from rigsim.study.design.help import Attempt, Best
from rigsim.study.design.tolerance import DesignTolerance
from rigsim.study.tolerance.count import Count
from rigsim.study.tolerance.first_order.predicted import NOISE, quantity_of
from rigsim.study.tolerance.sensitivities import QUANTITIES, UNITS


def _calibrated_before(parameter: str, std: float, share: float) -> str:
    key = quantity_of(parameter)
    if math.isfinite(share):
        return f"{QUANTITIES[key]} calibrated to {short(100 * share, 2)} %"
    amount = std * {"deg": math.degrees(1), "mm": 1e3}.get(UNITS[key], 1.0)
    return f"{QUANTITIES[key]} calibrated to {short(amount, 2)} {UNITS[key]}".rstrip()


CHANGED: Sentences = {
    "calibrated-before": _calibrated_before,
    "nothing": "nothing",
    "more-pictures": "ten times the pictures",
    "known-length": "a length known to {std_mm:g} mm",
    "held": lambda quantities: f"{' and '.join(quantities)} held to a tenth of the class's tolerance",
    "longest-baseline": lambda baseline_m: f"the longest baseline allowed, {words.size(baseline_m)}",
    "other-rig": lambda baseline_m, camera: f"another rig, {words.size(baseline_m)} baseline and {camera}",
    "half-noise": "half the pixel noise, {noise_px:.3g} px",
}
"""What may be changed where no class will do."""


STATES = ("as_built", "recalibrated")
"""How rigs of a class may be, by the names of `ClassYield`."""


def tolerance_says(tolerance: DesignTolerance) -> str:
    """What the build must hold, who holds it, and what would help where no class will do."""
    told = (
        _must_hold(tolerance),
        _moving(tolerance),
        _who(tolerance),
        _worse(tolerance),
        advice_says(tolerance.best, tolerance.advice),
    )
    return " ".join(part for part in told if part)


def _worse(tolerance: DesignTolerance) -> str:
    """Why rigs of a class are worse for a recalibration; empty where none are beyond chance."""
    names = [
        item.name
        for item in tolerance.yields
        if item.as_built.share - item.recalibrated.share
        > 3 * math.hypot(item.as_built.standard_error, item.recalibrated.standard_error)
    ]
    if not names:
        return ""
    return (
        "The recalibration starts from nothing and knows less than a build of class "
        f"{' or '.join(names)} holds already: leave it out there, or take more pictures and better lengths "
        "(rigsim tolerance --recalibration-pictures, --length-std)."
    )


def limit_says(tolerance: DesignTolerance) -> str:
    """The yield of the class that will do, or was asked for, and what limits it."""
    name, state, count = tolerance.told
    limit = "pixel noise" if tolerance.limited_by == NOISE else QUANTITIES[tolerance.limited_by]
    how = "recalibrated" if state == "recalibrated" else "as built"
    return f"Class {name}, {how}: {words.share(count.share)} % with noise and build, limited most by {limit}."


def held_by(tolerance: DesignTolerance) -> tuple[str, str]:
    """Kind and words of how many built rigs hold it: of the class that will do, or of the one that comes
    nearest; ``agrees`` where they are enough, ``flagged`` where they are too few, ``untold`` else."""
    name, state, counted = tolerance.told
    if not counted.is_enough:
        name, state, counted = max(
            ((item.name, state, getattr(item, state)) for item in tolerance.yields for state in STATES),
            key=lambda one: one[2].share,
        )
    how = "recalibrated" if state == "recalibrated" else "as built"
    said = f"{words.share(counted.share)} % of {name} rigs, {how}, hold it"
    if counted.is_enough:
        return "agrees", said
    if counted.is_enough is None:
        return "untold", f"{said}: not enough to tell whether 95 % do"
    return "flagged", f"{said}, and no class more: too few"


def attempt(tried: Attempt) -> str:
    """What was changed."""
    return spoken(tried.change, CHANGED)


def _must_hold(tolerance: DesignTolerance) -> str:
    result, asked = tolerance.result, tolerance.asked
    p95 = " (p95)" if asked.is_p95 else ""
    kept = f"{words.value(asked, asked.limit)}{p95} at {words.distance(asked.depth_m)}"
    worst = [item for item in result.sensitivities if math.isfinite(item.needed_equal_share)]
    if result.required.row_px is not None:
        kept += f", and rows within {result.required.row_px:g} px at every distance"
        worst.sort(key=lambda item: item.needed_equal_share / item.tolerance)
    if not worst or worst[0].needed_equal_share == 0:
        return f"Pixel noise alone exceeds {kept}: no build can meet it."
    hold = " and ".join(
        f"{QUANTITIES[item.key]} to {'±' * result.tolerances.is_bound(item.key)}"
        f"{short(item.needed_equal_share, 2)} {UNITS[item.key]}".rstrip()
        for item in worst[:2]
    )
    return (
        f"For 95 of 100 rigs to stay within {kept}, pixel noise included, hold {hold} (when all quantities "
        "take equal shares of the build error)."
    )


def _moving(tolerance: DesignTolerance) -> str:
    """What a time offset was taken to act on; empty without one."""
    said = motion_sentence(tolerance.result)
    if not said:
        return ""
    return f"{said[:-1]}: that is assumed; rigsim tolerance takes other speeds, forward too, and turns."


def _who(tolerance: DesignTolerance) -> str:
    yields, class_name = tolerance.yields, tolerance.class_name
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


def advice_says(best: Best, tried: Sequence[Attempt]) -> str:
    """What of all that was tried would do, else what helps, else that nothing does; empty without any."""
    if not tried:
        return ""
    how = "recalibrated" if best.recalibrated else "as built"
    nearest = f"The closest is class {best.name}, {how}, {words.share(best.count.share)} %"
    enough = _shortest([item for item in tried if item.count.is_enough])
    if enough:
        return f"{nearest}: enough would be {'; or '.join(map(_counted, enough))}."
    helping = sorted((item for item in tried if item.helps(best.count)), key=lambda item: -item.count.share)
    if helping:
        short_of = ", ".join(_counted(item) for item in helping if item.count.is_enough is False)
        untold = ", ".join(_counted(item) for item in helping if item.count.is_enough is None)
        said = [f"these help it, but not enough alone: {short_of}"] if short_of else []
        said += [f"these may be enough for it, which so few rigs do not tell: {untold}"] if untold else []
        return f"{nearest}; {'; '.join(said)}."
    without = ", ".join(attempt(item) for item in tried)
    return (
        f"{nearest}; nothing that was tried helps: {without}. Relax the requirement, or raise --build-share."
    )


def _counted(item: Attempt) -> str:
    """What was changed, and the good rigs then, %."""
    return f"{attempt(item)} ({words.share(item.count.share)} %)"


def _shortest(enough: Sequence[Attempt]) -> list[Attempt]:
    """Without those that only hold more quantities than another."""
    held = [_held(item) for item in enough]
    return [
        item
        for item, names in zip(enough, held, strict=True)
        if not any(other and len(other) < len(names) and names[: len(other)] == other for other in held)
    ]


def _held(item: Attempt) -> tuple[object, ...]:
    """The quantities that are held more tightly; none where something else was changed."""
    names = dict(item.change.values).get("quantities", ())
    return names if isinstance(names, tuple) else ()
