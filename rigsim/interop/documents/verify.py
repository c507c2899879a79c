"""What `rigsim verify --json` prints and verify.json holds."""

from __future__ import annotations

from typing import Any, Literal, Protocol, cast

from pydantic import Field

from rigsim.interop.documents.base import Golden, Part, Versions, finite, golden_part
from rigsim.rig.arrays import Array
from rigsim.study.golden.compare import GoldenReport
from rigsim.study.verify.case import Case, CaseKind
from rigsim.study.verify.result import (
    CaseResult,
    Check,
    CheckName,
    CheckUnit,
    Diagnosis,
    Status,
    TriangulatorResult,
    VerifyResult,
)
from rigsim.study.verify.runner import FALSE_ALARM
from rigsim.study.verify.worst import WorstRow, worst_rows

_STATUSES: tuple[Status, ...] = ("passed", "inefficient", "failed", "error", "not applicable")


Suite = Literal["quick", "full"]


class MadeBy(Versions):
    """The command and what ran it."""

    command: str
    """The command that was typed."""


class Counts(Part):
    """How many cases ended how."""

    passed: int
    """Passed."""
    inefficient: int
    """Passed, but with errors larger than least squares leaves."""
    failed: int
    """A check failed; with --strict, those that were inefficient too."""
    error: int
    """Nothing usable came back."""
    not_applicable: int
    """Not asked, since the triangulator is not meant for such rigs."""


class Diagnosed(Part):
    """A mistake that would explain what was found."""

    mistake: str
    """Stable short name, as swapped-cameras."""
    says: str
    """What it is, and where to look."""
    explained: float | None = Field(ge=0, le=1)
    """Share of the error that it accounts for, 0 to 1."""
    cases: list[str]
    """Failing cases that it explains."""


class Checked(Part):
    """One number and the interval it must lie in."""

    check: CheckName
    """Which number; docs/reference/verify.md defines them."""
    ok: bool
    """Whether it lies in the interval."""
    value: float | None
    """What was found, in the unit beside it; null when it is no number."""
    low: float | None
    """Least that passes; null when nothing is too little."""
    high: float | None
    """Most that passes; null when nothing is too much."""
    unit: CheckUnit
    """Unit of the three; empty for ratios."""
    only_strict: bool
    """Whether it matters with --strict only."""
    why: str
    """Where the bounds come from."""


Pair = tuple[float | None, float | None]
Triple = tuple[float | None, float | None, float | None]


class Worst(Part):
    """A row with a large error."""

    row: int
    """Which row, from 0."""
    uv_left_px: Pair
    """Left pixel that was given, px."""
    uv_right_px: Pair
    """Right pixel that was given, px."""
    expected_m: Triple
    """True point in the left camera's frame, m; null where the row has none."""
    found_m: Triple
    """What came back, m; null where nothing did."""
    distance_m: float | None
    """Between the two, m."""


class CaseDone(Part):
    """What a triangulator made of one case."""

    case: str
    """Unique name, as verged exact."""
    group: str
    """What cases of one geometry share, as verged."""
    kind: CaseKind
    """What was asked: the points themselves, errors of the size that noise or pictures allow, or nothing."""
    about: str
    """What the case shows."""
    rows: int
    """How many points it has."""
    status: Status
    """The verdict."""
    error: str | None
    """Why nothing usable came back; null when something did."""
    not_applicable: str | None
    """Why it was not asked; null when it was."""
    seconds: float
    """Time the triangulator took, s."""
    efficiency: float | None
    """RMS pixel error over what the noise must cause; null without noise."""
    depth_rms_mm: float | None
    """RMS depth error, mm."""
    predicted_depth_rms_mm: float | None
    """What the noise must cause to first order, mm; 0 without noise."""
    notes: list[str]
    """What was odd without being wrong, as text that was printed."""
    checks: list[Checked]
    """What was checked; empty when nothing came back."""
    worst_rows: list[Worst]
    """At most five rows of a failed case."""


class TriangulatorDone(Part):
    """All cases of one triangulator."""

    triangulator: str
    """Its name, or the program's command."""
    passed: bool
    """Whether no case failed."""
    counts: Counts
    seconds: float
    """Time spent in it, s."""
    diagnoses: list[Diagnosed]
    """Best first; empty when all is well or no known mistake fits."""
    cases: list[CaseDone]
    """In the order in which they were run."""


class VerifyDocument(Part):
    """Triangulators tested on cases with known answers."""

    passed: bool
    """The verdict: exit code 0, or 3 when it is false."""
    strict: bool
    """Whether inefficient cases failed, too."""
    suite: Suite
    """Which suite the cases are of."""
    seed: int
    """Seed of every random number."""
    false_alarm: float
    """Probability that a correct triangulator fails the run."""
    triangulators: list[TriangulatorDone]
    """In the order in which they were named."""
    left_out: list[str]
    """What could not be run and why, a sentence each."""
    golden: Golden | None
    """Null without --golden and --update."""
    provenance: MadeBy


class Words(Protocol):
    """The sentences of the document, made by whoever calls: `rigsim.present.verify.words` has them all."""

    def about(self, what: Case) -> str:
        """What a case shows."""

    def why(self, check: Check) -> str:
        """Where the bounds of a check come from."""

    def says(self, found: Diagnosis) -> str:
        """What a mistake is, and where to look."""


def verify_document(
    result: VerifyResult, words: Words, strict: bool = False, golden: GoldenReport | None = None
) -> dict[str, Any]:
    """The verification with stable keys and units in their names; null where there is no number.

    Args:
        result: the verification.
        words: its sentences.
        strict: whether efficiency counts.
        golden: how it compares with golden results; None when it was not asked.
    """
    return VerifyDocument(
        passed=result.passed(strict) and (golden is None or golden.passed),
        strict=strict,
        suite=cast("Suite", result.suite),
        seed=result.seed,
        false_alarm=FALSE_ALARM,
        triangulators=[_triangulator(one, words, strict) for one in result.triangulators],
        left_out=list(result.left_out),
        golden=golden_part(golden),
        provenance=MadeBy.model_validate(dict(result.provenance)),
    ).model_dump()


def _triangulator(result: TriangulatorResult, words: Words, strict: bool) -> TriangulatorDone:
    status = [case.status(strict) for case in result.results]
    return TriangulatorDone(
        triangulator=result.triangulator,
        passed=result.passed(strict),
        counts=Counts(**{name.replace(" ", "_"): status.count(name) for name in _STATUSES}),
        seconds=sum(case.seconds for case in result.results),
        diagnoses=[
            Diagnosed(
                mistake=one.mistake,
                says=words.says(one),
                explained=finite(one.explained),
                cases=list(one.cases),
            )
            for one in result.diagnoses
        ],
        cases=[_case(case, words, strict) for case in result.results],
    )


def _case(result: CaseResult, words: Words, strict: bool) -> CaseDone:
    case, status = result.case, result.status(strict)
    return CaseDone(
        case=case.name,
        group=case.group,
        kind=case.kind,
        about=words.about(case),
        rows=len(case),
        status=status,
        error=result.error or None,
        not_applicable=result.not_applicable or None,
        seconds=result.seconds,
        efficiency=finite(result.efficiency),
        depth_rms_mm=finite(result.depth_rms_m * 1e3),
        predicted_depth_rms_mm=finite(result.predicted_depth_rms_m * 1e3),
        notes=list(result.notes),
        checks=[_check(check, words) for check in result.checks],
        worst_rows=[_row(row) for row in worst_rows(result)] if status == "failed" else [],
    )


def _check(check: Check, words: Words) -> Checked:
    return Checked(
        check=check.name,
        ok=check.ok,
        value=finite(check.value),
        low=finite(check.low),
        high=finite(check.high),
        unit=check.unit,
        only_strict=check.only_strict,
        why=words.why(check),
    )


def _row(row: WorstRow) -> Worst:
    return Worst(
        row=row.row,
        uv_left_px=cast("Pair", _numbers(row.uv_left)),
        uv_right_px=cast("Pair", _numbers(row.uv_right)),
        expected_m=cast("Triple", _numbers(row.expected_left)),
        found_m=cast("Triple", _numbers(row.found_left)),
        distance_m=finite(row.distance_m),
    )


def _numbers(values: Array) -> tuple[float | None, ...]:
    return tuple(finite(float(value)) for value in values)
