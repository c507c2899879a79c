"""What would help where no class of builders will do: found by trying, never by rule of thumb."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.stereo import StereoRig
from rigsim.study.design import words as words
from rigsim.study.design.budget import MARGIN
from rigsim.study.design.buildable import expected
from rigsim.study.design.solve import Candidate, Specification
from rigsim.study.saying import Saying, saying
from rigsim.study.tolerance.batch import PARAMETERS
from rigsim.study.tolerance.count import AS_BUILT, RECALIBRATED, Count, count_good
from rigsim.study.tolerance.first_order.predicted import quantity_of
from rigsim.study.tolerance.recalibration.session import Build, Recalibration
from rigsim.study.tolerance.rows import first_order_rows
from rigsim.study.tolerance.sensitivities import (
    QUANTITIES,
    BuildRequirement,
    Tolerances,
    causes,
    first_order,
    shared_points,
    with_values,
)

_TIGHTER = 10.0
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

    change: Saying
    """What was changed."""
    count: Count
    """The good rigs of the class that came nearest."""

    def helps(self, before: Count) -> bool:
        """Whether the yield rises by more than chance, and by more than 2 points."""
        rise = self.count.share - before.share
        return rise > max(_LEAST_RISE, _SIGMAS * math.hypot(self.count.standard_error, before.standard_error))


@dataclass(frozen=True, slots=True)
class _Attempted:
    change: Saying
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
    for tried in _changes(specification, pick, best, required, others):
        try:
            count = count_good(
                Build(
                    tried.rig,
                    tried.tolerances,
                    tried.noise_px,
                    tried.session if best.recalibrated else None,
                ),
                required,
                range_m,
                sizes=RECALIBRATED[:1] if best.recalibrated else AS_BUILT[:1],
                seed=seed,
            )
        except InvalidRange:
            continue  # such a rig sees too little to be judged
        found.append(Attempt(tried.change, count))
    return tuple(found)


def _changes(
    specification: Specification,
    pick: Candidate,
    best: Best,
    required: BuildRequirement,
    others: Sequence[Candidate],
) -> Iterator[_Attempted]:
    rig, noise_px = pick.rig, specification.noise_px
    session, builder = Recalibration(noise_px=noise_px), specification.builder
    plain = _Attempted(saying("nothing"), rig, builder.of(rig, best.name), noise_px, session)
    if best.recalibrated:
        yield from _calibrated(specification, plain, best)
        yield replace(
            plain,
            change=saying("more-pictures"),
            session=replace(session, pictures=10 * session.pictures),
        )
        sharper = session.length_std_mm / _TIGHTER
        yield replace(
            plain,
            change=saying("known-length", std_mm=sharper),
            session=replace(session, length_std_mm=sharper),
        )
    else:
        for names, values in _tighter(rig, plain.tolerances, required):
            bounds = plain.tolerances.bounds
            yield replace(
                plain,
                change=saying("held", quantities=names),
                tolerances=with_values(plain.tolerances, {**values, "bounds": bounds}),
            )
    longest_m = pick.interval.upper.baseline_m / (1 + MARGIN)
    if longest_m > 1.02 * pick.baseline_m:
        longer = replace(pick, baseline_m=longest_m).rig
        change = saying("longest-baseline", baseline_m=longest_m)
        yield replace(plain, change=change, rig=longer, tolerances=builder.of(longer, best.name))
    elsewhere = [item for item in others if item.camera != pick.camera]
    if elsewhere:
        other = min(elsewhere, key=lambda item: item.far_error_m)
        change = saying("other-rig", baseline_m=other.baseline_m, camera=words.camera(other.camera))
        yield replace(plain, change=change, rig=other.rig, tolerances=builder.of(other.rig, best.name))
    half = noise_px / 2
    yield replace(
        plain,
        change=saying("half-noise", noise_px=half),
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
    left = limit.remaining_std / _TIGHTER
    share = left / plain.rig.left.fx if name.endswith("focal_px") else math.nan
    yield replace(
        plain,
        change=saying("calibrated-before", parameter=name, std=left, share=share),
        session=replace(plain.session, known=((name, left),)),
    )


def _tighter(
    rig: StereoRig, tolerances: Tolerances, required: BuildRequirement
) -> Iterator[tuple[tuple[str, ...], Mapping[str, float]]]:
    """The quantities that do most held to a tenth: the first, the first two, the first three."""
    off = causes(rig, tolerances)
    points = shared_points(rig, required.depth_m, _POINTS)
    squares = (first_order(rig, off, points) ** 2).mean(axis=0) / required.error_m**2
    if required.row_px is not None:  # what takes most of its bound, whichever that is
        rows = (first_order_rows(rig, off, points) ** 2).mean(axis=0) / required.row_px**2
        squares = np.maximum(squares, rows)
    # the left and the right camera's are one thing to calibrate
    groups: dict[str, list[int]] = {}
    for place, key in enumerate(off.keys):
        groups.setdefault(key.removeprefix("left_").removeprefix("right_"), []).append(place)
    worst = sorted(groups.values(), key=lambda places: -float(squares[places].sum()))
    named: list[str] = []
    values: dict[str, float] = {}
    for places in worst[:3]:
        name = QUANTITIES[off.keys[places[0]]]
        named.append(name if len(places) == 1 else name.replace("left ", "").replace("right ", ""))
        values.update({off.keys[place]: float(off.values[place]) / _TIGHTER for place in places})
        yield tuple(named), dict(values)
