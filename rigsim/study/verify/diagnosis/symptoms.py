"""Marks that mistakes leave on the answers, whatever the rig: digits, order, limits, missing rows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.study.saying import Value, saying
from rigsim.study.verify.checks import exact_tolerance_m
from rigsim.study.verify.diagnosis.symptoms_plain import Mark, numbers, statistics
from rigsim.study.verify.diagnosis.symptoms_rows import FEW, SAME, WHERE, else_right, pooled, where
from rigsim.study.verify.result import CaseResult, Diagnosis
from rigsim.theory.uncertainty import parallax_px, pixel_gain

_MOST_DIGITS = 11
_SMALL_PX = 0.5
_PROBES = 100


def symptoms(results: Sequence[CaseResult]) -> list[tuple[float, Diagnosis]]:
    """What the failing cases share, with the share of them that do."""
    failing = [result for result in results if result.status() == "failed"]
    exact = [result for result in failing if result.case.covariance_px2 is None]
    marks: dict[str, list[tuple[Mark, CaseResult]]] = {}
    for result in exact or failing:
        for mark in _marks(result) if exact else statistics(result):
            marks.setdefault(mark.mistake, []).append((mark, result))
    if exact:
        for mark in pooled(results):
            told = [(mark, result) for result in exact if else_right(result)]
            if told:
                marks[mark.mistake] = told
    ranked = []
    for seen in marks.values():
        share = len(seen) / len(exact or failing)
        said = seen[0][0].said
        cases = tuple(result.case.name for _, result in seen)
        ranked.append((share * seen[0][0].weight - 0.005, Diagnosis(said, share, cases)))
    return ranked


def _marks(result: CaseResult) -> Iterator[Mark]:
    """Of a case without noise."""
    case, found = result.case, result.found_left
    if found is None or not len(case):
        return
    asked = case.answerable
    answered = np.asarray(np.isfinite(found).all(axis=1))
    both = asked & answered
    truth = case.points_left
    yield from _constant(result, found[answered])
    yield from _unasked(result, found, answered)
    if not asked.any():
        return
    yield from _order(truth[asked], found[asked])
    error = np.linalg.norm(found - truth, axis=1)
    allowed = exact_tolerance_m(case.rig, truth, pixel_gain(case.rig, truth))
    wrong = np.asarray(asked & ~(error <= allowed))
    if both.any():
        yield from _digits(result, found[both], truth[both])
        yield from _clamped(result, found, wrong & both)
    if both.any() and wrong.any() and not wrong[asked].all():
        yield from where(result, found, wrong, answered)
    if not answered[asked].any():
        yield Mark(saying("nothing-found"), WHERE)


def _constant(result: CaseResult, found: Array) -> Iterator[Mark]:
    if len(found) < FEW:
        return
    if not found.any():
        yield Mark(saying("zeros"))
    elif (np.abs(found - found[0]) <= SAME * np.abs(found[0])).all():
        yield Mark(saying("constant-answer", answer_m=numbers(found[0])))
    elif (
        not result.case.answerable.any()
        and (np.abs(found[:, 2] - found[0, 2]) <= SAME * np.abs(found[0, 2])).all()
    ):
        yield Mark(saying("disparity-clamped: nowhere", depth_m=float(found[0, 2])))


def _unasked(result: CaseResult, found: Array, answered: Mask) -> Iterator[Mark]:
    """Rows without an answer: what they became, and what became of the others."""
    case = result.case
    lost = ~(np.isfinite(case.uv_left).all(axis=1) & np.isfinite(case.uv_right).all(axis=1))
    in_front = np.isfinite(np.hstack(case.rig.project(np.where(answered[:, None], found, -1.0)))).all(axis=1)
    if lost.any() and not answered[case.answerable].all():
        yield Mark(saying("nan-spreads"))
    if (~case.answerable & answered & (found == 0).all(axis=1)).any():
        yield Mark(saying("nan-answered: by zeros"))
    if (lost & in_front).any():
        yield Mark(saying("nan-answered"))
    elif (~case.answerable & in_front).any():
        yield Mark(saying("points-made-up", case=case.name), 0.8)


def _order(truth: Array, found: Array) -> Iterator[Mark]:
    known = np.isfinite(found).all(axis=1)
    if len(found) < FEW or not known.any():
        return
    scale = SAME * (1 + np.abs(truth).max())
    own = np.flatnonzero(known)
    own = own[:: max(1, len(own) // _PROBES)]
    whose = np.array([np.abs(truth - point).max(axis=1).argmin() for point in found[own]])
    near = np.abs(truth[whose] - found[own]).max(axis=1) <= scale
    moved = near & (whose != own)
    if moved.mean() < 0.3 or near.mean() < 0.9:
        return
    steps = np.unique((whose - own)[near] % len(truth))
    if len(np.unique(whose)) < 0.9 * len(whose):
        yield Mark(saying("rows-repeated"))
    elif len(steps) == 1:
        back = len(truth) - int(steps[0])
        ahead = int(steps[0])
        yield Mark(saying("rows-shifted" if ahead <= back else "rows-shifted: before", rows=min(ahead, back)))
    elif (whose == len(truth) - 1 - own).all():
        yield Mark(saying("rows-reordered: reverse"))
    else:
        z = found[known, 2]
        by_depth = (np.diff(z) >= 0).all() or (np.diff(z) <= 0).all()
        yield Mark(saying("rows-reordered: by depth" if by_depth else "rows-reordered"))


def _digits(result: CaseResult, found: Array, truth: Array) -> Iterator[Mark]:
    """Few digits, and an error that is not much larger."""
    off_px = np.hstack(result.case.rig.project(found)) - np.hstack(result.case.rig.project(truth))
    if not found.any():
        return
    error = float(np.median(np.abs(found - truth).max(axis=1)))
    for digits in range(_MOST_DIGITS):
        step = 10.0**-digits
        few = np.abs(found - np.round(found, digits)) <= 1e-13 * np.abs(found) + 1e-15
        if few[:, 2].all():
            if 1e-3 * step < error <= 2 * step:
                form = "rounded-answers: decimals" if few.all() else "rounded-answers: of depths"
                yield Mark(saying(form, digits=digits, step_m=step))
                return
            break
    with np.errstate(all="ignore"):
        relative = _typical(np.linalg.norm(found - truth, axis=1) / np.linalg.norm(truth, axis=1))
    for bits, kind in ((16, np.float16), (32, np.float32)):
        with np.errstate(over="ignore"):
            held = any(_held(values, kind) for values in (found, found[:, 2], 1e3 * found, 1e3 * found[:, 2]))
        small = _typical(off_px) < _SMALL_PX and relative < 0.1 if bits == 32 else relative < 0.01
        if held and small:
            name = "single-precision: answers" if bits == 32 else "half-precision"
            yield Mark(saying(name))
            return
    sample = found[:20].ravel()
    for digits in range(2, _MOST_DIGITS + 1):
        if all(float(f"{value:.{digits}g}") == value for value in sample):
            if np.abs(found / truth - 1).max() <= 10.0 ** (2 - digits):
                yield Mark(saying("rounded-answers", digits=digits))
            return


def _held(values: Array, kind: type[np.floating]) -> bool:
    """Whether a type of fewer bits holds the numbers, but for the rounding of a change of unit."""
    return bool((np.abs(values - values.astype(kind)) <= 1e-14 * np.abs(values)).all())


def _clamped(result: CaseResult, found: Array, wrong: Mask) -> Iterator[Mark]:
    rig, truth = result.case.rig, result.case.points_left
    if wrong.sum() < FEW:
        return
    for values, true_values, what in (
        (found[:, 2], truth[:, 2], "depth"),
        (np.linalg.norm(found, axis=1), np.linalg.norm(truth, axis=1), "distance"),
    ):
        limit = float(np.median(values[wrong]))
        stuck = wrong & (np.abs(values - limit) <= SAME * abs(limit))
        if stuck.sum() < 0.9 * wrong.sum() or limit <= 0:
            continue
        at = found[np.flatnonzero(stuck)[:1]]
        disparity = float(parallax_px(rig, at)[0])
        found_out: dict[str, Value] = {
            "what": what,
            "limit_m": limit,
            "case": result.case.name,
            "disparity_px": disparity,
        }
        farther = float((true_values[stuck] > limit).mean())
        if farther > 0.9:
            yield Mark(saying("disparity-clamped", **found_out))
            return
        if farther < 0.1:
            yield Mark(saying("depth-clamped-near", **found_out))
            return


def _typical(off_px: Array) -> float:
    known = np.abs(off_px[np.isfinite(off_px)])
    return float(np.median(known)) if known.size else np.inf
