"""Why the row that is taken is taken, in words."""

from __future__ import annotations

from rigsim.digits import short
from rigsim.present.sweep.phrases import describe, mm, percent
from rigsim.study.design.words import rounded
from rigsim.study.scene import columns as col
from rigsim.study.scene.columns import COLUMNS
from rigsim.study.sweep.comparison import WELL_COVERED, reservations
from rigsim.study.sweep.requirement import met_first, verdicts, would_meet
from rigsim.study.sweep.result import SweepResult

_BETWEEN = 6
"""Baselines of the finer sweep that is named."""
_LEAST_SHORTER = 0.99
"""Of its baseline: less than a hundredth is no shorter rig."""


def why_taken(result: SweepResult, chosen: int) -> list[str]:
    """Why it is taken before the others that meet it, which of those errs least, and what would just do."""
    if col.BASELINE not in result.swept or not COLUMNS[col.BASELINE].numeric:
        return []
    ok = met_first(result.rows, result.best, result.requirements)
    return [*_rule(result, chosen, ok), *_least_error(result, chosen, ok), *_between(result, chosen)]


def _rule(result: SweepResult, chosen: int, ok: tuple[int, ...]) -> list[str]:
    """By what it is taken; a shorter one that meets it too is flagged or covers too little."""
    own = _baseline(result, chosen)
    shorter = [i for i in ok if _baseline(result, i) < own]
    if not shorter:
        return [
            f"{_length(own)} is the shortest baseline of those swept that meets it, without room for "
            "building errors (`rigsim design` leaves some)."
        ]
    least = min(shorter, key=lambda i: _baseline(result, i))
    against = reservations(result.rows)[least]
    why = "is flagged" if against >= 2 else f"covers less than {percent(WELL_COVERED)} of the best coverage"
    return [
        f"The shortest baseline of those swept that meets it is {_length(_baseline(result, least))}, but it "
        f"{why}; {_length(own)} is the shortest against which nothing speaks."
    ]


def _least_error(result: SweepResult, chosen: int, ok: tuple[int, ...]) -> list[str]:
    """The one of those that meet it that errs least, where that is another one."""
    one = result.requirements[0]
    best = min(ok, key=lambda i: one.rows[i].error_mm)
    if best == chosen or not one.rows[best].error_mm < one.rows[chosen].error_mm:
        return []
    shared = [percent(result.rows.loc[i, col.VISIBLE_FRACTION]) for i in (best, chosen)]
    sight = f"; both cameras see {shared[0]} of the image then, against {shared[1]}"
    return [
        f"Of those that meet it, {describe(result.rows.loc[best], _choices(result))} errs least, "
        f"{mm(one.rows[best].error_mm)} at {one.asked.at_mm / 1e3:.4g} m"
        + (sight if shared[0] != shared[1] else "")
        + "."
    ]


def _between(result: SweepResult, chosen: int) -> list[str]:
    """A shorter baseline that would just do by the closed form, between two that were swept."""
    show = result.showcase
    if show.row != chosen or result.has_two_rigs:
        return []
    found = would_meet(show.rig, show.noise, result.requirements)
    if found is None or found.baseline_m is None:
        return []
    own, just = _baseline(result, chosen), rounded(1e3 * found.baseline_m, up=True)
    others = [axis for axis in result.swept if axis != col.BASELINE]
    like = (result.rows[others] == result.rows.loc[chosen, others]).all(axis=1)
    verdict = verdicts(result.requirements)
    shorter = [
        _baseline(result, int(i))
        for i in result.rows.index[like]
        if verdict[int(i)] == "not_met" and _baseline(result, int(i)) < own
    ]
    if not max(shorter, default=0.0) < just < _LEAST_SHORTER * own:
        return []
    return [
        f"By the closed form a baseline of {mm(just)} would just do, all else the same; it was not "
        f"simulated: `--baseline {just:.6g}:{own:.6g}/{_BETWEEN}` tries some in between."
    ]


def _choices(result: SweepResult) -> tuple[str, ...]:
    return tuple(axis for axis in result.swept if axis not in (col.NOISE, col.SENSOR))


def _baseline(result: SweepResult, place: int) -> float:
    return float(result.rows.loc[place, col.BASELINE])


def _length(baseline_mm: float) -> str:
    return f"{short(baseline_mm, 4)} mm"
