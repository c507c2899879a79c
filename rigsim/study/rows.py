"""From error statistics to one row of a table, with prediction and simulation compared."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array, Ids, Mask
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.sim.points import Coverage
from rigsim.study.measured import Measured, bins_of, measured_agreement, measured_row, nothing_measured
from rigsim.study.plan import Triangulator
from rigsim.study.result import DEPTH_COLUMNS, ROW_COLUMNS, Row
from rigsim.study.statistics import ErrorStatistics, ErrorSummary, summarize
from rigsim.study.trial import Prediction
from rigsim.theory.uncertainty import LEAST_DEPTH_SIGMAS

AGREEMENT_SIGMAS = 4.0
"""Standard errors by which prediction and simulation may differ: one false alarm in 16,000 rows."""

_FAILED = (3, 1e-3)  # more failures than this, in number and share, are no accident at 4 sigma
_EXACT = 1e-9  # relative error that is arithmetic alone
_DIGITS = 12


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """All that one row is made of; (N,) over the truth points of the rig."""

    rig: StereoRig
    """The rig that is assumed."""
    depth_m: Array
    """True depth, m."""
    visible: Mask
    """Seen by both cameras."""
    in_right_image: Mask
    """Within the right camera's field of view, hidden or not."""
    coverage: Coverage
    """What rays spread evenly over the left image meet."""
    coverage_bins: Ids
    """Depth bin of each of those rays that meets something."""
    image_weight: Array
    """Weights of the points that make an average one over the pixels of the left image."""
    bins: Ids
    """Depth bin of each point."""
    edges_m: Array
    """Edges of the bins, (n_bins + 1,), m."""
    prediction: Prediction
    """Prediction for the visible points, in their order."""
    stats: ErrorStatistics
    """Simulated errors of the visible points, in their order."""
    measured: Measured | None
    """What the pictures say; None when nothing was to be measured."""
    triangulator: Triangulator
    """The method under test."""


def configuration(scene: str, rig: StereoRig, noise: PixelNoise, triangulator: str, sensor: str) -> Row:
    """The columns that say what a row is about."""
    return {
        "scene": scene,
        "baseline_mm": _clean(rig.baseline_m * 1e3),
        "focal_px": _clean(rig.left.fx),
        "hfov_deg": _clean(rig.left.hfov_deg),
        "width_px": rig.left.width,
        "height_px": rig.left.height,
        "vergence_deg": _clean(rig.vergence_deg) + 0.0,
        "noise_px": noise.std_px,
        "triangulator": triangulator,
        "sensor": sensor,
    }


def overall_row(head: Row, evidence: Evidence) -> Row:
    """The row of sweep.csv."""
    everything = np.ones(len(evidence.depth_m), dtype=bool)
    body = _body(evidence, everything, slice(0, len(evidence.stats.histogram)))
    body |= _covered(evidence, everything, np.ones(len(evidence.coverage_bins), dtype=bool))
    body = _with_measured(body, evidence, None)
    return {name: (head | body)[name] for name in ROW_COLUMNS}


def empty_row(head: Row, n_trials: int, why: str) -> Row:
    """The row of sweep.csv for a rig that has no truth points."""
    row: Row = dict.fromkeys(ROW_COLUMNS, math.nan)
    row |= nothing_measured() | {
        "n_points": 0,
        "n_visible": 0,
        "n_trials": n_trials,
        "scene_fraction": 0.0,
        "visible_fraction": 0.0,
        "overlap_fraction": 0.0,
    }
    return {**row, "agreement": f"flagged: {why}", **head}


def depth_rows(head: Row, evidence: Evidence) -> list[Row]:
    """The rows of sweep_by_depth.csv: one for each bin that holds points."""
    rows = []
    for i, (near, far) in enumerate(zip(evidence.edges_m[:-1], evidence.edges_m[1:], strict=True)):
        inside = evidence.bins == i
        if inside.any():
            body = _with_measured(_body(evidence, inside, slice(i, i + 1)), evidence, i)
            body |= _covered(evidence, inside, evidence.coverage_bins == i)
            body |= {"depth_near_mm": _clean(near * 1e3), "depth_far_mm": _clean(far * 1e3)}
            rows.append({name: (head | body)[name] for name in DEPTH_COLUMNS})
    return rows


def _body(evidence: Evidence, inside: Mask, groups: slice) -> Row:
    visible_inside = inside[evidence.visible]  # among the visible points
    low = evidence.prediction.low_disparity
    weight = evidence.image_weight[evidence.visible]
    kept = visible_inside & ~low
    tried = int(visible_inside.sum()) * evidence.stats.n_trials
    row: Row = {
        "n_points": int(inside.sum()),
        "n_visible": int(visible_inside.sum()),
        "n_trials": evidence.stats.n_trials,
        "failed_fraction": 1 - float(evidence.stats.count[visible_inside].sum()) / tried
        if tried
        else math.nan,
        "low_disparity_fraction": float(np.average(low[visible_inside], weights=weight[visible_inside]))
        if tried
        else math.nan,
    }
    depth_m = evidence.depth_m[evidence.visible]
    summary = summarize(evidence.stats, depth_m, kept, groups) if kept.any() else None
    if summary is None:
        nothing = dict.fromkeys(ROW_COLUMNS[ROW_COLUMNS.index("depth_median_mm") :], math.nan)
        return {**row, **nothing, "agreement": _why_nothing(tried, low[visible_inside])}
    predicted_m = _rms(evidence.prediction.depth_rmse_m[kept])
    image_m, predicted_image_m = (
        _weighted_rms(each[kept], weight[kept])
        for each in (evidence.stats.depth_rmse_m, evidence.prediction.depth_rmse_m)
    )
    median_m = float(np.median(depth_m[kept]))
    return {
        **row,
        "depth_median_mm": median_m * 1e3,
        "depth_bias_mm": summary.bias_m * 1e3,
        "depth_rmse_mm": summary.rmse_m * 1e3,
        "depth_rmse_ci_low_mm": summary.ci_low_m * 1e3,
        "depth_rmse_ci_high_mm": summary.ci_high_m * 1e3,
        "depth_abs_p50_mm": summary.abs_p50_m * 1e3,
        "depth_abs_p95_mm": summary.abs_p95_m * 1e3,
        "depth_rmse_pct": summary.relative_rmse * 100,
        "point_rmse_mm": summary.point_rmse_m * 1e3,
        "predicted_depth_rmse_mm": predicted_m * 1e3,
        "predicted_over_simulated": predicted_m / summary.rmse_m if predicted_m > 0 else math.nan,
        "nees": summary.nees,
        "depth_rmse_image_mm": image_m * 1e3,
        "predicted_depth_rmse_image_mm": predicted_image_m * 1e3,
        "agreement": _agreement(evidence, kept, summary, median_m),
    }


def _covered(evidence: Evidence, points: Mask, rays: Mask) -> Row:
    """Shares of the left image's pixels; of the points in a bin so small that no ray meets it."""
    coverage = evidence.coverage
    if not rays.any():
        return {
            "scene_fraction": 0.0,
            "visible_fraction": float(evidence.visible[points].mean()),
            "overlap_fraction": float(evidence.in_right_image[points].mean()),
        }
    return {
        "scene_fraction": float(rays.sum()) / coverage.n_rays,
        "visible_fraction": float(coverage.visible_right[rays].mean()),
        "overlap_fraction": float(coverage.in_right_image[rays].mean()),
    }


def _with_measured(body: Row, evidence: Evidence, depth_bin: int | None) -> Row:
    """The row with what the pictures say of one depth bin, or of all; flagged if they object."""
    measured = evidence.measured
    if measured is None:
        return {**body, **nothing_measured()}
    bins = bins_of(measured, evidence.edges_m)
    # a match of nothing has no depth: it counts as an outlier of the whole
    inside = bins == depth_bin if depth_bin is not None else (bins >= 0) | measured.outlier
    row = {**body, **measured_row(measured, evidence.rig, evidence.triangulator, inside)}
    if row["agreement"] == "agrees" and (depth_bin is None or row["measured_n"]):
        row["agreement"] = measured_agreement(row, measured.why)
    return row


def _agreement(evidence: Evidence, kept: Mask, summary: ErrorSummary, median_m: float) -> str:
    """Whether prediction and simulation differ by more than noise, truncation and arithmetic explain.

    The simulation's scatter is taken from the errors themselves, but between one and three times what
    was predicted: a triangulator that errs wildly must not be excused by its own scatter.
    """
    prediction, n_trials = evidence.prediction, evidence.stats.n_trials
    tried = int(kept.sum()) * n_trials
    failed = tried - summary.n
    if failed > _FAILED[0] and failed > _FAILED[1] * tried:
        return f"flagged: {failed / tried * 100:.2g} % of the triangulations failed"
    predicted_m = _rms(prediction.depth_rmse_m[kept])
    slack_m2 = _rms((prediction.depth_rmse_m + prediction.truncation_m)[kept]) ** 2 - predicted_m**2
    expected_se_m2 = math.sqrt(float((prediction.square_std_m2[kept] ** 2).sum()) * n_trials) / tried
    se_m2 = min(max(summary.mean_square_se_m2, expected_se_m2), 3 * expected_se_m2)
    difference_m2 = summary.rmse_m**2 - predicted_m**2
    if abs(difference_m2) <= AGREEMENT_SIGMAS * se_m2 + slack_m2 + (_EXACT * median_m) ** 2:
        return "agrees"
    if predicted_m == 0:
        return f"flagged: simulated error {summary.rmse_m * 1e3:.3g} mm where none is predicted"
    ratio = summary.rmse_m / predicted_m
    if ratio >= 2:
        return f"flagged: simulated error {ratio:.3g} times the prediction"
    side = "above" if ratio > 1 else "below"
    return f"flagged: simulated error {abs(ratio - 1) * 100:.2g} % {side} the prediction"


def _why_nothing(tried: int, low: Mask) -> str:
    if not tried:
        return "flagged: left and right share nothing"
    if low.all():
        return f"flagged: every depth is below {LEAST_DEPTH_SIGMAS:g} of its standard deviations"
    return "flagged: every triangulation failed"


def _rms(values: Array) -> float:
    return math.sqrt(float(np.mean(values**2)))


def _weighted_rms(values: Array, weight: Array) -> float:
    """Root of the weighted mean square; what failed in every trial counts in none."""
    good = np.isfinite(values)
    if not good.any():
        return math.nan
    return math.sqrt(float(np.average(values[good] ** 2, weights=weight[good])))


def _clean(value: float) -> float:
    """The value without the last digits' rounding noise: 150, not 149.99999999999997."""
    return float(f"{value:.{_DIGITS}g}")
