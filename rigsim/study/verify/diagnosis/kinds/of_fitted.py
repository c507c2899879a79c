"""Mistakes with a number in them, which is found from what came back."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.study.verify.diagnosis.evidence import Evidence
from rigsim.study.verify.diagnosis.mistake import Mistake
from rigsim.study.verify.diagnosis.reenact import Given, Lenses, given, solve_midpoint
from rigsim.study.verify.result import CaseResult

_UNITS = {
    1000.0: ("millimetres", "millimetres come back for metres (or t is in millimetres)"),
    0.001: ("metres-per-thousand", "metres are divided by 1000 once too often"),
    100.0: ("centimetres", "centimetres come back for metres"),
    0.01: ("metres-per-hundred", "metres are divided by 100 once too often"),
    39.37007874: ("inches", "inches come back for metres"),
    3.280839895: ("feet", "feet come back for metres"),
    0.0254: ("inches", "metres are taken for inches"),
    2.0: ("factor-two", "twice the baseline, or half the disparity"),
    0.5: ("factor-two", "half the baseline, or twice the disparity"),
}
_FEW = 3
_KEPT_SAME = 1e-3  # solvers differ by more than rounding where lines of sight no longer meet


def fitted(evidence: Evidence, results: Sequence[CaseResult]) -> Iterator[Mistake]:
    """Every mistake whose number can be read off; `results` are all of the triangulator's, in order."""
    rows = evidence.asked & evidence.failing[evidence.case] & np.isfinite(evidence.found).all(axis=1)
    if rows.sum() >= _FEW:
        found, right = evidence.found[rows], evidence.right[rows]
        yield from _scales(evidence, rows, found, right)
        yield _undivided(evidence)
        yield _shift(found, right)
        yield _pixel_offset(evidence, rows)
        yield from _by_case(evidence, rows)
    yield from _stale(evidence, results)


def _scales(evidence: Evidence, rows: Mask, found: Array, right: Array) -> Iterator[Mistake]:
    k = float(np.median(np.sum(found * right, axis=1) / np.sum(right**2, axis=1)))
    known = [unit for unit in _UNITS if abs(k / unit - 1) < 1e-4] if k else []
    name, what = _UNITS[known[0]] if known else ("scale", "a constant factor on t, on f or on the answer")
    yield Mistake(
        name,
        f"All three coordinates are {k:.6g} times too large: {what}."
        if abs(k) > 1
        else f"All three coordinates are {k:.6g} of what they must be: {what}.",
        after=lambda X, g: k * X,
        cost=0.002 if known else 0.008,
    )
    kz = float(np.median(found[:, 2] / right[:, 2]))
    yield Mistake(
        "depth-scale",
        f"z alone is {kz:.6g} times what it must be; x and y are right.",
        after=lambda X, g: X * (1.0, 1.0, kz),
        cost=0.01,
    )
    kxy = float(np.median(np.sum((found * right)[:, :2], axis=1) / np.sum(right[:, :2] ** 2, axis=1)))
    yield Mistake(
        "xy-scale",
        f"x and y are {kxy:.6g} times what they must be; z is right.",
        after=lambda X, g: X * (kxy, kxy, 1.0),
        cost=0.01,
    )
    if kz > 0 and np.isfinite(kz):

        def longer(lens: Lenses) -> Lenses:
            return replace(lens, f=lens.f * kz)

        yield Mistake(
            "focal-scale",
            f"Both focal lengths are {kz:.6g} times what they must be: another resolution, or px and mm.",
            lambda g: replace(g, left=longer(g.left), right=longer(g.right)),
            cost=0.008,
        )
        yield Mistake(
            "baseline-scale",
            f"The baseline is {kz:.6g} times what it must be.",
            lambda g: replace(g, t=kz * g.t),
            cost=0.009,
        )


def _undivided(evidence: Evidence) -> Mistake:
    # a null vector may come with either sign
    signs = np.where(np.sum(evidence.found * evidence.right, axis=1) < 0, -1.0, 1.0)

    def undivided(X: Array, g: Given) -> Array:
        return np.asarray(X * (signs / np.sqrt(1 + np.sum(X**2, axis=1)))[:, None])

    return Mistake(
        "homogeneous-answer",
        "Homogeneous coordinates are not divided by the fourth.",
        after=undivided,
        cost=0.002,
    )


def _shift(found: Array, right: Array) -> Mistake:
    shift = np.median(found - right, axis=0)
    x, y, z = shift * 1e3
    return Mistake(
        "shifted-points",
        f"All points are shifted by the same ({x:.4g}, {y:.4g}, {z:.4g}) mm.",
        after=lambda X, g: X + shift,
        cost=0.02,
    )


def _pixel_offset(evidence: Evidence, rows: Mask) -> Mistake:
    """The pixels that the found points would be right for, against those that were given."""
    g = evidence.given
    seen = []
    for index, result in enumerate(evidence.results):
        mine = rows & (evidence.case == index)
        if mine.any():
            uv = np.hstack(result.case.rig.project(evidence.found[mine]))
            seen.append(uv - np.hstack([g.uv_left[mine], g.uv_right[mine]]))
    with np.errstate(all="ignore"):
        offsets = np.concatenate(seen)
        finite = np.isfinite(offsets).all(axis=1)
        by = np.median(offsets[finite], axis=0) if finite.any() else np.zeros(4)
    disparity = by[0] - by[2]
    says = (
        f"Answers fit pixels that are off by ({by[0]:+.3g}, {by[1]:+.3g}) px on the left and "
        f"({by[2]:+.3g}, {by[3]:+.3g}) px on the right, a disparity {disparity:+.3g} px too "
        "large, in every case."
    )
    return Mistake(
        "pixel-offset",
        says,
        lambda g: replace(g, uv_left=g.uv_left + by[:2], uv_right=g.uv_right + by[2:]),
        cost=0.03,
    )


def _by_case(evidence: Evidence, rows: Mask) -> Iterator[Mistake]:
    """What holds within a case and differs between them."""
    scaled, moved, bent = evidence.right.copy(), evidence.right.copy(), evidence.right.copy()
    factors, angles, slopes = [], [], []
    for index in range(len(evidence.results)):
        everything = evidence.case == index
        mine = rows & everything
        if mine.sum() < _FEW + 1:
            continue
        found, right = evidence.found[mine], evidence.right[mine]
        factor = float(np.median(np.sum(found * right, axis=1) / np.sum(right**2, axis=1)))
        scaled[everything] *= factor
        factors.append(factor)
        turn, shift, angle = _rigid(right, found)
        moved[everything] = evidence.right[everything] @ turn.T + shift
        angles.append((angle, float(np.linalg.norm(shift))))
        with np.errstate(all="ignore"):
            q, q_found = 1 / right[:, 2], 1 / found[:, 2]
            ray = np.abs(found[:, :2] * right[:, 2:] - right[:, :2] * found[:, 2:]).max(axis=1)
            on_ray = np.isfinite(q_found) & (ray <= 1e-6 * np.abs(found[:, 2] * right[:, 2]) + 1e-12)
            if on_ray.sum() > _FEW and np.ptp(q[on_ray]) > 0:
                slope, offset = np.polyfit(q[on_ray], q_found[on_ray], 1)
                slopes.append(slope)
                bent[everything] *= (
                    1 / (evidence.right[everything, 2] * (slope / evidence.right[everything, 2] + offset))
                )[:, None]
    if len(factors) > 1:
        yield Mistake(
            "scale-by-rig",
            f"Answers are {min(factors):.4g} to {max(factors):.4g} times too large, a factor for "
            "each rig: look for "
            "what scales with the rig (baseline, focal length, image size).",
            after=lambda X, g: scaled,
            cost=0.03,
        )
    if angles:
        degrees, metres = (float(np.median([angle[i] for angle in angles])) for i in range(2))
        yield Mistake(
            "other-frame",
            f"Points have the right shape in another frame, turned by {degrees:.3g} deg and "
            f"{metres * 1e3:.4g} mm away: "
            "R or t is used where it is not meant, or is missing.",
            after=lambda X, g: moved,
            cost=0.06,
        )
    if slopes:
        slope = float(np.median(slopes))
        yield Mistake(
            "shrunk-depth" if slope < 1 else "stretched-depth",
            f"Points lie on their left rays, but 1/z is {slope:.3g} times the true one and a constant: "
            "depths are drawn towards one, as by a prior, or the disparity has an offset.",
            after=lambda X, g: bent,
            cost=0.05,
        )


def _rigid(source: Array, target: Array) -> tuple[Array, Array, float]:
    """Rotation, translation and angle in deg that map `source` to `target` best (Kabsch)."""
    a, b = np.median(source, axis=0), np.median(target, axis=0)
    a, b = source.mean(axis=0), target.mean(axis=0)
    U, _, Vt = np.linalg.svd((target - b).T @ (source - a))
    turn = U @ np.diag([1.0, 1.0, np.sign(np.linalg.det(U @ Vt))]) @ Vt
    angle = float(np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1))))
    return turn, b - turn @ a, angle


def _stale(evidence: Evidence, results: Sequence[CaseResult]) -> Iterator[Mistake]:
    """The rig of a case that came earlier."""
    place = {id(result): i for i, result in enumerate(results)}
    before = [max(0, place[id(result)] - 1) for result in evidence.results]
    says = "The rig of {} is used: something computed from it is kept from call to call."
    counts = np.bincount(evidence.case, minlength=len(evidence.results)).tolist()
    for what, indices in (("the first call", [0] * len(before)), ("the call before", before)):
        other = given(
            [results[i].case.rig for i in indices], counts, evidence.given.uv_left, evidence.given.uv_right
        )

        def stale(g: Given, other: Given = other) -> Given:
            return other

        yield Mistake("stale-rig", says.format(what), stale, cost=0.004)


def kept(evidence: Evidence, results: Sequence[CaseResult]) -> Iterator[Mistake]:
    """The rig of whichever earlier call explains a failing case best: a cache with too short a key."""
    place = {id(result): i for i, result in enumerate(results)}
    answers = evidence.right.copy()
    told: list[str] = []
    for index in np.flatnonzero(evidence.failing):
        mine = evidence.case == index
        result = evidence.results[index]
        rigs = {id(earlier.case.rig): earlier for earlier in results[: place[id(result)]]}
        uv_left, uv_right = evidence.given.uv_left[mine], evidence.given.uv_right[mine]
        found = evidence.found[mine]
        best, whose = np.inf, ""
        for earlier in rigs.values():
            g = given([earlier.case.rig], [int(mine.sum())], uv_left, uv_right)
            points = solve_midpoint(g, g.left.normalize(uv_left), g.right.normalize(uv_right))
            apart = np.linalg.norm(points - found, axis=1) / np.linalg.norm(found, axis=1)
            if np.isfinite(apart).any() and float(np.nanmedian(apart)) < best:
                best, whose = float(np.nanmedian(apart)), earlier.case.name
                nearest = points
        if best < _KEPT_SAME:
            answers[mine] = nearest
            told.append(f"'{result.case.name}' with that of '{whose}'")
    if told:
        yield Mistake(
            "stale-rig",
            f"The rig of an earlier call is used ({told[0]}): something computed from it is kept under a key"
            " that other rigs share.",
            after=lambda X, g: answers,
            cost=0.03,
        )
