"""What `rigsim compare --json` prints and compare.json holds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from pydantic import Field

from rigsim.interop.documents.base import Part
from rigsim.study.compare.judge import off_bound
from rigsim.study.compare.run import COLUMNS, ComparisonResult


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


class Row(Part):
    """One triangulator in one geometry at one noise level."""

    geometry: str
    """Name of the geometry."""
    noise_px: float = Field(gt=0)
    """Standard deviation of every pixel coordinate, px."""
    triangulator: str
    """Name of the triangulator."""
    n: int
    """Points that were asked for."""
    failed_share: float
    """Share of them that came back as NaN, 0 to 1."""
    expected_failed_share: float
    """Share whose parallax the noise turns negative, 0 to 1."""
    expected_failed_share_se: float
    """Standard error of what is seen of that share."""
    pixel_error_px: float | None
    """RMS length of the error in the four projected coordinates, px; null when no point came back."""
    pixel_bound_px: float
    """The same of the best unbiased triangulator, px."""
    pixel_error_over_bound: float | None
    """Their ratio."""
    pixel_error_over_bound_se: float | None
    """Its standard error, from these points."""
    bound_se: float
    """Standard error that the ratio has at the bound."""
    pixel_error_over_first: float | None
    """Pixel error over that of the first triangulator, over points that both found."""
    pixel_error_over_first_se: float | None
    """Its standard error; the noise is the same for both."""
    depth_error_over_bound: float | None
    """RMS error of 1/Z over its bound."""
    depth_bias_over_std: float | None
    """Mean error of 1/Z in predicted standard deviations, positive when too far."""
    depth_bias_over_std_se: float | None
    """Its standard error."""
    expected_depth_bias_over_std: float
    """What lost points leave of it: those that come back are the nearer ones."""
    depth_median_abs_mm: float | None
    """Median size of the depth error, mm."""
    points_per_second: float | None
    """Median speed, points/s; null when it could not be timed."""
    speed_over_first: float | None
    """Speed over that of the first triangulator."""
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
