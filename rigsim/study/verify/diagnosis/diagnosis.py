"""Which mistake a triangulator's answers look like: each known one is made again and compared."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.study.verify.diagnosis.conditions import set_apart
from rigsim.study.verify.diagnosis.evidence import Evidence, gather
from rigsim.study.verify.diagnosis.kinds.of_fitted import fitted, kept
from rigsim.study.verify.diagnosis.mistake import Mistake
from rigsim.study.verify.diagnosis.mistakes import LIBRARY
from rigsim.study.verify.diagnosis.reenact import QUICK, SOLVERS, Solver, behind, reenacts
from rigsim.study.verify.diagnosis.symptoms import symptoms
from rigsim.study.verify.diagnosis.symptoms_plain import broken, last_resort, wasteful
from rigsim.study.verify.result import CaseResult, Diagnosis

_SCREENED_ROWS, _JUDGED_ROWS = 20, 40
_SHORTLIST = 14
_CONVINCING = 0.9
_WORTH_SAYING = 0.5
_LIKELY = 0.7
_MOST = 3
_SOMETIMES = 0.06  # what a mistake that some rigs bring out must explain more than one that all do
_ANSWERED = 0.5


def diagnose(results: Sequence[CaseResult]) -> tuple[Diagnosis, ...]:
    """What one triangulator's failures look like, best first; empty when nothing failed.

    Args:
        results: all the cases of one triangulator, in the order in which they ran: those that pass refute
            mistakes that would have broken them.
    """
    wrong = [result for result in results if result.status() in ("failed", "error")]
    if not wrong:
        return wasteful(results)
    with np.errstate(all="ignore"):
        told = broken(results)
        ranked = [(d.explained, d) for d in told]
        failing = [result for result in wrong if result.status() == "failed"]
        exact = [r for r in failing if r.case.covariance_px2 is None and reenacts(r.case.rig)]
        if exact:
            ranked += _reenacted(results)
        if failing:
            ranked += symptoms(results)
        ranked.sort(key=lambda item: -item[0])
        best = max((diagnosis.explained for _, diagnosis in ranked), default=0.0)
        if best < _LIKELY and failing:
            ranked = [(best, diagnosis) for diagnosis in last_resort(results)] + ranked
    return _worth_saying([d for _, d in ranked])


def _reenacted(results: Sequence[CaseResult]) -> list[tuple[float, Diagnosis]]:
    few = gather(results, _SCREENED_ROWS)
    screened = sorted(
        ((_Trial(few, mistake, QUICK).score, -i) for i, mistake in enumerate(LIBRARY)), reverse=True
    )
    shortlist = [LIBRARY[-i] for _, i in screened[:_SHORTLIST]]
    many = gather(results, _JUDGED_ROWS)
    trials = [_Trial(many, mistake, SOLVERS) for mistake in (*shortlist, *fitted(many, results))]
    if max(trial.score for trial in trials) < _CONVINCING:
        trials += [_Trial(many, mistake, SOLVERS) for mistake in kept(many, results)]
    return [(trial.score, trial.diagnosis) for trial in trials]


class _Trial:
    """One mistake, made again in every case."""

    def __init__(self, evidence: Evidence, mistake: Mistake, solvers: Mapping[str, Solver]) -> None:
        self.evidence, self.mistake = evidence, mistake
        failing = evidence.failing
        self.share, self.breaks = _best(evidence, _answers(evidence, mistake, solvers))
        refuted = int((self.breaks & ~failing).sum())
        weights = evidence.weights
        told = float((self.share * weights)[failing].sum())
        self.explained = told / float(weights[failing].sum() + refuted)
        self.score = self.explained - mistake.cost
        # made in some cases alone: it must explain those all but wholly, and by answers, not by their lack
        alone = told / max(float(weights[failing].sum()), 1e-300)
        answered = float(weights[failing].mean()) > _ANSWERED if failing.any() else False
        self.only_sometimes = bool(
            refuted and answered and alone >= _CONVINCING and alone - _SOMETIMES > self.explained
        )
        if self.only_sometimes:
            self.explained = alone
            self.score = alone - mistake.cost - _SOMETIMES

    @property
    def diagnosis(self) -> Diagnosis:
        names = tuple(
            result.case.name
            for result, share, failing in zip(
                self.evidence.results, self.share, self.evidence.failing, strict=True
            )
            if failing and share >= _CONVINCING
        )
        only = None
        if self.only_sometimes:
            cases = [result.case for result in self.evidence.results]
            failing = self.evidence.failing
            broken = [case for case, fails in zip(cases, failing, strict=True) if fails]
            spared = [case for case, i in zip(cases, self.breaks & ~failing, strict=True) if i]
            only = set_apart(broken, spared)
        return Diagnosis(self.mistake.said, self.explained, names, only)


def _answers(
    evidence: Evidence, mistake: Mistake, solvers: Mapping[str, Solver]
) -> Iterable[tuple[Array, Mask]]:
    """Points (N, 3) that the mistake leads to, and which rows may as well be nothing, for each solver."""
    truly = evidence.given
    if mistake.before is None and mistake.solver is None:
        right = evidence.right
        yield (mistake.after(right, truly) if mistake.after else right), behind(truly, right)
        return
    g = truly if mistake.before is None else mistake.before(truly)
    left, right = evidence.normalized(g)
    for solve in solvers.values() if mistake.solver is None else (mistake.solver,):
        points = solve(g, left, right)
        yield (mistake.after(points, truly) if mistake.after else points), behind(g, points)


def _best(evidence: Evidence, answers: Iterable[tuple[Array, Mask]]) -> tuple[Array, Mask]:
    """By case: the largest share of any solver, and whether all of them break the case."""
    share, breaks = np.zeros(len(evidence.results)), np.ones(len(evidence.results), dtype=bool)
    for points, nothing in answers:
        explained, count = evidence.explained(points, nothing)
        share, breaks = np.maximum(share, explained), breaks & (count > 0)
    return share, breaks


def _worth_saying(ranked: Sequence[Diagnosis]) -> tuple[Diagnosis, ...]:
    """The best of each name, as long as they come near the very best."""
    said: list[Diagnosis] = []
    for diagnosis in ranked:
        if any(diagnosis.mistake == other.mistake for other in said):
            continue
        if said and diagnosis.explained < max(_WORTH_SAYING, 0.8 * said[0].explained):
            continue
        said.append(diagnosis)
    return tuple(said[:_MOST])
