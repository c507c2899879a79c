"""What the three witnesses are asked, and what they said, as rows of a table."""

from __future__ import annotations

from dataclasses import dataclass

from rigsim.present.kit.format import MISSING, length_mm, number
from rigsim.studio.draw.proof import ProofRequest, ProofRow, ProvedRig
from rigsim.studio.logic.numbers import RigNumbers


@dataclass(frozen=True, slots=True)
class ProofLine:
    """One row of the table, as people read it."""

    where: str
    """Which points."""
    predicted: str
    """Predicted error, mm."""
    simulated: str
    """Simulated error, mm."""
    measured: str
    """Measured error, mm."""
    expected: str
    """What the measurement's own pixel noise predicts, mm."""
    n: str
    """Measured points."""
    verdict: str
    """``agrees``, ``flagged`` or ``untold``."""
    why: str
    """The reason of another verdict than that it agrees."""


def proof_wanted(found: RigNumbers, scene: str) -> ProofRequest | None:
    """What proves the numbers that are shown; None for no rig."""
    if found.shown is None:
        return None
    return ProofRequest(found.shown.rig, scene, noise_px=found.shown.noise.std_px)


def lines(proved: ProvedRig) -> tuple[ProofLine, ...]:
    """The bins of depth, near to far, and all points."""
    return tuple(line_of(row) for row in (*proved.bins, proved.whole))


def line_of(row: ProofRow) -> ProofLine:
    """One row as people read it."""
    where = "all points"
    if row.near_mm is not None and row.far_mm is not None:
        where = f"{length_mm(row.near_mm)} to {length_mm(row.far_mm)}"
    verdict, _, why = row.agreement.partition(":")
    told = verdict.split()[0] if verdict else "untold"
    rest = why.strip() or verdict.removeprefix(told).strip()
    return ProofLine(
        where=where,
        predicted=_mm(row.predicted_mm),
        simulated=_mm(row.simulated_mm),
        measured=_mm(row.measured_mm),
        expected=_mm(row.measured_predicted_mm),
        n=str(row.measured_n),
        verdict=told,
        why=rest,
    )


def _mm(value: float | None) -> str:
    return MISSING if value is None else number(value)
