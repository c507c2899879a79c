"""Which rows are missing, zero or wrong, where others are right."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.study.saying import saying
from rigsim.study.verify.case import Case
from rigsim.study.verify.diagnosis.symptoms_plain import Mark
from rigsim.study.verify.result import CaseResult
from rigsim.theory.uncertainty import parallax_px

SAME = 1e-6
"""Relative difference under which numbers are one and the same."""
FEW = 3
"""Fewer rows than this show no pattern."""
WHERE = 0.6
"""To say where rows are wrong tells less than why."""


def where(result: CaseResult, found: Array, wrong: Mask, answered: Mask) -> Iterator[Mark]:
    """What the wrong rows have in common, when some are right."""
    case = result.case
    asked = case.answerable
    n = int(wrong.sum())
    none = ~answered
    zero = answered & (found == 0).all(axis=1)
    kind = "missing" if none[wrong].mean() > 0.9 else "zero" if zero[wrong].mean() > 0.9 else "wrong"
    weight = WHERE if kind == "wrong" else 0.95
    good = asked & ~wrong
    for high, values, low in _measures(case):
        w, g = values[wrong], values[good]
        if len(g) < FEW or n < FEW:
            continue
        if np.quantile(w, 0.02) >= np.quantile(g, 0.98):
            yield Mark(saying(f"{high}-{kind}", at=float(w.min()), case=case.name), weight)
            return
        if np.quantile(w, 0.98) <= np.quantile(g, 0.02):
            yield Mark(saying(f"{low}-{kind}", at=float(w.max()), case=case.name), weight)
            return
    yield Mark(saying(f"rows-{kind}", rows=n, of=int(asked.sum()), case=case.name), WHERE)


def _measures(case: Case) -> tuple[tuple[str, Array, str], ...]:
    """What rows may be wrong by: its high end, values (N,), its low end."""
    centre = (case.uv_left - (case.rig.left.cx, case.rig.left.cy)) / (case.rig.left.fx, case.rig.left.fy)
    return (
        ("far-points", case.points_left[:, 2], "near-points"),
        (
            "large-disparities",
            parallax_px(case.rig, case.points_left),
            "small-disparities",
        ),
        (
            "late-rows",
            np.arange(len(case), dtype=np.float64),
            "early-rows",
        ),
        (
            "outer-points",
            np.linalg.norm(centre, axis=1),
            "inner-points",
        ),
        ("right-half", case.points_left[:, 0], "left-half"),
        ("lower-half", case.points_left[:, 1], "upper-half"),
    )


def pooled(results: Sequence[CaseResult]) -> Iterator[Mark]:
    """What the missing or zero rows of all cases have in common."""
    depth, lost, zero = [], [], []
    for result in results:
        case, found = result.case, result.found_left
        if case.covariance_px2 is None and found is not None and case.answerable.any():
            asked = case.answerable
            depth.append(case.points_left[asked, 2])
            lost.append(~np.isfinite(found[asked]).all(axis=1))
            zero.append((found[asked] == 0).all(axis=1))
    if not depth:
        return
    z, nothing, zeros = np.concatenate(depth), np.concatenate(lost), np.concatenate(zero)
    for rows, kind in ((zeros, "zero"), (nothing, "missing")):
        if rows.sum() < FEW or rows.all():
            continue
        if z[rows].min() >= z[~rows].max():
            yield Mark(saying(f"far-points-{kind}: in all cases", at=float(z[~rows].max())))
        elif z[rows].max() <= z[~rows].min():
            yield Mark(saying(f"near-points-{kind}: in all cases", at=float(z[~rows].min())))


def else_right(result: CaseResult) -> bool:
    """Whether the rows that came back, other than as zeros, are right."""
    case, found = result.case, result.found_left
    if found is None or not case.answerable.any():
        return False
    kept = case.answerable & np.isfinite(found).all(axis=1) & (found != 0).any(axis=1)
    error = np.linalg.norm(found - case.points_left, axis=1)[kept]
    return bool((error <= SAME * np.linalg.norm(case.points_left, axis=1)[kept]).all())
