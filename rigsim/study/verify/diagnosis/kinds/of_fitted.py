"""Mistakes with a number in them, which is found from what came back."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.study.saying import saying
from rigsim.study.verify.diagnosis.evidence import Evidence
from rigsim.study.verify.diagnosis.mistake import Mistake
from rigsim.study.verify.diagnosis.reenact import Given, Lenses, given, solve_midpoint
from rigsim.study.verify.result import CaseResult

_UNITS = {
    1000.0: "millimetres",
    0.001: "metres-per-thousand",
    100.0: "centimetres",
    0.01: "metres-per-hundred",
    39.37007874: "inches",
    3.280839895: "feet",
    0.0254: "inches: taken for",
    2.0: "factor-two",
    0.5: "factor-two: half",
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
    size = saying("times-too-large" if abs(k) > 1 else "of-what-they-must-be", times=k)
    yield Mistake(
        saying(_UNITS[known[0]] if known else "scale", size=size),
        after=lambda X, g: k * X,
        cost=0.002 if known else 0.008,
    )
    kz = float(np.median(found[:, 2] / right[:, 2]))
    yield Mistake(
        saying("depth-scale", times=kz),
        after=lambda X, g: X * (1.0, 1.0, kz),
        cost=0.01,
    )
    kxy = float(np.median(np.sum((found * right)[:, :2], axis=1) / np.sum(right[:, :2] ** 2, axis=1)))
    yield Mistake(
        saying("xy-scale", times=kxy),
        after=lambda X, g: X * (kxy, kxy, 1.0),
        cost=0.01,
    )
    if kz > 0 and np.isfinite(kz):

        def longer(lens: Lenses) -> Lenses:
            return replace(lens, f=lens.f * kz)

        yield Mistake(
            saying("focal-scale", times=kz),
            lambda g: replace(g, left=longer(g.left), right=longer(g.right)),
            cost=0.008,
        )
        yield Mistake(
            saying("baseline-scale", times=kz),
            lambda g: replace(g, t=kz * g.t),
            cost=0.009,
        )


def _undivided(evidence: Evidence) -> Mistake:
    # a null vector may come with either sign
    signs = np.where(np.sum(evidence.found * evidence.right, axis=1) < 0, -1.0, 1.0)

    def undivided(X: Array, g: Given) -> Array:
        return np.asarray(X * (signs / np.sqrt(1 + np.sum(X**2, axis=1)))[:, None])

    return Mistake(
        saying("homogeneous-answer: undivided"),
        after=undivided,
        cost=0.002,
    )


def _shift(found: Array, right: Array) -> Mistake:
    shift = np.median(found - right, axis=0)
    x, y, z = (float(value) for value in shift * 1e3)
    return Mistake(
        saying("shifted-points", shift_mm=(x, y, z)),
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
    off_px = tuple(float(value) for value in by)
    return Mistake(
        saying("pixel-offset", off_px=off_px, disparity_px=off_px[0] - off_px[2]),
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
            saying("scale-by-rig", least=min(factors), most=max(factors)),
            after=lambda X, g: scaled,
            cost=0.03,
        )
    if angles:
        degrees, metres = (float(np.median([angle[i] for angle in angles])) for i in range(2))
        yield Mistake(
            saying("other-frame", turn_deg=degrees, away_mm=metres * 1e3),
            after=lambda X, g: moved,
            cost=0.06,
        )
    if slopes:
        slope = float(np.median(slopes))
        yield Mistake(
            saying("shrunk-depth" if slope < 1 else "stretched-depth", slope=slope),
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
    counts = np.bincount(evidence.case, minlength=len(evidence.results)).tolist()
    for form, indices in (("stale-rig: first", [0] * len(before)), ("stale-rig", before)):
        other = given(
            [results[i].case.rig for i in indices], counts, evidence.given.uv_left, evidence.given.uv_right
        )

        def stale(g: Given, other: Given = other) -> Given:
            return other

        yield Mistake(saying(form), stale, cost=0.004)


def kept(evidence: Evidence, results: Sequence[CaseResult]) -> Iterator[Mistake]:
    """The rig of whichever earlier call explains a failing case best: a cache with too short a key."""
    place = {id(result): i for i, result in enumerate(results)}
    answers = evidence.right.copy()
    told: list[tuple[str, str]] = []
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
            told.append((result.case.name, whose))
    if told:
        yield Mistake(
            saying("stale-rig: kept", case=told[0][0], of=told[0][1]),
            after=lambda X, g: answers,
            cost=0.03,
        )
