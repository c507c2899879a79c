"""From error statistics to one row of a table, with prediction and simulation compared."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtr

from rigsim.errors import TriangulatorError
from rigsim.rig.arrays import Array, Ids, Mask
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.sim.truth.points import Coverage, GroundTruth, away
from rigsim.statistics import rms
from rigsim.study.agreement.agreement import Agreement, AgreementPlace, worst
from rigsim.study.agreement.claims import measured_agreement
from rigsim.study.agreement.fault import UNKNOWN, Fault
from rigsim.study.agreement.simulated import Part, compare, image_parts
from rigsim.study.scene import columns as col
from rigsim.study.scene.axes import registry
from rigsim.study.scene.axes.configuration import Configuration
from rigsim.study.scene.column import clean
from rigsim.study.scene.columns import DEPTH_COLUMNS, ERROR_COLUMNS, ROW_COLUMNS, Row
from rigsim.study.scene.plan import Triangulator
from rigsim.study.scene.statistics import ErrorStatistics, summarize
from rigsim.study.scene.third_witness import MeasuredMatches, bins_of, measured_row, nothing_measured
from rigsim.study.scene.trials import Prediction

_FAR = (col.FAR_INVERSE_DEPTH_RMSE, col.PREDICTED_FAR_INVERSE_DEPTH_RMSE)


@dataclass(frozen=True, slots=True, eq=False)
class RowEvidence:
    """All that one row is made of; (N,) over the truth points of the rig."""

    rig: StereoRig
    """The rig that is assumed."""
    points_left: Array
    """True points, (N, 3), m."""
    uv_left: Array
    """Where the left image has them, (N, 2), px."""
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
    measured: MeasuredMatches | None
    """What the pictures say; None when nothing was to be measured."""
    triangulator: Triangulator
    """The method under test."""
    diagnose: Callable[[], Fault | None]
    """What is off; asked where the row is flagged."""

    @property
    def depth_m(self) -> Array:
        """True depth, (N,), m; of a wide lens, whose depth may be none, the distance."""
        return away(self.rig.left, self.points_left)


def configuration(scene: str, rig: StereoRig, noise: PixelNoise, triangulator: str, sensor: str) -> Row:
    """The columns that say what a row is about."""
    return {col.SCENE: scene} | registry.values(Configuration(rig, noise, triangulator, sensor))


def empty_row(head: Row, n_trials: int, cause: str) -> Row:
    """The row of sweep.csv for a rig that has no truth points; `cause` is the error that says so."""
    row: Row = dict.fromkeys(ROW_COLUMNS, math.nan)
    row |= nothing_measured() | {
        col.N_POINTS: 0,
        col.N_VISIBLE: 0,
        col.N_TRIALS: n_trials,
        col.SCENE_FRACTION: 0.0,
        col.VISIBLE_FRACTION: 0.0,
        col.OVERLAP_FRACTION: 0.0,
    }
    return row | _written(Agreement("untold", reason="no-points", cause=cause)) | head


def broken_row(head: Row, truth: GroundTruth, n_trials: int, error: TriangulatorError) -> Row:
    """The row of sweep.csv where a triangulator broke: what the rig sees, and why there is no result."""
    coverage = truth.coverage
    row = empty_row(head, n_trials, "") | {
        col.N_POINTS: len(truth.points_left),
        col.N_VISIBLE: int(truth.visible.sum()),
    }
    if len(coverage.depth_m):
        row |= {
            col.SCENE_FRACTION: len(coverage.depth_m) / coverage.n_rays,
            col.VISIBLE_FRACTION: float(coverage.visible_right.mean()),
            col.OVERLAP_FRACTION: float(coverage.in_right_image.mean()),
        }
    return row | _written(Agreement("untold", reason="triangulator-failed", cause=str(error)))


def rows_of(head: Row, evidence: RowEvidence) -> tuple[Row, list[Row], Fault | None]:
    """The row of sweep.csv; those of sweep_by_depth.csv, one for each bin with points; and what is off."""
    n_bins = len(evidence.edges_m) - 1
    whole, parts = _agreements(evidence)
    fault = evidence.diagnose() if whole.kind == "flagged" else None
    if whole.kind == "flagged":
        whole = replace(whole, fault=fault or UNKNOWN)
    everything = np.ones(len(evidence.bins), dtype=bool)
    body = _body(evidence, everything, slice(0, n_bins))
    body |= _covered(evidence, everything, np.ones(len(evidence.coverage_bins), dtype=bool))
    row = _joined(body, evidence, None, whole)
    overall = {name: (head | row)[name] for name in ROW_COLUMNS}
    by_depth = []
    for i, (near, far) in enumerate(zip(evidence.edges_m[:-1], evidence.edges_m[1:], strict=True)):
        inside = evidence.bins == i
        if inside.any():
            body = _body(evidence, inside, slice(i, i + 1))
            body |= _covered(evidence, inside, evidence.coverage_bins == i)
            row = _joined(body, evidence, i, parts[i])
            row |= {col.DEPTH_NEAR: clean(near * 1e3), col.DEPTH_FAR: clean(far * 1e3)}
            by_depth.append({name: (head | row)[name] for name in DEPTH_COLUMNS})
    return overall, by_depth, fault


def _agreements(evidence: RowEvidence) -> tuple[Agreement, list[Agreement]]:
    """Whether the simulation agrees with the prediction: over all, and in each depth bin."""
    visible, edges_m = evidence.visible, evidence.edges_m
    bins = [
        Part(AgreementPlace("depth", (near, far)), evidence.bins[visible] == i)
        for i, (near, far) in enumerate(itertools.pairwise(edges_m))
    ]
    left = evidence.rig.left
    regions = image_parts(evidence.uv_left[visible], left.width, left.height)
    return compare(evidence.prediction, evidence.stats, bins, regions)


def _body(evidence: RowEvidence, inside: Mask, groups: slice) -> Row:
    visible_inside = inside[evidence.visible]  # among the visible points
    low = evidence.prediction.low_disparity
    weight = evidence.image_weight[evidence.visible]
    kept = visible_inside & ~low
    tried = int(visible_inside.sum()) * evidence.stats.n_trials
    row: Row = {
        col.N_POINTS: int(inside.sum()),
        col.N_VISIBLE: int(visible_inside.sum()),
        col.N_TRIALS: evidence.stats.n_trials,
        col.FAILED_FRACTION: 1 - float(evidence.stats.count[visible_inside].sum()) / tried
        if tried
        else math.nan,
        col.LOW_DISPARITY_FRACTION: float(np.average(low[visible_inside], weights=weight[visible_inside]))
        if tried
        else math.nan,
    }
    depth_m = evidence.depth_m[evidence.visible]
    summary = summarize(evidence.stats, depth_m, kept, groups) if kept.any() else None
    if summary is None:
        nothing = dict.fromkeys(ERROR_COLUMNS, math.nan)
        return row | nothing | _far(evidence, visible_inside & low)
    predicted_m = rms(evidence.prediction.depth_rmse_m[kept])
    image_m, predicted_image_m = (
        _weighted_rms(each[kept], weight[kept])
        for each in (evidence.stats.depth_rmse_m, evidence.prediction.depth_rmse_m)
    )
    median_m = float(np.median(depth_m[kept]))
    return {
        **row,
        **_far(evidence, visible_inside & low),
        col.DEPTH_MEDIAN: median_m * 1e3,
        col.DEPTH_OF_RMSE: float(np.mean(depth_m[kept] ** 4)) ** 0.25 * 1e3,
        col.DEPTH_BIAS: summary.bias_m * 1e3,
        col.DEPTH_RMSE: summary.rmse_m * 1e3,
        col.DEPTH_RMSE_CI_LOW: summary.ci_low_m * 1e3,
        col.DEPTH_RMSE_CI_HIGH: summary.ci_high_m * 1e3,
        col.DEPTH_ABS_P50: summary.abs_p50_m * 1e3,
        col.DEPTH_ABS_P95: summary.abs_p95_m * 1e3,
        col.DEPTH_RMSE_PCT: summary.relative_rmse * 100,
        col.POINT_RMSE: summary.point_rmse_m * 1e3,
        col.PREDICTED_DEPTH_RMSE: predicted_m * 1e3,
        col.PREDICTED_OVER_SIMULATED: predicted_m / summary.rmse_m if predicted_m > 0 else math.nan,
        col.NEES: summary.nees if predicted_m > 0 else math.nan,
        col.DEPTH_RMSE_IMAGE: image_m * 1e3,
        col.PREDICTED_DEPTH_RMSE_IMAGE: predicted_image_m * 1e3,
    }


def _covered(evidence: RowEvidence, points: Mask, rays: Mask) -> Row:
    """Shares of the left image's pixels; of the points in a bin so small that no ray meets it."""
    coverage = evidence.coverage
    if not rays.any():
        return {
            col.SCENE_FRACTION: 0.0,
            col.VISIBLE_FRACTION: float(evidence.visible[points].mean()),
            col.OVERLAP_FRACTION: float(evidence.in_right_image[points].mean()),
        }
    return {
        col.SCENE_FRACTION: float(rays.sum()) / coverage.n_rays,
        col.VISIBLE_FRACTION: float(coverage.visible_right[rays].mean()),
        col.OVERLAP_FRACTION: float(coverage.in_right_image[rays].mean()),
    }


def _far(evidence: RowEvidence, far: Mask) -> Row:
    """The error of 1/Z of the points that are too far for an RMS of depth; nothing where there are none.

    Trials beyond infinity fail. What is left of a Gaussian cut off at -s standard deviations has a mean
    square of ``1 - s phi(s) / Phi(s)``.
    """
    count = evidence.stats.count[far]
    n = float(count.sum())
    if n == 0:
        return dict.fromkeys(_FAR, math.nan)
    std_per_m = np.sqrt(evidence.prediction.view_covariance[far, 0, 0])
    s = evidence.prediction.depth_sigmas[far]
    kept = ndtr(s)
    square = std_per_m**2 * (1 - s * np.exp(-(s**2) / 2) / math.sqrt(2 * math.pi) / kept)
    found = evidence.stats.sum_depth_w2[far] * std_per_m**2
    expected = float((square * kept).sum() / kept.sum())
    return dict(zip(_FAR, (math.sqrt(float(found.sum()) / n), math.sqrt(expected)), strict=True))


def _joined(body: Row, evidence: RowEvidence, depth_bin: int | None, simulated: Agreement) -> Row:
    """The row with what the pictures say of one depth bin, or of all, and the agreement of all witnesses."""
    measured = evidence.measured
    if measured is None:
        return body | nothing_measured() | _written(simulated)
    bins = bins_of(measured, evidence.rig, evidence.edges_m)
    # a match of nothing has no depth: it counts as an outlier of the whole
    inside = bins == depth_bin if depth_bin is not None else (bins >= 0) | measured.outlier
    row = measured_row(measured, evidence.rig, evidence.triangulator, inside)
    found = [simulated]
    if depth_bin is None or row[col.MEASURED_N]:
        found.append(measured_agreement(row, int(inside.sum()), measured.why))
    return body | row | _written(worst(found))


def _written(agreement: Agreement) -> Row:
    witness = "" if agreement.kind == "agrees" else agreement.witness
    return {col.AGREEMENT: agreement, col.AGREEMENT_WITNESS: witness}


def _weighted_rms(values: Array, weight: Array) -> float:
    """Root of the weighted mean square; what failed in every trial counts in none."""
    good = np.isfinite(values)
    if not good.any():
        return math.nan
    return math.sqrt(float(np.average(values[good] ** 2, weights=weight[good])))
