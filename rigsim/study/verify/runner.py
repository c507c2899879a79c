"""Every triangulator on every case; one that breaks does not stop the others."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from rigsim.errors import TriangulatorError
from rigsim.study.saying import saying
from rigsim.study.verify.case import Case
from rigsim.study.verify.checks import judge, statistical_checks
from rigsim.study.verify.diagnosis.diagnosis import diagnose
from rigsim.study.verify.result import CaseResult, Check, TriangulatorResult
from rigsim.theory.custom import CheckedTriangulator, TriangulatorFunction

PATIENCE = 3
"""A triangulator that does not come back from so many cases in a row is not asked again."""
FALSE_ALARM = 1e-4
"""Probability that a correct triangulator fails any of the random checks of a whole run."""


def verify(
    cases: Sequence[Case],
    triangulators: Mapping[str, TriangulatorFunction],
    on_result: Callable[[CaseResult], None] = lambda _: None,
    false_alarm: float = FALSE_ALARM,
) -> tuple[TriangulatorResult, ...]:
    """Run every case with every triangulator.

    Args:
        cases: the cases.
        triangulators: callables by the name they have in tables.
        on_result: is told of every case as it ends.
        false_alarm: probability that a correct triangulator fails; shared out over the checks.
    """
    # Bonferroni: one run, however many cases, raises a false alarm with at most this probability
    one = false_alarm / max(1, sum(statistical_checks(case) for case in cases) * len(triangulators))
    finished = []
    for label, function in triangulators.items():
        results: list[CaseResult] = []
        for case in cases:
            last = results[-PATIENCE:]
            if len(last) == PATIENCE and all(result.timed_out for result in last):
                why = f"not asked: the {PATIENCE} cases before took too long"
                results.append(CaseResult(case, label, error=why, reason="timed-out"))
            else:
                results.append(run_case(case, label, function, one))
            on_result(results[-1])
        finished.append(TriangulatorResult(label, tuple(results), diagnose(results)))
    return tuple(finished)


def run_case(case: Case, label: str, function: TriangulatorFunction, false_alarm: float) -> CaseResult:
    """One triangulator on one case; whatever it does wrong is in the result."""
    why_not = not_applicable(label, case)
    if why_not:
        return CaseResult(case, label, not_applicable=why_not)
    checked = function if _is_checked(function) else CheckedTriangulator(function, label)
    start = time.perf_counter()
    try:
        found_left = checked(case.rig, case.uv_left, case.uv_right)
    except TriangulatorError as error:
        return CaseResult(
            case,
            label,
            error=str(error),
            reason=error.reason,
            shape=error.shape,
            seconds=time.perf_counter() - start,
            notes=_notes(function),
        )
    seconds = time.perf_counter() - start
    own = getattr(function, "seconds", math.nan)  # of one that runs elsewhere, without the way there
    with np.errstate(all="ignore"):
        judgement = judge(case, found_left, false_alarm)
    return CaseResult(
        case,
        label,
        checks=judgement.checks or (_shape(len(case)),),
        found_left=found_left,
        seconds=own if math.isfinite(own) else seconds,
        depth_rms_m=judgement.depth_rms_m,
        predicted_depth_rms_m=judgement.predicted_depth_rms_m,
        efficiency=judgement.efficiency,
        notes=_notes(function),
    )


def _is_checked(function: TriangulatorFunction) -> bool:
    return isinstance(function, CheckedTriangulator)


def _notes(function: TriangulatorFunction) -> tuple[str, ...]:
    return tuple(getattr(function, "notes", ()))


def _shape(n: int) -> Check:
    """What an empty case holds a triangulator to, once it has come back in shape."""
    return Check("shape", 0.0, 0.0, 0.0, "", saying("shape", rows=n))


def not_applicable(label: str, case: Case) -> str:
    """Why a known triangulator is not meant for a case; empty when it is."""
    if label == "rectified" and not case.rig.is_rectified:
        return "the rig is not rectified"
    return ""
