"""What `rigsim calc points --json` prints."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Literal

import numpy as np

from rigsim.interop.documents.base import Golden, Part, RemarkPart, finite, golden_part
from rigsim.rig.arrays import Array
from rigsim.rig.remark import Remark
from rigsim.study.calc.points import FALSE_ALARM, PairPoints
from rigsim.study.golden.compare import GoldenReport


class PairPoint(Part):
    """A pair of pixels and its point, in the left camera's frame."""

    u_left_px: float
    """Left pixel, as given."""
    v_left_px: float
    """Left pixel, as given."""
    u_right_px: float
    """Right pixel, as given."""
    v_right_px: float
    """Right pixel, as given."""
    x_mm: float | None
    """Right of the left camera, mm; null where there is no point."""
    y_mm: float | None
    """Below the left camera, mm."""
    z_mm: float | None
    """Depth, in front of the left camera, mm."""
    std_x_mm: float | None
    """Standard deviation of X for this noise, to first order, mm."""
    std_y_mm: float | None
    """The same of Y, mm."""
    std_z_mm: float | None
    """The same of the depth, mm."""
    off_px: float | None
    """How far the two pixels are from each other's epipolar lines, px in all; over sqrt(2) the rows'
    difference when rectified. Null where the lens shows nothing."""
    consistent: bool
    """Whether the noise explains that."""
    why: Literal["", "behind", "infinity", "lens"]
    """Why there is no point: the rays part, are parallel within the noise, or the lens shows nothing."""


class CalcPointsDocument(Part):
    """Matched pixels triangulated, each with its uncertainty and whether its two pixels belong together."""

    says: str
    """The answer in a sentence."""
    n_pairs: int
    """Pairs given."""
    n_points: int
    """Pairs that have a point."""
    z_least_mm: float | None
    """Depth of the nearest point, mm."""
    z_most_mm: float | None
    """Depth of the farthest point, mm."""
    std_z_median_mm: float | None
    """Median standard deviation of the depth, mm."""
    noise_px: float
    """Standard deviation of a pixel coordinate that was taken, px."""
    observed_noise_px: float | None
    """The same that half of the pairs' distances from their epipolar lines speak of, px."""
    n_inconsistent: int
    """Pairs further off than the noise explains."""
    false_alarm: float
    """Share of right pairs that are called so by chance, 0 to 1."""
    verdict: Literal["agrees", "flagged", "untold"]
    """Whether there are more of them than by chance; ``untold`` where there are too few pairs to tell."""
    uv_origin: Literal["first pixel", "optical axis"]
    """Where pixels count from: the optical axis where neither image size nor principal point is known."""
    points: list[PairPoint]
    """One for each pair, in the order given."""
    remarks: list[RemarkPart]
    """What is odd: pairs without a point, pixels outside the image, more inconsistent than by chance."""
    golden: Golden | None
    """Null without --golden and --update."""


def points_document(
    found: PairPoints,
    says: str,
    uv_origin: str,
    remarks: Iterable[Remark],
    golden: GoldenReport | None = None,
) -> dict[str, Any]:
    """The document that ``rigsim calc points --json`` prints; docs/reference/calc.md describes it.

    Args:
        found: the points.
        says: the answer in a sentence.
        uv_origin: where pixels count from.
        remarks: what is odd.
        golden: what came of a comparison with golden results.
    """
    summary = depths(found)
    head: dict[str, Any] = {
        "says": says,
        "n_pairs": len(found.uv),
        "n_points": found.n_points,
        "z_least_mm": summary[0],
        "z_most_mm": summary[1],
        "std_z_median_mm": summary[2],
        "noise_px": found.noise.std_px,
        "observed_noise_px": finite(found.observed_noise_px),
        "n_inconsistent": found.n_inconsistent,
        "false_alarm": FALSE_ALARM,
        "verdict": found.verdict,
        "uv_origin": uv_origin,
        "points": _points(found),
        "remarks": [RemarkPart(code=remark.code, text=remark.text) for remark in remarks],
        "golden": golden_part(golden),
    }
    return CalcPointsDocument(**head).model_dump()


def depths(found: PairPoints) -> tuple[float | None, float | None, float | None]:
    """Least and greatest depth, and the median standard deviation of the depth, mm; None without a point."""
    known = found.why == ""
    if not known.any():
        return None, None, None
    z, std = found.points[known, 2] * 1e3, found.stds[known, 2] * 1e3
    return float(z.min()), float(z.max()), float(np.median(std))


def _points(found: PairPoints) -> list[dict[str, Any]]:
    numbers: list[Array] = [found.uv, found.points * 1e3, found.stds * 1e3, found.off_px[:, None]]
    names = list(PairPoint.model_fields)
    table = np.hstack(numbers).astype(object)
    table[table != table] = None  # NaN alone differs from itself
    rows = np.column_stack([table, found.consistent.astype(object), found.why.astype(object)]).tolist()
    return [dict(zip(names, row, strict=True)) for row in rows]
