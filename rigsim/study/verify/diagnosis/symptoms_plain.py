"""What shows without making a mistake again: errors that say it themselves, noise, and the last resort."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.study.verify.result import CaseResult, Diagnosis

_LOST_DIGITS_PX = 5e-3
_SINGLE_PX = 2e-4  # of a picture 2000 px wide


class Mark(NamedTuple):
    """What one case shows."""

    mistake: str
    """Short name."""
    says: str
    """A sentence, true of this case."""
    weight: float = 1.0
    """How much it tells beside a mistake that was made again."""


def broken(results: Sequence[CaseResult]) -> list[Diagnosis]:
    """What errors say, the most frequent first."""
    wrong = sum(result.status() in ("failed", "error") for result in results)
    grouped: dict[str, tuple[str, list[str]]] = {}
    for result in results:
        if result.status() == "error":
            mark = _broken(result)
            grouped.setdefault(mark.mistake, (mark.says, []))[1].append(result.case.name)
    told = [
        Diagnosis(name, says, len(cases) / wrong, tuple(cases)) for name, (says, cases) in grouped.items()
    ]
    return sorted(told, key=lambda diagnosis: -diagnosis.explained)


def _broken(result: CaseResult) -> Mark:
    match result.reason:
        case "timed-out":
            return Mark("times-out", "It does not come back in time.")
        case "wrong-shape":
            return _of_shape(result.shape, len(result.case), int(result.case.answerable.sum()))
        case "wrong-type":
            return Mark("wrong-type", f"{result.error}.")
        case "raised":
            return Mark("raises", f"{result.error}.")
        case _:
            return Mark("broken", f"{result.error}.")


def _of_shape(shape: tuple[int, ...], n: int, asked: int) -> Mark:
    """What an answer's shape says, for `n` rows of which `asked` have an answer."""
    match shape:
        case (3, m) if m == n:
            return Mark("transposed-answer", "The answer is (3, N), a column a point: return its transpose.")
        case (4, m) if m == n:
            return Mark(
                "homogeneous-answer",
                "The answer is (4, N), homogeneous as triangulatePoints gives it: divide by the last row and "
                "transpose.",
            )
        case (m, 4) if m == n:
            return Mark("homogeneous-answer", "The answer has four columns: divide by the last and drop it.")
        case (m, 2) if m == n:
            return Mark("depth-missing", "The answer has two columns: the depth is missing.")
        case (m,) if m == n:
            return Mark("depth-alone", "The answer has one number a point: x and y are missing.")
        case (m, 3) if m == asked and asked < n:
            return Mark("rows-dropped", "Rows without an answer are left out: they must be NaN.")
        case (m, 3):
            return Mark("rows-dropped", f"{m} rows came back for {n}: each needs its own, NaN if need be.")
        case (_, *rest) if len(rest) > 1 and 3 in rest:
            return Mark("extra-dimension", f"The answer has shape {shape}: it has an axis too many.")
    return Mark("wrong-shape", f"The answer has shape {shape}: must be ({n}, 3).")


def statistics(result: CaseResult) -> Iterator[Mark]:
    """Of a case with noise, where all without noise pass."""
    checks = {check.name: check for check in result.failed_checks}
    size = checks.get("size") or checks.get("depth")
    if size is not None and size.value > size.high:
        yield Mark(
            "inefficient",
            f"Exact pixels are answered exactly, but with noise errors are {size.value:.3g} times "
            "what they must be: "
            "part of what the pixels say is wasted, as one image's rows or one of two rays, or "
            "noise is added.",
        )
    if size is not None and size.value < size.low:
        yield Mark(
            "too-good",
            f"With noise, errors are {size.value:.3g} times what they must be at least: rows are "
            "smoothed or averaged, or "
            "the truth leaks in.",
        )
    if "unbiased" in checks:
        yield Mark(
            "biased",
            f"With noise, answers lean by {checks['unbiased'].value:.3g} standard deviations to one side.",
        )
    if "answered" in checks:
        yield Mark(
            "rows-missing",
            f"{checks['answered'].value:.0f} rows with an answer come back as NaN once there is noise.",
        )


def wasteful(results: Sequence[CaseResult]) -> tuple[Diagnosis, ...]:
    """Where nothing fails: whether errors are too large in most cases with noise, though not by far."""
    noisy = [result for result in results if result.case.kind == "noisy" and not result.not_applicable]
    large = [result for result in noisy if result.status() == "inefficient"]
    if len(large) <= len(noisy) / 2:
        return ()
    times = float(np.median([result.efficiency for result in large]))
    says = (
        f"Right, but with noise errors are {times:.3g} times what they need be: part of what the "
        "pixels say is "
        "wasted, as one image's rows or one of two rays."
    )
    share = len(large) / len(noisy)
    return (Diagnosis("inefficient", says, share, tuple(result.case.name for result in large)),)


def last_resort(results: Sequence[CaseResult]) -> list[Diagnosis]:
    """What can be said when no mistake fits: which rigs fail, and how the errors look."""
    failing = [result for result in results if result.status() == "failed"]
    exact = [r for r in failing if r.case.covariance_px2 is None and r.case.answerable.any()]
    name, how = _how(exact)
    says = " ".join(part for part in (_which(results), how) if part)
    return [Diagnosis(name, says, 0.0, tuple(result.case.name for result in failing))]


_FEATURES: tuple[tuple[str, Callable[[CaseResult], bool]], ...] = (
    ("unequal principal points (doffs)", lambda r: abs(r.case.rig.doffs_px) > 1e-9),
    ("lens distortion", lambda r: bool(r.case.rig.left.distortion or r.case.rig.right.distortion)),
    ("a turned right camera", lambda r: bool(np.abs(r.case.rig.right_from_left.R - np.eye(3)).max() > 1e-9)),
    ("pixels that are not square", lambda r: r.case.rig.left.fx != r.case.rig.left.fy),
    ("two different lenses", lambda r: r.case.rig.left != r.case.rig.right),
    ("a baseline that is not along x", lambda r: bool(np.abs(r.case.rig.right_from_left.t[1:]).max() > 1e-9)),
    ("no rectification", lambda r: not r.case.rig.is_rectified),
    ("points beyond 50 m", lambda r: bool((r.case.points_left[:, 2] > 50).any())),
)


def _which(results: Sequence[CaseResult]) -> str:
    """The property of rigs that tells failing cases from passing ones best."""
    judged = [
        r
        for r in results
        if r.status() in ("failed", "passed", "inefficient") and r.case.kind in ("exact", "measured")
    ]
    failing = [result.status() == "failed" for result in judged]
    if not any(failing) or all(failing):
        return "All exact cases fail." if any(failing) else ""
    for name, has in _FEATURES:
        if [has(result) for result in judged] == failing:
            return f"All rigs with {name} fail, and no others."
    for name, has in _FEATURES:
        if all(has(result) for result, fails in zip(judged, failing, strict=True) if fails):
            return f"Only rigs with {name} fail."
    return f"{sum(failing)} of {len(judged)} cases fail."


def _how(exact: Sequence[CaseResult]) -> tuple[str, str]:
    """A name, and what the errors look like."""
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
        return "unknown", "No known mistake explains it."
    px, depth = np.concatenate(offsets), np.concatenate(relative)
    px = px[np.isfinite(px).all(axis=1)]
    if not len(px):
        return "unknown", "No point that comes back is in front of both cameras."
    scatter, lean = float(np.median(np.abs(px))), float(np.abs(np.median(px, axis=0)).max())
    spread = float(np.median(np.abs(depth - 1)))
    if lean < 0.2 * scatter and scatter < _LOST_DIGITS_PX:
        return (
            "lost-digits",
            f"Errors look like noise, about {scatter:.1g} px: numbers that were rounded or written with few "
            "digits, a step for numerical derivatives, or an iteration that stops early"
            + (", or single precision (float32)." if scatter < _SINGLE_PX else "."),
        )
    if lean < 0.2 * scatter:
        return (
            "random-errors",
            f"Errors look like noise: about {scatter:.2g} px either way, without a direction, and depths "
            f"{spread:.2g} of themselves; look for random numbers, wrong matches or an iteration "
            "that stops early.",
        )
    return (
        "unknown",
        f"Points project about {scatter:.2g} px from their pixels (typically "
        f"{numbers(np.median(px, axis=0))} px in u, v of the left and of the right image), and depths are "
        f"{float(np.median(depth)):.4g} times the true ones.",
    )


def numbers(values: Array) -> str:
    """Numbers to three digits; what is nothing beside the largest is 0."""
    least = 1e-6 * float(np.abs(values).max(initial=0.0))
    return ", ".join(f"{value if abs(value) > least else 0.0:.3g}" for value in values)
