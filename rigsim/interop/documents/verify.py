"""What `rigsim verify --json` prints and verify.json holds."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from rigsim.interop.documents.base import Part, Versions
from rigsim.study.verify.case import Kind
from rigsim.study.verify.result import Status


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

    check: Literal["answered", "nowhere", "exact", "size", "depth", "unbiased", "efficient", "shape"]
    """Which number; docs/reference/verify.md defines them."""
    ok: bool
    """Whether it lies in the interval."""
    value: float | None
    """What was found, in the unit beside it; null when it is no number."""
    low: float | None
    """Least that passes; null when nothing is too little."""
    high: float | None
    """Most that passes; null when nothing is too much."""
    unit: Literal["m", "rows", "sigma", ""]
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
    kind: Kind
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


class GoldenCounts(Part):
    """How many golden numbers ended how."""

    same: int
    """Equal."""
    within_tolerance: int
    """Off by no more than another computer's rounding or driver allows."""
    within_noise: int
    """Off by no more than the noise allows."""
    moved: int
    """Off by more."""
    new: int
    """Not among the golden ones."""
    gone: int
    """Golden, but not made any more."""


class Moved(Part):
    """A number that is not what it was."""

    record: str
    """Name of its golden file, without the ending."""
    number: str
    """Its name there."""
    unit: str
    """Unit of the next three; empty for ratios."""
    before: float | None
    """The golden value; null when it is new."""
    now: float | None
    """The value now; null when it is gone."""
    bound: float | None
    """What it may differ by."""
    verdict: Literal["within tolerance", "within noise", "moved", "new", "gone"]
    """Whether that matters."""


class Golden(Part):
    """How the run compares with golden results."""

    folder: str
    """Where they are."""
    passed: bool
    """Whether nothing moved or is gone, or they were written anew."""
    counts: GoldenCounts
    moves: list[Moved]
    """The numbers that are not the same."""
    remarks: list[str]
    """Differences in what made the two, a sentence each."""
    troubles: list[str]
    """Files that could not be read, a line each."""


class VerifyDocument(Part):
    """Triangulators tested on cases with known answers."""

    passed: bool
    """The verdict: exit code 0, or 3 when it is false."""
    strict: bool
    """Whether inefficient cases failed, too."""
    suite: Literal["quick", "full"]
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
