"""What shows without making a mistake again: errors that say it themselves, noise, and the last resort."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.study.saying import Saying, saying
from rigsim.study.verify.result import CaseResult, Diagnosis

_LOST_DIGITS_PX = 5e-3
_SINGLE_PX = 2e-4  # of a picture 2000 px wide


class Mark(NamedTuple):
    """What one case shows."""

    said: Saying
    """What it is, with what is true of this case."""
    weight: float = 1.0
    """How much it tells beside a mistake that was made again."""

    @property
    def mistake(self) -> str:
        """Short name."""
        return self.said.subject


def broken(results: Sequence[CaseResult]) -> list[Diagnosis]:
    """What errors say, the most frequent first."""
    wrong = sum(result.status() in ("failed", "error") for result in results)
    grouped: dict[str, tuple[Saying, list[str]]] = {}
    for result in results:
        if result.status() == "error":
            mark = _broken(result)
            grouped.setdefault(mark.mistake, (mark.said, []))[1].append(result.case.name)
    told = [Diagnosis(said, len(cases) / wrong, tuple(cases)) for said, cases in grouped.values()]
    return sorted(told, key=lambda diagnosis: -diagnosis.explained)


def _broken(result: CaseResult) -> Mark:
    match result.reason:
        case "timed-out":
            return Mark(saying("times-out"))
        case "wrong-shape":
            return _of_shape(result.shape, len(result.case), int(result.case.answerable.sum()))
        case "wrong-type":
            return Mark(saying("wrong-type", error=result.error))
        case "raised":
            return Mark(saying("raises", error=result.error))
        case _:
            return Mark(saying("broken", error=result.error))


def _of_shape(shape: tuple[int, ...], n: int, asked: int) -> Mark:
    """What an answer's shape says, for `n` rows of which `asked` have an answer."""
    match shape:
        case (3, m) if m == n:
            return Mark(saying("transposed-answer"))
        case (4, m) if m == n:
            return Mark(saying("homogeneous-answer: transposed"))
        case (m, 4) if m == n:
            return Mark(saying("homogeneous-answer"))
        case (m, 2) if m == n:
            return Mark(saying("depth-missing"))
        case (m,) if m == n:
            return Mark(saying("depth-alone"))
        case (m, 3) if m == asked and asked < n:
            return Mark(saying("rows-dropped"))
        case (m, 3):
            return Mark(saying("rows-dropped: counted", rows=m, of=n))
        case (_, *rest) if len(rest) > 1 and 3 in rest:
            return Mark(saying("extra-dimension", shape=shape))
    return Mark(saying("wrong-shape", shape=shape, rows=n))


def statistics(result: CaseResult) -> Iterator[Mark]:
    """Of a case with noise, where all without noise pass."""
    checks = {check.name: check for check in result.failed_checks}
    size = checks.get("size") or checks.get("depth")
    if size is not None and size.value > size.high:
        yield Mark(saying("inefficient: with noise", times=size.value))
    if size is not None and size.value < size.low:
        yield Mark(saying("too-good", times=size.value))
    if "unbiased" in checks:
        yield Mark(saying("biased", sigmas=checks["unbiased"].value))
    if "answered" in checks:
        yield Mark(saying("rows-missing: with noise", rows=checks["answered"].value))


def wasteful(results: Sequence[CaseResult]) -> tuple[Diagnosis, ...]:
    """Where nothing fails: whether errors are too large in most cases with noise, though not by far."""
    noisy = [result for result in results if result.case.kind == "noisy" and not result.not_applicable]
    large = [result for result in noisy if result.status() == "inefficient"]
    if len(large) <= len(noisy) / 2:
        return ()
    times = float(np.median([result.efficiency for result in large]))
    share = len(large) / len(noisy)
    return (
        Diagnosis(saying("inefficient", times=times), share, tuple(result.case.name for result in large)),
    )


def last_resort(results: Sequence[CaseResult]) -> list[Diagnosis]:
    """What can be said when no mistake fits: which rigs fail, and how the errors look."""
    failing = [result for result in results if result.status() == "failed"]
    exact = [r for r in failing if r.case.covariance_px2 is None and r.case.answerable.any()]
    return [Diagnosis(_how(exact, _which(results)), 0.0, tuple(result.case.name for result in failing))]


_FEATURES: tuple[tuple[str, Callable[[CaseResult], bool]], ...] = (
    ("doffs", lambda r: abs(r.case.rig.doffs_px) > 1e-9),
    ("distortion", lambda r: bool(r.case.rig.left.lens or r.case.rig.right.lens)),
    ("turn", lambda r: bool(np.abs(r.case.rig.right_from_left.R - np.eye(3)).max() > 1e-9)),
    ("non-square", lambda r: r.case.rig.left.fx != r.case.rig.left.fy),
    ("two-lenses", lambda r: r.case.rig.left != r.case.rig.right),
    ("off-x", lambda r: bool(np.abs(r.case.rig.right_from_left.t[1:]).max() > 1e-9)),
    ("unrectified", lambda r: not r.case.rig.is_rectified),
    ("far", lambda r: bool((r.case.points_left[:, 2] > 50).any())),
)


def _which(results: Sequence[CaseResult]) -> Saying:
    """The property of rigs that tells failing cases from passing ones best."""
    judged = [
        r
        for r in results
        if r.status() in ("failed", "passed", "inefficient") and r.case.kind in ("exact", "measured")
    ]
    failing = [result.status() == "failed" for result in judged]
    if not any(failing) or all(failing):
        return saying("failing: all" if any(failing) else "failing: none")
    for name, has in _FEATURES:
        if [has(result) for result in judged] == failing:
            return saying("failing: those", rigs=saying(f"rigs: {name}"))
    for name, has in _FEATURES:
        if all(has(result) for result, fails in zip(judged, failing, strict=True) if fails):
            return saying("failing: only", rigs=saying(f"rigs: {name}"))
    return saying("failing: some", failing=sum(failing), of=len(judged))


def _how(exact: Sequence[CaseResult], which: Saying) -> Saying:
    """What the errors look like; `which` tells which rigs fail."""
    offsets, relative = [], []
    for result in exact:
        case, found = result.case, result.found_left
        if found is None:
            continue
        both = case.answerable & np.isfinite(found).all(axis=1)
        truth = case.points_left[both]
        offsets.append(np.hstack(case.rig.project(found[both])) - np.hstack(case.rig.project(truth)))
        relative.append(found[both, 2] / truth[:, 2])
    if not offsets:
        return saying("unknown", which=which)
    px, depth = np.concatenate(offsets), np.concatenate(relative)
    px = px[np.isfinite(px).all(axis=1)]
    if not len(px):
        return saying("unknown: behind", which=which)
    scatter, lean = float(np.median(np.abs(px))), float(np.abs(np.median(px, axis=0)).max())
    spread = float(np.median(np.abs(depth - 1)))
    if lean < 0.2 * scatter and scatter < _LOST_DIGITS_PX:
        form = "lost-digits: single" if scatter < _SINGLE_PX else "lost-digits"
        return saying(form, which=which, scatter_px=scatter)
    if lean < 0.2 * scatter:
        return saying("random-errors", which=which, scatter_px=scatter, spread=spread)
    off_px, times = numbers(np.median(px, axis=0)), float(np.median(depth))
    return saying("unknown: off", which=which, scatter_px=scatter, off_px=off_px, times=times)


def numbers(values: Array) -> tuple[float, ...]:
    """Numbers; what is nothing beside the largest is 0."""
    least = 1e-6 * float(np.abs(values).max(initial=0.0))
    return tuple(float(value) if abs(value) > least else 0.0 for value in values)
