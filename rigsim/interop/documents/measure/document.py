"""The document that `rigsim measure --json` prints, made from what was measured."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict
from typing import Any, cast

import numpy as np

from rigsim.interop.documents.base import Written, finite
from rigsim.interop.documents.measure.models import (
    BelievedRig,
    Board,
    Corners,
    Dense,
    DenseDepth,
    Matches,
    MeasureDocument,
    Phase,
    Region,
    RegionName,
    Target,
    Verdict,
    VerdictKey,
    Warned,
    WarningKey,
    Wrong,
)
from rigsim.interop.documents.text import clean
from rigsim.pixels.dense.metrics import DisparityErrors
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.measure.result import DenseMap, Finding, PairMatches, PairMeasurement
from rigsim.study.measure.truth import DenseErrors

Says = Callable[[Finding, StereoRig], str]


def measure_document(result: PairMeasurement, says: Says, written: Written | None = None) -> dict[str, Any]:
    """Everything measured as one JSON document (docs/reference/measure.md); null where there is no number.

    Args:
        result: what was measured.
        says: puts a finding into words.
        written: its folder and files; None when none was asked for.
    """
    best, rig = result.best_matches, result.rig
    return MeasureDocument(
        n_matches=sum(matches.n for matches in result.matches),
        epipolar_rms_px=finite(best.epipolar_rms_px),
        epipolar_median_px=finite(best.epipolar_median_px),
        rig=_rig(rig),
        patches=None if result.patches is None else Matches(**_matches(result.patches)),
        corners=None if result.corners is None else _corners(result.corners, result),
        dense=None if result.dense is None else _dense(result.dense),
        target=_target(result),
        verdicts=[
            Verdict(key=cast("VerdictKey", one.key), says=says(one, rig), kind=one.kind)
            for one in result.verdicts
        ],
        warnings=[
            Warned(key=cast("WarningKey", one.key), says=says(one, rig), kind=one.kind)
            for one in result.findings
        ],
        written=written,
    ).model_dump()


def _rig(rig: StereoRig) -> BelievedRig:
    return BelievedRig(
        width_px=rig.left.width,
        height_px=rig.left.height,
        focal_px=rig.left.fx,
        baseline_mm=clean(1e3 * rig.baseline_m),
        doffs_px=rig.doffs_px,
        rectified=rig.is_rectified,
    )


def _corners(corners: PairMatches, result: PairMeasurement) -> Corners:
    return Corners(
        **_matches(corners),
        boards=[
            Board(
                board=board.board,
                n=board.n,
                distance_mm=finite(1e3 * board.distance_m),
                square_mm=finite(1e3 * board.square_m),
                square_std_mm=finite(1e3 * board.square_std_m),
                flatness_rms_mm=finite(1e3 * board.flatness_rms_m),
            )
            for board in result.boards
        ],
    )


def _matches(matches: PairMatches) -> dict[str, Any]:
    """The keys of `Matches`."""
    errors = matches.errors
    return {
        "n": matches.n,
        "n_tried": matches.n_tried,
        "valid_pct": 100.0 * matches.n / matches.n_tried,
        "epipolar_rms_px": finite(matches.epipolar_rms_px),
        "predicted_std_px": finite(matches.predicted_std_px),
        "predicted_rms_px": finite(matches.predicted_rms_px),
        "noise_px": finite(matches.noise_px),
        "depth_median_mm": _median(1e3 * matches.points_left[:, 2]),
        "predicted_depth_std_mm": _median(1e3 * matches.depth_std_m),
        "n_truth": None if errors is None else errors.errors.n,
        **_wrong(None if errors is None else errors.errors),
        "outlier_pct": None if errors is None else finite(errors.outlier_pct),
        "inlier_std_px": None if errors is None else finite(errors.inlier_std_px),
        "within_3_std_pct": None if errors is None else finite(errors.within_3_std_pct),
    }


def _dense(dense: DenseMap) -> Dense:
    errors = dense.errors
    judged = _region(None if errors is None else errors.regions["all"])
    if errors is None:
        judged["fill_pct"] = dense.image_fill_pct
    return Dense(
        matcher=dense.matcher,
        rectified_first=dense.rectified,
        view=dense.view,
        image_fill_pct=dense.image_fill_pct,
        **judged,
        inlier_std_px=None if errors is None else finite(errors.inlier_std_px),
        noise_px=None if errors is None else finite(errors.inlier_std_px / math.sqrt(2)),
        regions=None if errors is None else _regions(errors),
        phase=None if errors is None else _phase(errors),
        depth=None if errors is None else DenseDepth(**_numbers(asdict(errors.depth))),
    )


def _regions(errors: DenseErrors) -> dict[RegionName, Region]:
    return {cast("RegionName", name): Region(**_region(one)) for name, one in errors.regions.items()}


def _phase(errors: DenseErrors) -> Phase:
    phase = errors.phase
    return Phase(
        amplitude_px=finite(phase.amplitude_px),
        phase_px=[float(value) for value in phase.phase_px],
        mean_error_px=[finite(float(value)) for value in phase.mean_error_px],
        count=[int(n) for n in phase.count],
        measured_count=[int(n) for n in phase.measured_count],
    )


def _target(result: PairMeasurement) -> Target | None:
    if result.target is None or result.target_quality is None:
        return None
    return Target(pixels=result.target, **_numbers(asdict(result.target_quality)))


def _region(errors: DisparityErrors | None) -> dict[str, Any]:
    """The keys of `Region`; all null without errors."""
    return {
        "n": None if errors is None else errors.n,
        "invalid_pct": None if errors is None else finite(errors.invalid_pct),
        **_wrong(errors),
        "fill_pct": None if errors is None else finite(errors.fill_pct),
    }


def _wrong(errors: DisparityErrors | None) -> dict[str, float | None]:
    """The keys of `Wrong`, which have the names of `DisparityErrors`; all null without errors."""
    return {key: None if errors is None else finite(getattr(errors, key)) for key in Wrong.model_fields}


def _numbers(values: dict[str, float]) -> dict[str, float | None]:
    return {key: finite(value) for key, value in values.items()}


def _median(values: Array) -> float | None:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else None
