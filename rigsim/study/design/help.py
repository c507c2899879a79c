"""What would help where no class of builders will do: found by trying, never by rule of thumb."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from rigsim.errors import InvalidRange
from rigsim.rig.stereo import StereoRig
from rigsim.study.design import words as words
from rigsim.study.design.budget import MARGIN
from rigsim.study.design.buildable import expected
from rigsim.study.design.solve import Candidate, Specification
from rigsim.study.tolerance.batch import PARAMETERS
from rigsim.study.tolerance.count import AS_BUILT, RECALIBRATED, Count, count_good
from rigsim.study.tolerance.predicted import quantity_of
from rigsim.study.tolerance.recalibration.session import Build, Recalibration
from rigsim.study.tolerance.sensitivities import (
    QUANTITIES,
    UNITS,
    BuildRequirement,
    Tolerances,
    causes,
    first_order,
    shared_points,
    with_values,
)

_TIGHTER = 10.0
_HELD = " held to a tenth of the class's tolerance"
_SIGMAS = 2.5758  # a rise this many standard errors large is chance in one try of two hundred
_LEAST_RISE = 0.02
_POINTS = 32


@dataclass(frozen=True, slots=True)
class Best:
    """The class that comes nearest."""

    name: str
    """The class."""
    recalibrated: bool
    """Whether each rig is recalibrated."""
    count: Count
    """Its good rigs."""


@dataclass(frozen=True, slots=True)
class Attempt:
    """One thing that was changed, and the good rigs then."""

    says: str
    """What was changed, in words."""
    count: Count
    """The good rigs of the class that came nearest."""

    def helps(self, before: Count) -> bool:
        """Whether the yield rises by more than chance, and by more than 2 points."""
        rise = self.count.share - before.share
        return rise > max(_LEAST_RISE, _SIGMAS * math.hypot(self.count.standard_error, before.standard_error))


@dataclass(frozen=True, slots=True)
class _Attempted:
    says: str
    rig: StereoRig
    tolerances: Tolerances
    noise_px: float
    session: Recalibration


def attempts(
    specification: Specification,
    pick: Candidate,
    best: Best,
    required: BuildRequirement,
    others: Sequence[Candidate],
    seed: int,
) -> tuple[Attempt, ...]:
    """Build rigs of the class that comes nearest again, with one thing changed at a time."""
    range_m = (specification.near_m, specification.far_m)
    found = []
    for change in _changes(specification, pick, best, required, others):
        try:
            count = count_good(
                Build(
                    change.rig,
                    change.tolerances,
                    change.noise_px,
                    change.session if best.recalibrated else None,
                ),
                required,
                range_m,
                sizes=RECALIBRATED[:1] if best.recalibrated else AS_BUILT[:1],
                seed=seed,
            )
        except InvalidRange:
            continue  # such a rig sees too little to be judged
        found.append(Attempt(change.says, count))
    return tuple(found)


def help_sentence(best: Best, tried: Sequence[Attempt]) -> str:
    """What of all that was tried would do, else what helps, else that nothing does; empty without any."""
    if not tried:
        return ""
    how = "recalibrated" if best.recalibrated else "as built"
    nearest = f"The closest is {best.name} {how}, {words.share(best.count.share)} %"
    enough = _shortest([item for item in tried if item.count.is_enough])
    if enough:
        said = "; or ".join(f"{item.says} ({words.share(item.count.share)} %)" for item in enough)
        return f"{nearest}: enough would be {said}."
    helping = sorted((item for item in tried if item.helps(best.count)), key=lambda item: -item.count.share)
    if helping:
        said = ", ".join(f"{item.says} ({words.share(item.count.share)} %)" for item in helping)
        return f"{nearest}; these help, but not enough alone: {said}."
    said = ", ".join(item.says for item in tried)
    return f"{nearest}; nothing that was tried helps: {said}. Relax the requirement, or raise --build-share."


def _shortest(enough: Sequence[Attempt]) -> list[Attempt]:
    """Without those that only hold more quantities than another."""
    return [
        item
        for item in enough
        if not any(
            other is not item and item.says.startswith(other.says.removesuffix(_HELD)) and _HELD in other.says
            for other in enough
        )
    ]


def _changes(
    specification: Specification,
    pick: Candidate,
    best: Best,
    required: BuildRequirement,
    others: Sequence[Candidate],
) -> Iterator[_Attempted]:
    rig, noise_px = pick.rig, specification.noise_px
    session, builder = Recalibration(noise_px=noise_px), specification.builder
    plain = _Attempted("", rig, builder.of(rig, best.name), noise_px, session)
    if best.recalibrated:
        yield from _calibrated(specification, plain, best)
        yield replace(
            plain,
            says="ten times the pictures",
            session=replace(session, pictures=10 * session.pictures),
        )
        sharper = session.length_std_mm / _TIGHTER
        yield replace(
            plain,
            says=f"a length known to {sharper:g} mm",
            session=replace(session, length_std_mm=sharper),
        )
    else:
        for says, values in _tighter(rig, plain.tolerances, required):
            bounds = plain.tolerances.bounds
            yield replace(
                plain, says=says, tolerances=with_values(plain.tolerances, {**values, "bounds": bounds})
            )
    longest_m = pick.interval.upper.baseline_m / (1 + MARGIN)
    if longest_m > 1.02 * pick.baseline_m:
        longer = replace(pick, baseline_m=longest_m).rig
        says = f"the longest baseline allowed, {words.size(longest_m)}"
        yield replace(plain, says=says, rig=longer, tolerances=builder.of(longer, best.name))
    elsewhere = [item for item in others if item.camera != pick.camera]
    if elsewhere:
        other = min(elsewhere, key=lambda item: item.far_error_m)
        says = f"another rig, {words.size(other.baseline_m)} baseline and {words.camera(other.camera)}"
        yield replace(plain, says=says, rig=other.rig, tolerances=builder.of(other.rig, best.name))
    half = noise_px / 2
    yield replace(
        plain,
        says=f"half the pixel noise, {half:.3g} px",
        noise_px=half,
        session=replace(session, noise_px=half),
    )


def _calibrated(specification: Specification, plain: _Attempted, best: Best) -> Iterator[_Attempted]:
    """The quantity that limits, calibrated before ten times as well as the recalibration does."""
    limit = expected(plain.rig, specification, best.name, recalibrated=True)
    name = (
        None if limit is None else next((p for p in PARAMETERS if quantity_of(p) == limit.limited_by), None)
    )
    if limit is None or name is None:
        return
    left, key = limit.remaining_std / _TIGHTER, limit.limited_by
    unit, scale = {"rad": ("deg", math.degrees(1)), "m": ("mm", 1e3)}.get(
        name.rpartition("_")[2], (UNITS[key], 1.0)
    )
    amount = f"{left * scale:.2g} {unit}".rstrip()
    if name.endswith("focal_px"):
        amount = f"{100 * left / plain.rig.left.fx:.2g} %"
    yield replace(
        plain,
        says=f"{QUANTITIES[key]} calibrated to {amount}",
        session=replace(plain.session, known=((name, left),)),
    )


def _tighter(
    rig: StereoRig, tolerances: Tolerances, required: BuildRequirement
) -> Iterator[tuple[str, Mapping[str, float]]]:
    """The quantities that do most held to a tenth: the first, the first two, the first three."""
    off = causes(rig, tolerances)
    errors = first_order(rig, off, shared_points(rig, required.depth_m, _POINTS))
    # the left and the right camera's are one thing to calibrate
    groups: dict[str, list[int]] = {}
    for place, key in enumerate(off.keys):
        groups.setdefault(key.removeprefix("left_").removeprefix("right_"), []).append(place)
    worst = sorted(groups.values(), key=lambda places: -float((errors[:, places] ** 2).sum()))
    named: list[str] = []
    values: dict[str, float] = {}
    for places in worst[:3]:
        name = QUANTITIES[off.keys[places[0]]]
        named.append(name if len(places) == 1 else name.replace("left ", "").replace("right ", ""))
        values.update({off.keys[place]: float(off.values[place]) / _TIGHTER for place in places})
        yield f"{' and '.join(named)}{_HELD}", dict(values)
