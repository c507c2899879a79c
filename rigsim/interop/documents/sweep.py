"""What `rigsim sweep --json` prints."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, Protocol

import pandas as pd

from rigsim.interop.documents.base import Golden, Part, Provenance, RemarkPart, Written, finite, golden_part
from rigsim.interop.documents.rows import row_model
from rigsim.study.agreement.fault import Fault
from rigsim.study.golden.compare import GoldenReport
from rigsim.study.scene import columns
from rigsim.study.sweep.comparison import compare
from rigsim.study.sweep.requirement import RowsHeld, take, verdicts
from rigsim.study.sweep.result import SweepResult


class SweepProvenance(Provenance):
    """What made the numbers; with `command`, the content of provenance.json."""

    seed: int
    """Seed of every random number."""
    points: int
    """Truth points of each rig."""
    trials: int
    """Noisy repetitions of each point."""


if TYPE_CHECKING:

    class Row(Part):
        """The columns of sweep.csv."""

    class DepthRow(Row):
        """The columns of sweep_by_depth.csv."""

else:
    Row = row_model(
        "Row",
        "One configuration, predicted, simulated and measured; the columns of sweep.csv.",
        [columns.COLUMNS[name] for name in columns.ROW_COLUMNS],
    )
    DepthRow = row_model(
        "DepthRow",
        "One configuration within one bin of true depth; the columns of sweep_by_depth.csv.",
        [columns.COLUMNS[name] for name in columns.DEPTH_COLUMNS if name not in columns.ROW_COLUMNS],
        Row,
    )


class Diagnosis(Part):
    """What is off in a flagged row."""

    mistake: str
    """Stable short name, as yaw or scale; unknown when no single known mistake explains the errors."""
    says: str
    """One sentence."""
    amount: float | None
    """How much, in unit: the truth minus what the triangulation takes; null where it has no amount."""
    amount_se: float | None
    """Standard error of the amount."""
    unit: str
    """Unit of the amount; empty where it has none."""
    explained: float | None
    """Share of the error that it explains, 0 to 1; null where that is not what tells."""
    also: list[str]
    """Mistakes that have the same effect here."""


Held = Literal["met", "not_met", "not_shown"]
"""Whether a row keeps what was asked: `not_shown` where the scene has too few points near the distance, or
where the limit lies within the interval of what was simulated."""


class HeldRow(Part):
    """One row held to one requirement."""

    verdict: Held
    """Whether it keeps it."""
    depth_error_mm: float | None
    """Simulated depth error at the distance, mm; null where the scene has too few points near it."""
    ci_low_mm: float | None
    """Lower end of its 95 % interval, mm."""
    ci_high_mm: float | None
    """Upper end, mm."""
    near_mm: float | None
    """Near edge of the bin of depth that shows it, mm."""
    far_mm: float | None
    """Far edge, mm."""


class RequirementPart(Part):
    """A depth error that rows are to keep, and whether they do."""

    statistic: Literal["rms", "p95"]
    """Root mean square, or what 95 of 100 errors stay under."""
    at_mm: float
    """Its distance, mm."""
    required_mm: float
    """The error, mm."""
    rows: list[HeldRow]
    """One for each of `rows`."""


class OverallRow(Row):
    """One configuration over all depths."""

    limited_by: str
    """What limits it, in a word or two."""
    diagnosis: Diagnosis | None
    """What is off; null where the simulation is not flagged."""
    requirement: Held | None
    """Whether it keeps everything that --require asks for; null where nothing is asked."""


class Verdict(Part):
    """The answer in words."""

    headline: str
    """The answer in one sentence, with numbers."""
    sentences: list[str]
    """What else must be known, a sentence each."""
    agrees: bool
    """Whether no row was flagged."""


class Span(Part):
    """A stretch of depth."""

    near_mm: float
    """Nearest depth, mm."""
    far_mm: float
    """Farthest depth, mm."""


class Compared(Part):
    """The depth error of the rows at the same distances, per pixel of the left image: what `best` goes by."""

    spans: list[Span]
    """The distances, near to far: bins of depth that the rows answer together."""
    depth_rmse_mm: list[float | None]
    """Simulated RMS there, one for each row, mm; null for a row that does not answer them."""
    predicted_depth_rmse_mm: list[float | None]
    """The closed forms' answer for the same, mm."""


class SweepDocument(Part):
    """Rigs swept through a scene: predicted, simulated and measured depth error side by side."""

    command: str
    """The command that was typed."""
    verdict: Verdict
    complete: bool
    """False when the run was interrupted and holds only the rigs done until then (exit code 130)."""
    swept: list[str]
    """Columns of the rows that were varied."""
    best: list[int]
    """Places in rows of the configurations to take, best first."""
    recommended: int | None
    """Place of the row to take: the shortest baseline that meets what --require asks for, of those that cover
    enough; null for none, or unasked."""
    requirements: list[RequirementPart]
    """What --require asks for; empty where nothing is asked."""
    compared: Compared | None
    """What the order goes by; null when the rows have no distances in common."""
    far_limit_mm: float | None
    """Depth beyond which surfaces were left out because no rig reaches it, mm; null when none were."""
    lens_note: str | None
    """What stayed and what changed between resolutions; null when there was but one."""
    rows: list[OverallRow]
    """One for each configuration."""
    by_depth: list[DepthRow]
    """One for each configuration and bin of depth."""
    remarks: list[RemarkPart]
    """What is odd about the scene or the rigs' place in it; also on standard error."""
    provenance: SweepProvenance
    written: Written | None
    """The report; null without --out."""
    golden: Golden | None
    """Null without --golden and --update."""


class Told(Protocol):
    """The answer in words."""

    @property
    def headline(self) -> str:
        """The answer in one sentence."""

    @property
    def sentences(self) -> Sequence[str]:
        """What else must be known, a sentence each."""


class Words(Protocol):
    """The sentences of the document, made by whoever calls: `rigsim.present.sweep.words` has them all."""

    def verdict(self, result: SweepResult) -> Told:
        """The answer."""

    def lens(self, result: SweepResult) -> str:
        """What stayed and what changed between resolutions; empty when there was but one."""

    def fault(self, fault: Fault) -> str:
        """What is off in a row."""

    def spelled(self, table: pd.DataFrame) -> pd.DataFrame:
        """A table with its agreements as words."""


def sweep_document(
    result: SweepResult, words: Words, written: Written | None, golden: GoldenReport | None = None
) -> dict[str, Any]:
    """The whole sweep; `written` is its report, None when none was asked for."""
    provenance, told = dict(result.provenance), words.verdict(result)
    command = str(provenance.pop("command", ""))
    faults = result.faults or (None,) * len(result.rows)
    kept_by = verdicts(result.requirements) or (None,) * len(result.rows)
    rows, by_depth = (words.spelled(table).to_dict("records") for table in (result.rows, result.by_depth))
    return SweepDocument(
        command=command,
        verdict=Verdict(
            headline=_said(told.headline),
            sentences=[_said(sentence) for sentence in told.sentences],
            agrees=result.agrees,
        ),
        complete=result.complete,
        swept=list(result.swept),
        best=list(result.best),
        recommended=take(result.rows, result.best, result.requirements) if result.requirements else None,
        requirements=[_requirement(held) for held in result.requirements],
        compared=_compared(result),
        far_limit_mm=result.far_limit_m * 1e3 if math.isfinite(result.far_limit_m) else None,
        lens_note=_said(words.lens(result)) or None,
        rows=[
            OverallRow.model_validate(
                {**row, "requirement": kept, "limited_by": limit, "diagnosis": _diagnosis(fault, words)}
            )
            for row, kept, limit, fault in zip(rows, kept_by, result.limits, faults, strict=True)
        ],
        by_depth=[DepthRow.model_validate(row) for row in by_depth],
        remarks=[RemarkPart(code=one.code, text=one.text) for one in result.remarks],
        provenance=SweepProvenance.model_validate(provenance),
        written=written,
        golden=golden_part(golden),
    ).model_dump()


def _requirement(held: RowsHeld) -> RequirementPart:
    return RequirementPart(
        statistic="p95" if held.asked.p95 else "rms",
        at_mm=held.asked.at_mm,
        required_mm=held.asked.error_mm,
        rows=[
            HeldRow(
                verdict=row.verdict,
                depth_error_mm=finite(row.error_mm),
                ci_low_mm=finite(row.low_mm),
                ci_high_mm=finite(row.high_mm),
                near_mm=finite(row.near_mm),
                far_mm=finite(row.far_mm),
            )
            for row in held.rows
        ],
    )


def _compared(result: SweepResult) -> Compared | None:
    found = compare(result.rows, result.by_depth)
    if not found.spans_mm:
        return None
    return Compared(
        spans=[Span(near_mm=near, far_mm=far) for near, far in found.spans_mm],
        depth_rmse_mm=found.simulated_mm.tolist(),
        predicted_depth_rmse_mm=found.predicted_mm.tolist(),
    )


def _diagnosis(fault: Fault | None, words: Words) -> Diagnosis | None:
    if fault is None:
        return None
    return Diagnosis(
        mistake=fault.name,
        says=words.fault(fault),
        amount=fault.amount,
        amount_se=fault.amount_se,
        unit=fault.unit,
        explained=fault.explained,
        also=list(fault.also),
    )


def _said(text: str) -> str:
    """Prose without the code marks that pages set."""
    return text.replace("`", "")
