"""What `rigsim compare --json` prints and compare.json holds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from rigsim.interop.documents.base import Part
from rigsim.interop.documents.rows import row_model
from rigsim.study.compare.columns import COLUMNS
from rigsim.study.compare.judge import off_bound
from rigsim.study.compare.run import ComparisonResult


class Versions(Part):
    """What made the numbers; the speeds hold for these versions on this machine alone."""

    command: str
    """The command line."""
    rigsim: str
    """Version of rigsim."""
    numpy: str
    """Version of NumPy."""
    scipy: str
    """Version of SciPy."""
    opencv: str | None
    """Version of OpenCV; null when it is not installed."""
    mujoco: str
    """Version of MuJoCo."""
    pandas: str
    """Version of pandas."""
    matplotlib: str
    """Version of Matplotlib."""
    python: str
    """Version of Python."""
    processor: str
    """Kind of processor."""


if TYPE_CHECKING:

    class _Columns(Part):
        """The columns of compare.csv."""

else:
    _Columns = row_model("Columns", "The columns of compare.csv.", COLUMNS.values())


class Row(_Columns):
    """One triangulator in one geometry at one noise level."""

    within_noise_of_bound: bool
    """Whether the ratio is as near 1 as noise takes it, with 95 % for all rows together."""


class CompareDocument(Part):
    """Triangulators side by side."""

    headline: str
    """The result in a sentence."""
    sentences: list[str]
    """What else there is to say."""
    triangulators: list[str]
    """Those that were asked, in order."""
    seed: int
    """Seed of points and noise."""
    rows: list[Row]
    """By geometry, noise and triangulator."""
    left_out: list[str]
    """What does not fit, broke or is not installed, a sentence each."""
    provenance: Versions


def compare_document(result: ComparisonResult, headline: str, sentences: Sequence[str]) -> CompareDocument:
    """The comparison as a document; `headline` and `sentences` are its words."""
    good = ~off_bound(result)
    records = [{name: _plain(record[name]) for name in COLUMNS} for record in result.rows.to_dict("records")]
    return CompareDocument(
        headline=headline,
        sentences=list(sentences),
        triangulators=list(result.triangulators),
        seed=result.plan.seed,
        rows=[
            Row.model_validate({**record, "within_noise_of_bound": bool(one)})
            for record, one in zip(records, good, strict=True)
        ],
        left_out=list(result.left_out),
        provenance=Versions.model_validate(dict(result.provenance)),
    )


def _plain(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
