"""What a verification found, as the console, the report and the files show it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from rigsim.errors import TriangulatorReason
from rigsim.rig.arrays import Array
from rigsim.study.saying import Saying
from rigsim.study.verify.case import Case

Status: TypeAlias = Literal["passed", "inefficient", "failed", "error", "not applicable"]
"""``inefficient`` passes unless one is strict; ``error``: the triangulator raised or broke the contract."""

CheckName: TypeAlias = Literal[
    "answered", "nowhere", "exact", "size", "depth", "unbiased", "efficient", "shape"
]
CheckUnit: TypeAlias = Literal["m", "rows", "sigma", ""]


@dataclass(frozen=True, slots=True)
class Check:
    """One number, the interval it must lie in, and why."""

    name: CheckName
    """Which number; docs/reference/verify.md defines them."""
    value: float
    """What was found."""
    low: float
    """Least that passes."""
    high: float
    """Most that passes."""
    unit: CheckUnit
    """Unit of the three numbers; empty for ratios."""
    why: Saying
    """Where the bounds come from, and what the value means."""
    only_strict: bool = False
    """Whether leaving the interval is a matter of efficiency alone."""
    n_behind: int = 0
    """Of the rows without an answer, those that came back as a point behind a camera."""

    @property
    def ok(self) -> bool:
        """Whether the value lies in its interval; NaN does not."""
        return bool(self.low <= self.value <= self.high)


@dataclass(frozen=True, slots=True, eq=False)
class CaseResult:
    """What one triangulator made of one case."""

    case: Case
    """The case."""
    triangulator: str
    """Its label."""
    checks: tuple[Check, ...] = ()
    """What was checked; empty when nothing came back."""
    error: str = ""
    """Why nothing usable came back, one line; empty when something did."""
    reason: TriangulatorReason | None = None
    """What that error is; None without one."""
    shape: tuple[int, ...] = ()
    """The shape that came back, where that is the error."""
    not_applicable: str = ""
    """Why the triangulator is not meant for this case; empty when it is."""
    found_left: Array | None = None
    """What came back, (N, 3), m."""
    seconds: float = 0.0
    """How long the triangulator took."""
    depth_rms_m: float = float("nan")
    """RMS depth error over the rows with an answer, m."""
    predicted_depth_rms_m: float = float("nan")
    """What the pixels' noise allows, m; 0 for exact pixels."""
    efficiency: float = float("nan")
    """Root mean square of the pixel-space error over its expectation: 1 is the Cramer-Rao bound."""
    notes: tuple[str, ...] = ()
    """What was odd without being wrong, as text on stdout."""

    @property
    def timed_out(self) -> bool:
        """Whether nothing came back in time."""
        return self.reason == "timed-out"

    def status(self, strict: bool = False) -> Status:
        """The verdict."""
        if self.not_applicable:
            return "not applicable"
        if self.error:
            return "error"
        if not all(check.ok for check in self.checks if strict or not check.only_strict):
            return "failed"
        if not all(check.ok for check in self.checks):
            return "inefficient"
        return "passed"

    @property
    def failed_checks(self) -> tuple[Check, ...]:
        """The checks outside their interval, efficiency last."""
        bad = [check for check in self.checks if not check.ok]
        return tuple(sorted(bad, key=lambda check: check.only_strict))

    def failures(self, strict: bool = False) -> tuple[Check, ...]:
        """Those that make the case fail; efficiency counts when one is strict."""
        return tuple(check for check in self.failed_checks if strict or not check.only_strict)


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """A mistake that would explain what was found."""

    said: Saying
    """What it is; `rigsim.present.kit.mistakes` has the words."""
    explained: float
    """Share of the error that goes away when the mistake is supposed, 0 to 1."""
    cases: tuple[str, ...]
    """Failing cases that it explains."""
    only: Saying | None = None
    """Which rigs bring it out; None where all do."""

    @property
    def mistake(self) -> str:
        """Stable short name, as ``swapped-cameras``."""
        return self.said.subject


@dataclass(frozen=True, slots=True, eq=False)
class TriangulatorResult:
    """All cases of one triangulator."""

    triangulator: str
    """Its label."""
    results: tuple[CaseResult, ...]
    """In the order of the suite."""
    diagnoses: tuple[Diagnosis, ...] = ()
    """Best first; empty when all is well or nothing fits."""

    def passed(self, strict: bool = False) -> bool:
        """Whether no case failed."""
        return not any(result.status(strict) in ("failed", "error") for result in self.results)


@dataclass(frozen=True, slots=True, eq=False)
class VerifyResult:
    """All triangulators."""

    suite: str
    """quick or full."""
    seed: int
    """Seed of the suite."""
    triangulators: tuple[TriangulatorResult, ...]
    """One for each."""
    left_out: tuple[str, ...] = ()
    """What was not run and why, a sentence each."""
    provenance: dict[str, object] = field(default_factory=dict)
    """Versions, command, machine."""

    def passed(self, strict: bool = False) -> bool:
        """Whether every triangulator passed."""
        return all(result.passed(strict) for result in self.triangulators)
