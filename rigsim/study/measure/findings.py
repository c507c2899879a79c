"""What a measured pair gives away about its truth and its matcher, as values."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.measure.result import DenseMap, Finding, PairMatches
from rigsim.study.measure.rows import LOW_SHARE

_ENOUGH = 30
_SHIFT_PX = 0.1
_DENSE_SHIFT_PX = 0.25  # sgbm alone is off by a tenth
_CERTAIN = 5.0
_WITHIN_PCT = 90.0
_MOST_OUTLIERS_PCT = 50.0
_READ_PX = 1.0


def match_findings(matches: PairMatches, rig: StereoRig) -> Iterator[Finding]:
    """What patches say."""
    share = matches.n / matches.n_tried
    if share < LOW_SHARE:
        few = {"n": matches.n, "n_tried": matches.n_tried, "share_pct": 100 * share}
        yield Finding("few_matches", "few", "untold", few)
    yield from _error_findings(matches, rig)


def board_findings(corners: PairMatches, rig: StereoRig) -> Iterator[Finding]:
    """What corners say."""
    yield from _error_findings(corners, rig)


def dense_findings(dense: DenseMap, truth: Array | None, matches: PairMatches | None) -> Iterator[Finding]:
    """What dense disparities say, beyond what `matches` have said."""
    if truth is None:
        return
    if dense.errors is None:
        yield Finding("dense_not_judged", "not-rectified", "untold")
        return
    known = np.isfinite(dense.disparity) & np.isfinite(truth)
    if known.sum() < _ENOUGH:
        return
    bias = float(np.median((dense.disparity - truth)[known]))
    others = 0.0 if matches is None else _bias(matches)
    nmad = dense.errors.regions["all"].nmad_px
    if abs(bias - others) > max(_DENSE_SHIFT_PX, nmad / 2):
        yield Finding("dense_shift", "shifted", numbers={"bias_px": bias})


def _error_findings(matches: PairMatches, rig: StereoRig) -> Iterator[Finding]:
    if matches.errors is None or matches.errors.errors.n < _ENOUGH:
        return
    errors = matches.errors
    bias = _bias(matches)
    uncertain = errors.errors.nmad_px / math.sqrt(errors.errors.n)
    if errors.outlier_pct > _MOST_OUTLIERS_PCT:
        off = {"outlier_pct": errors.outlier_pct}
        yield Finding("wrong_truth", _misread(matches, rig), numbers=off, of=matches.kind)
    elif abs(bias) > max(_SHIFT_PX, _CERTAIN * uncertain):
        half = abs(abs(bias) - 0.5) < 0.05
        yield Finding(
            "shift", "half-a-pixel" if half else "shifted", numbers={"bias_px": bias}, of=matches.kind
        )
    elif errors.within_3_std_pct < _WITHIN_PCT:
        near = {"within_3_std_pct": errors.within_3_std_pct}
        yield Finding("overconfident", "overconfident", numbers=near, of=matches.kind)


def _bias(matches: PairMatches) -> float:
    """Median error of the disparities, px; 0 where nothing is known."""
    error = matches.disparity_px - matches.truth_px
    error = error[np.isfinite(error)]
    return float(np.median(error)) if len(error) else 0.0


def _misread(matches: PairMatches, rig: StereoRig) -> str:
    """Which of the other ways people mean a truth it would fit, by a short name."""
    truth = matches.truth_px
    focal_baseline = rig.left.fx * rig.baseline_m
    with np.errstate(divide="ignore", invalid="ignore"):
        readings = {
            "sign": -truth,
            "doffs": truth - rig.doffs_px,
            "metres": focal_baseline / truth - rig.doffs_px,
            "millimetres": focal_baseline / (truth / 1e3) - rig.doffs_px,
        }
    for name, reading in readings.items():
        error = np.abs(matches.disparity_px - reading)
        error = error[np.isfinite(error)]
        if len(error) and np.median(error) < _READ_PX:
            return name
    return "other"
