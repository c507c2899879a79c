"""A verification as a page: verdict, tables, where the failing cases fail, why each check holds, command."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from rigsim.present.kit import style
from rigsim.present.kit.page import fill, flat
from rigsim.present.verify import words
from rigsim.present.verify.console import (
    FAILURE_HEADS,
    GROUP_HEADS,
    efficiency,
    failure_rows,
    first_of_groups,
    group_rows,
    rerun,
)
from rigsim.present.verify.figures import case_figure
from rigsim.rig.arrays import Array
from rigsim.study.verify.result import CaseResult, Check, TriangulatorResult, VerifyResult
from rigsim.study.verify.runner import FALSE_ALARM
from rigsim.study.verify.worst import WorstRow, pixel_errors, worst_rows

_MOST_FIGURES = 6

WORST_HEADS = ("row", "left pixel", "right pixel", "expected point, m", "found point, m", "distance")
"""Columns of `worst_table`."""


@dataclass(frozen=True, slots=True)
class FailingCase:
    """One failing case in detail."""

    name: str
    about: str
    checks: tuple[Check, ...]
    says: tuple[str, ...]
    figure: Markup
    worst: list[tuple[str, ...]]


@dataclass(frozen=True, slots=True)
class Section:
    """What the page says of one triangulator."""

    name: str
    verdict: str
    passed: bool
    groups: list[tuple[str, ...]]
    failures: list[tuple[str, ...]]
    errors: list[tuple[str, str]]
    notes: list[str]
    diagnoses: list[str]
    cases: list[FailingCase]
    again: str


def verify_html(
    result: VerifyResult, strict: bool = False, again: Mapping[str, Sequence[str]] | None = None
) -> str:
    """The verification as one page, without scripts, links or network.

    Args:
        result: the verification.
        strict: whether efficiency counts.
        again: the words that run one triangulator again, without its cases.
    """
    provenance = dict(flat(result.provenance))
    command = provenance.pop("command", "")
    sections = [
        _section(one, strict, (again or {}).get(one.triangulator, ()), f"t{place}")
        for place, one in enumerate(result.triangulators)
    ]
    return fill(
        "verify.html",
        passed=result.passed(strict),
        headline=headline(result, strict),
        sections=sections,
        summary=[_summary(one, strict) for one in result.triangulators],
        group_heads=[head.replace("\n", " ") for head in GROUP_HEADS],
        failure_heads=FAILURE_HEADS,
        worst_heads=WORST_HEADS,
        suite=result.suite,
        seed=result.seed,
        strict=strict,
        false_alarm=f"{FALSE_ALARM:g}",
        left_out=result.left_out,
        command=command,
        provenance=provenance,
    )


def worst_table(result: CaseResult) -> list[tuple[str, ...]]:
    """The worst rows of a case as texts."""
    return [_worst(row) for row in worst_rows(result)]


def headline(result: VerifyResult, strict: bool = False) -> str:
    """The answer in one sentence."""
    if len(result.triangulators) == 1:
        return words.verdict(result.triangulators[0], strict)
    good = sum(one.passed(strict) for one in result.triangulators)
    return f"{good} of {len(result.triangulators)} triangulators passed"


def _summary(one: TriangulatorResult, strict: bool) -> tuple[str, ...]:
    status = [case.status(strict) for case in one.results]
    return (
        one.triangulator,
        str(len(status) - status.count("not applicable")),
        str(status.count("failed") + status.count("error")),
        str(status.count("inefficient")),
        efficiency(case.efficiency for case in one.results),
        f"{sum(case.seconds for case in one.results):.3f}",
        "passed" if one.passed(strict) else "failed",
    )


def _section(one: TriangulatorResult, strict: bool, again: Sequence[str], prefix: str) -> Section:
    bad = [case for case in one.results if case.status(strict) in ("failed", "error")]
    failed = [case for case in bad if not case.error]
    # cases with points to look at first: where none came back there is nothing to see
    detailed = sorted(first_of_groups(failed), key=lambda case: not _has_points(case))[:_MOST_FIGURES]
    return Section(
        one.triangulator,
        words.verdict(one, strict),
        one.passed(strict),
        group_rows(one, strict),
        failure_rows(failed, strict),
        [(case.case.name, case.error) for case in bad if case.error],
        [f"{case.case.name}: {note}" for case in one.results for note in case.notes],
        words.diagnoses(one.diagnoses),
        [_failing(case, strict, f"{prefix}c{place}") for place, case in enumerate(detailed)],
        rerun(one, strict, again) if bad and again else "",
    )


def _failing(result: CaseResult, strict: bool, name: str) -> FailingCase:
    case, checks = result.case, result.failures(strict)
    figure = Markup("")
    if _has_points(result):
        figure = Markup(style.to_svg(case_figure(result), name, f"Errors in {case.name}"))
    says = tuple(f"{words.sentence(check)}. {words.why(check)}" for check in checks)
    return FailingCase(case.name, words.about(case), checks, says, figure, worst_table(result))


def _has_points(result: CaseResult) -> bool:
    """Whether points came back where points were asked for."""
    return bool(np.isfinite(pixel_errors(result)[result.case.answerable]).any())


def _worst(row: WorstRow) -> tuple[str, ...]:
    return (
        str(row.row),
        _vector(row.uv_left, 2),
        _vector(row.uv_right, 2),
        _vector(row.expected_left, 4),
        _vector(row.found_left, 4),
        words.length(row.distance_m),
    )


def _vector(values: Array, decimals: int) -> str:
    """Numbers of a pixel or a point, or "none"."""
    if not np.isfinite(values).all():
        return "none"
    return ", ".join(
        f"{value:.{decimals}f}" if abs(value) < 1e6 else words.number(float(value)) for value in values
    ).replace("-", "−")
