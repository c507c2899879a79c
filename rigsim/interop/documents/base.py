"""What every document is made of."""

from __future__ import annotations

import math
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from rigsim.interop.documents.text import clean
from rigsim.rig.stereo import StereoRig
from rigsim.study.golden.compare import VERDICTS, GoldenReport, GoldenValue


class Part(BaseModel):
    """An object with fixed keys; the docstrings of its keys become the schema's descriptions."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, use_attribute_docstrings=True, populate_by_name=True
    )


class RemarkPart(Part):
    """What a person should know beside the answer."""

    code: str
    """Short name, snake_case."""
    text: str
    """One sentence: the value, why it is odd, and the way out."""


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
    """Unit of the next three; empty for ratios and words."""
    before: float | str | None
    """The golden number or word; null when it is new, or was no number."""
    now: float | str | None
    """The same now; null when it is gone, or is no number."""
    bound: float | None
    """What a number may differ by."""
    verdict: Literal["within tolerance", "within noise", "moved", "new", "gone"]
    """Whether that matters."""


class Golden(Part):
    """How the run compares with golden results."""

    folder: str
    """Their folder or file."""
    passed: bool
    """Whether nothing moved or is gone, or they were written anew."""
    counts: GoldenCounts
    moves: list[Moved]
    """The numbers that are not the same."""
    remarks: list[str]
    """Differences in what made the two, a sentence each."""
    troubles: list[str]
    """Files that could not be read, a line each."""


class Rig(Part):
    """A rig in short."""

    baseline_mm: float = Field(gt=0)
    """Distance between the cameras, mm."""
    focal_px: float = Field(gt=0)
    """Focal length of the left camera, px."""
    width_px: int = Field(gt=0)
    """Image width, px."""
    height_px: int = Field(gt=0)
    """Image height, px."""


class SeenRig(Rig):
    """A rig with its field of view."""

    hfov_deg: float = Field(gt=0, le=360)
    """Horizontal field of view of the left camera, degrees."""


class Versions(Part):
    """Versions of what made the numbers."""

    rigsim: str
    """Version of rigsim."""
    mujoco: str
    """Version of MuJoCo."""
    numpy: str
    """Version of NumPy."""
    scipy: str
    """Version of SciPy."""
    pandas: str
    """Version of pandas."""
    matplotlib: str
    """Version of Matplotlib."""
    python: str
    """Version of Python."""


class Provenance(Versions):
    """What made the numbers: versions, renderer and scene."""

    renderer: str
    """What rendered: rays, or the GL library's own name for itself."""
    scene: str
    """Name of the scene."""
    mount: str
    """Where the rig sits in it."""


class Written(Part):
    """What was written to disk."""

    folder: str
    """The folder, as --out names it."""
    files: list[str]
    """Names of the files written there, sorted."""


def finite(value: float) -> float | None:
    """A number; None for what is none or has no bound."""
    return float(value) if math.isfinite(value) else None


def plain_rig(rig: StereoRig) -> Rig:
    """A rig's numbers, without a field of view."""
    return Rig(
        baseline_mm=rig.baseline_m * 1e3,
        focal_px=rig.left.fx,
        width_px=rig.left.width,
        height_px=rig.left.height,
    )


def seen_rig(rig: StereoRig) -> SeenRig:
    """A rig's numbers."""
    return SeenRig(
        baseline_mm=clean(rig.baseline_m * 1e3),
        focal_px=clean(rig.left.fx),
        width_px=rig.left.width,
        height_px=rig.left.height,
        hfov_deg=clean(rig.left.hfov_deg),
    )


def golden_part(golden: GoldenReport | None) -> Golden | None:
    """The comparison; None when none was asked for."""
    if golden is None:
        return None
    comparison = golden.comparison
    return Golden(
        folder=golden.folder,
        passed=golden.passed,
        counts=GoldenCounts(**{name.replace(" ", "_"): comparison.count(name) for name in VERDICTS}),
        moves=[
            Moved(
                record=move.record,
                number=move.number,
                unit=move.unit,
                before=_value(move.before),
                now=_value(move.now),
                bound=finite(move.bound),
                verdict=move.verdict,
            )
            for move in comparison.moves
            if move.verdict != "same"
        ],
        remarks=list(comparison.remarks),
        troubles=list(golden.troubles),
    )


def _value(value: GoldenValue) -> float | str | None:
    return value if isinstance(value, str) else finite(value)
