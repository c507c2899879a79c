"""What is off where a sweep flags a row: from asking the triangulator again.

The triangulator gets the pixels of some of the points once more, without noise: what it then gets wrong is
systematic, and every known mistake is made again and compared (`rigsim.study.sweep.models` for those with an
amount, `rigsim.study.verify.diagnosis.diagnosis` for the others). Where the true rig is not the assumed one,
the difference between the two is looked for in the same way. Where nothing is systematic, the scatter under
noise is held against what the noise makes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.agreement.fault import UNKNOWN, Fault
from rigsim.study.saying import Saying, saying
from rigsim.study.scene.plan import Triangulator
from rigsim.study.sweep.fit import Fit, fits, rig_differences
from rigsim.study.sweep.symptoms import (
    TRIALS,
    AskedPoints,
    ask,
    flat,
    scatter,
    where,
    without_disparity,
)
from rigsim.study.verify.case import Case
from rigsim.study.verify.checks import judge
from rigsim.study.verify.diagnosis.diagnosis import diagnose
from rigsim.study.verify.result import CaseResult, Diagnosis

_NEGLIGIBLE = 1e-3  # standard deviations of one trial: what no sweep would flag
_CONVINCING = 0.9
_ALONE = 0.99  # of rigs both of which are known
_ALIKE = 0.003  # share of the error that tells two mistakes apart
_LOST = 1e-3
_FEW = 8
# of `verify`: what only says where errors lie, and what is fitted here with its amount and its error
_WHERE_ONLY = ("-wrong", "-missing", "-zero")
_FITTED_HERE = ("scale", "depth-scale", "xy-scale", "focal-scale", "baseline-scale", "pixel-offset")
_FITTED_THERE = (
    "shifted-points",
    "other-frame",
    "shrunk-depth",
    "stretched-depth",
    "random-errors",
    "unknown",
)


def find_fault(
    true_rig: StereoRig,
    assumed_rig: StereoRig,
    points_left: Array,
    noise: PixelNoise,
    method: Triangulator,
) -> Fault | None:
    """What makes triangulated points (N, 3) m differ from what is predicted; None when nothing is found off.

    Args:
        true_rig: the rig that projects.
        assumed_rig: the rig that triangulates.
        points_left: true points that both cameras see, in the left camera's frame.
        noise: noise of the pixels.
        method: the triangulator.
    """
    with np.errstate(all="ignore"):
        asked = ask(assumed_rig, points_left, noise, method)
        if len(asked.points_left) < _FEW:
            return None
        found = asked.answer(assumed_rig)
        fault = _own(asked, found)
        if fault is None and true_rig is not assumed_rig:
            fault = _of_rigs(asked, true_rig)
        return fault or scatter(asked, noise)


def _own(asked: AskedPoints, found: Array) -> Fault | None:
    """What the triangulator itself gets wrong, whatever the rig."""
    size = asked.size(found)
    answered = np.asarray(np.isfinite(found).all(axis=1))
    off = np.asarray(answered & ~(size <= _NEGLIGIBLE))
    if not np.array_equal(found, asked.answer(asked.rig), equal_nan=True):
        return _random(asked)
    infinite = without_disparity(asked, found)
    if infinite is not None:
        return infinite
    lost = float((~answered).mean())
    if not off.any():
        return _lost(asked, found, lost) if lost > _LOST else None
    return _systematic(asked, found, off & answered)


def _random(asked: AskedPoints) -> Fault | None:
    """Of a triangulator that answers the same question differently each time."""
    found = np.stack([asked.answer(asked.rig) for _ in range(TRIALS)])
    lost = float((~np.isfinite(found).all(axis=2)).mean())
    size = [float(np.nanmedian(asked.size(one))) for one in found]
    if np.median(size) <= _NEGLIGIBLE:
        return Fault("lost-points", saying("lost-points: each time", share=lost))
    mean = np.nanmean(found, axis=0)
    if np.nanmedian(asked.size(mean)) <= 3 * np.median(size) / math.sqrt(TRIALS):
        return None
    return _named(asked, mean)


def _lost(asked: AskedPoints, found: Array, lost: float) -> Fault:
    told = _verified(asked, found)
    whole = [one for one in told if not one.mistake.endswith(_WHERE_ONLY) and one.explained >= _CONVINCING]
    if whole and lost > 1 / 2:
        return _told(whole)
    where = next((one for one in told if one.mistake.endswith("-missing")), None)
    if where is None or where.mistake.startswith("rows"):
        return Fault("lost-points", saying("lost-points", share=lost))
    return Fault("lost-points", saying("lost-points: which", share=lost, which=_as_verify(where)))


def _systematic(asked: AskedPoints, found: Array, off: Mask) -> Fault:
    """The mistake that leads to what was found; `off` says which rows are wrong."""
    same = flat(found)
    if same is not None:
        return same
    right = np.isfinite(found).all(axis=1) & ~off
    place = where(asked, off) if min(right.sum(), off.sum()) >= _FEW else None
    if place is None:
        return _named(asked, found)
    inside = _named(asked[off], found[off])
    return replace(
        inside,
        name=f"{inside.name}-in-a-part",
        said=saying("in-a-part", place=place, there=inside.said),
    )


def _named(asked: AskedPoints, found: Array) -> Fault:
    """The known mistake that explains what was found, or that none does."""
    answered = np.asarray(np.isfinite(found).all(axis=1))
    tried = _fits(asked[answered], found[answered]) if answered.sum() >= _FEW else []
    best = max((one.explained for one in tried), default=0.0)
    told = [one for one in _verified(asked, found) if not one.mistake.endswith(_WHERE_ONLY)]
    exact = [one for one in told if one.mistake not in (*_FITTED_HERE, *_FITTED_THERE)]
    share = max((one.explained for one in exact), default=0.0)
    if share >= _CONVINCING and share >= _linear(best) - _ALIKE:
        return _told(exact)
    if best >= _CONVINCING:
        return _fitted(tried, best)
    others = [one for one in told if one.mistake in _FITTED_THERE and one.explained >= _CONVINCING]
    if others:
        return Fault(others[0].mistake, _as_verify(others[0]), explained=others[0].explained)
    nearest = max(tried, key=lambda one: one.explained, default=None)
    if nearest is None or nearest.explained < 0.5:
        return UNKNOWN
    return Fault(
        "unknown",
        saying("none-known: nearest", nearest=nearest.said, share=nearest.explained),
        explained=nearest.explained,
    )


def _told(found: Sequence[Diagnosis]) -> Fault:
    """The best that `verify` names, with those that cannot be told from it."""
    first, *others = (one for one in found if one.explained >= found[0].explained - _ALIKE)
    said = saying("same-here", mistakes=tuple(_as_verify(one) for one in (first, *others[:1])))
    return Fault(first.mistake, said, explained=first.explained, also=tuple(one.mistake for one in others))


def _linear(explained: float) -> float:
    """A share of mean squares as a share of sizes."""
    return 1 - math.sqrt(max(1 - explained, 0.0))


def _fits(asked: AskedPoints, found: Array) -> list[Fit]:
    return fits(asked.rig, asked.points_left, found, asked.whitening)


def _fitted(tried: Sequence[Fit], best: float) -> Fault:
    """The best of the fits, with those that cannot be told from it."""
    alike = [one for one in tried if one.explained >= best - _ALIKE]
    first, *others = alike
    said = first.said
    if others:
        said = saying("same-here: amounts", first=said, others=tuple(one.said for one in others[:2]))
    return Fault(
        first.model.name,
        said,
        first.amount,
        first.amount_se,
        first.model.unit,
        first.explained,
        tuple(one.model.name for one in others),
    )


def _verified(asked: AskedPoints, found: Array) -> tuple[Diagnosis, ...]:
    """What `rigsim verify` makes of the answers."""
    uv_left, uv_right = asked.rig.project(asked.points_left)
    case = Case("sweep", "sweep", "exact", saying("sweep"), asked.rig, uv_left, uv_right, asked.points_left)
    result = CaseResult(case, "", judge(case, found, 1e-6).checks, found_left=found)
    return diagnose([result])


def _as_verify(found: Diagnosis) -> Saying:
    """What `rigsim verify` says, as part of another sentence."""
    return saying("as-verify", mistake=found.said)


def _of_rigs(asked: AskedPoints, true_rig: StereoRig) -> Fault | None:
    """How the true rig differs from the assumed one, as the errors show it."""
    found = asked.answer(true_rig)
    answered = np.asarray(np.isfinite(found).all(axis=1))
    if answered.sum() < _FEW or np.median(asked.size(found)[answered]) <= _NEGLIGIBLE:
        return None
    asked, found = asked[answered], found[answered]
    # the rigs are known to differ: a cause in a rig is likelier than one in the answers
    tried = sorted(_fits(asked, found), key=lambda one: one.model.of_answers)
    best = max(one.explained for one in tried)
    if best >= _ALONE:
        return _fitted(tried, best)
    known = rig_differences(asked.rig, true_rig, asked.points_left, asked.whitening)
    if not known:
        return UNKNOWN
    return Fault(
        "several",
        saying("several", differences=tuple(one.said for one in known)),
        also=tuple(one.model.name for one in known),
    )
