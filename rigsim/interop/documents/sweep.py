"""What `rigsim sweep --json` prints."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from pydantic import Field

from rigsim.interop.documents.base import Part, Provenance, RemarkPart, Written
from rigsim.study.sweep.comparison import compare
from rigsim.study.sweep.result import SweepResult
from rigsim.study.sweep.symptoms import Fault


class SweepProvenance(Provenance):
    """What made the numbers; with `command`, the content of provenance.json."""

    seed: int
    """Seed of every random number."""
    points: int
    """Truth points of each rig."""
    trials: int
    """Noisy repetitions of each point."""


class Row(Part):
    """One configuration, predicted, simulated and measured; the columns of sweep.csv."""

    scene: str
    """Name of the scene."""
    baseline_mm: float
    """Distance between the cameras, mm."""
    focal_px: float
    """Focal length, px."""
    hfov_deg: float
    """Horizontal field of view, degrees."""
    width_px: int
    """Image width, px."""
    height_px: int
    """Image height, px."""
    vergence_deg: float
    """Toe-in angle between the optical axes, degrees."""
    noise_px: float
    """Standard deviation of one pixel coordinate, px."""
    triangulator: str
    """The method under test."""
    sensor: str
    """Lens and sensor of the pictures."""
    n_points: int
    """Truth points."""
    n_visible: int
    """Truth points that both cameras see."""
    n_trials: int
    """Noisy repetitions of each."""
    scene_fraction: float
    """Pixels of the left image that show the scene (within the range, or the bin), of all."""
    visible_fraction: float
    """Of these pixels, those that show what the right camera sees too."""
    overlap_fraction: float
    """Of these pixels, those that show what lies within the right camera's field of view, hidden or not."""
    failed_fraction: float | None
    """Triangulations of visible points that gave no point in front of both cameras."""
    low_disparity_fraction: float | None
    """Of the pixels that show what both see, those with a depth under 4 of its sigmas; in no RMS."""
    depth_median_mm: float | None
    """Median true depth of the points in the statistics, mm."""
    depth_bias_mm: float | None
    """Simulated mean depth error, mm."""
    depth_rmse_mm: float | None
    """Simulated RMS depth error over the truth points, which are balanced over depth, mm; without the
    trials at infinity (1/Z below one standard deviation)."""
    depth_rmse_ci_low_mm: float | None
    """Lower end of its 95 % confidence interval, mm."""
    depth_rmse_ci_high_mm: float | None
    """Upper end of its 95 % confidence interval, mm."""
    depth_abs_p50_mm: float | None
    """Median absolute depth error, mm."""
    depth_abs_p95_mm: float | None
    """95th percentile of the absolute depth error, mm."""
    depth_rmse_pct: float | None
    """RMS of the depth error over the point's own depth, percent."""
    point_rmse_mm: float | None
    """RMS distance between triangulated and true point, mm."""
    predicted_depth_rmse_mm: float | None
    """The closed forms' answer for the same points, mm."""
    predicted_over_simulated: float | None
    """Ratio of the two."""
    nees: float | None
    """Mean normalised squared error of (1/Z, X/Z, Y/Z): 3 when the predicted covariance is right."""
    depth_rmse_image_mm: float | None
    """Simulated RMS depth error per pixel of the left image, as of a depth map, mm."""
    predicted_depth_rmse_image_mm: float | None
    """The closed forms' answer for it, mm."""
    far_inverse_depth_rmse_per_m: float | None
    """Simulated RMS error of 1/Z of the points kept out of the RMS of depth, 1/m; null without any."""
    predicted_far_inverse_depth_rmse_per_m: float | None
    """The closed forms' answer for them, 1/m."""
    measured_method: str
    """What was measured in the two pictures: corners, patches, dense or none."""
    measured_n: int
    """Matches that count; 0 when nothing was measured."""
    measured_outlier_fraction: float | None
    """Matches of nothing that both cameras see, or more than 3 px of disparity off."""
    measured_pixel_rms_px: float | None
    """Measured RMS error of one pixel coordinate, px."""
    measured_disparity_std_px: float | None
    """Measured standard deviation of the disparity's error, px; over sqrt(2) it is a --noise."""
    measured_depth_bias_mm: float | None
    """Mean depth error of the triangulated matches, mm."""
    measured_depth_rmse_mm: float | None
    """RMS depth error of the triangulated matches, mm."""
    measured_depth_abs_p95_mm: float | None
    """95th percentile of their absolute depth error, mm."""
    predicted_from_measured_rmse_mm: float | None
    """The closed forms' answer for them, from the accuracy that the measurement claims for itself, mm."""
    measured_over_predicted: float | None
    """Ratio of the two."""
    measured_within_3_sigma: float | None
    """Share of the matches whose pixel error is within three of the standard deviations they claim."""
    measured_scale: float | None
    """Within what nine of ten errors lie, over where the claim puts it: 1 when the claim holds."""
    measured_scale_ci_low: float | None
    """Lower end of its 99 % interval; 0 with too few points."""
    measured_scale_ci_high: float | None
    """Upper end of its 99 % interval; null with too few points."""
    agreement: str = Field(pattern="^(agrees$|flagged: |untold: )")
    """agrees; flagged: and why; or untold: and why there is not enough to tell."""
    agreement_witness: str
    """Which witness the reason speaks of: simulated, measured, or neither alone."""


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


class OverallRow(Row):
    """One configuration over all depths."""

    limited_by: str
    """What limits it, in a word or two."""
    diagnosis: Diagnosis | None
    """What is off; null where the simulation is not flagged."""


class DepthRow(Row):
    """One configuration within one bin of true depth; the columns of sweep_by_depth.csv."""

    depth_near_mm: float
    """Near edge of the bin, mm."""
    depth_far_mm: float
    """Far edge of the bin, mm."""


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


def sweep_document(result: SweepResult, written: Written | None) -> dict[str, Any]:
    """The whole sweep; `written` is its report, None when none was asked for."""
    provenance = dict(result.provenance)
    faults = result.faults or (None,) * len(result.rows)
    document = SweepDocument.model_validate(
        {
            "command": provenance.pop("command", ""),
            "verdict": {
                "headline": _said(result.verdict.headline),
                "sentences": [_said(sentence) for sentence in result.verdict.sentences],
                "agrees": result.verdict.agrees,
            },
            "complete": result.complete,
            "swept": list(result.swept),
            "best": list(result.best),
            "compared": _compared(result),
            "far_limit_mm": result.far_limit_m * 1e3 if math.isfinite(result.far_limit_m) else None,
            "lens_note": _said(result.lens_note) or None,
            "rows": [
                {**row, "limited_by": limit, "diagnosis": _diagnosis(fault)}
                for row, limit, fault in zip(
                    result.rows.to_dict("records"), result.limits, faults, strict=True
                )
            ],
            "by_depth": result.by_depth.to_dict("records"),
            "remarks": [asdict(remark) for remark in result.remarks],
            "provenance": provenance,
            "written": written,
        }
    )
    return document.model_dump()


def _compared(result: SweepResult) -> dict[str, Any] | None:
    found = compare(result.rows, result.by_depth)
    if not found.spans_mm:
        return None
    return {
        "spans": [{"near_mm": near, "far_mm": far} for near, far in found.spans_mm],
        "depth_rmse_mm": found.simulated_mm.tolist(),
        "predicted_depth_rmse_mm": found.predicted_mm.tolist(),
    }


def _diagnosis(fault: Fault | None) -> dict[str, Any] | None:
    if fault is None:
        return None
    values = asdict(fault)
    return {"mistake": values.pop("name"), **values, "also": list(fault.also)}


def _said(text: str) -> str:
    """Prose without the code marks that pages set."""
    return text.replace("`", "")
