"""What a measured pair gives away about its truth and its matcher, in sentences with numbers."""

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
        yield Finding(
            "few_matches",
            f"Only {matches.n} of {matches.n_tried} points ({100 * share:.1f} %) found a match that can be "
            "trusted: is the pair rectified as the rig says, taken at one moment, in focus, and of something "
            "with texture? What matched may be chance.",
            "untold",
        )
    yield from _error_findings(matches, rig)


def board_findings(corners: PairMatches, rig: StereoRig) -> Iterator[Finding]:
    """What corners say."""
    yield from _error_findings(corners, rig)


def dense_findings(dense: DenseMap, truth: Array | None, matches: PairMatches | None) -> Iterator[Finding]:
    """What dense disparities say, beyond what `matches` have said."""
    if truth is None:
        return
    if dense.errors is None:
        yield Finding(
            "dense_not_judged",
            "The rig is not rectified: dense disparities belong to the rectified pair, and the truth does "
            "not, so only matches are compared with it.",
            "untold",
        )
        return
    known = np.isfinite(dense.disparity) & np.isfinite(truth)
    if known.sum() < _ENOUGH:
        return
    bias = float(np.median((dense.disparity - truth)[known]))
    others = 0.0 if matches is None else _bias(matches)
    nmad = dense.errors.regions["all"].nmad_px
    if abs(bias - others) > max(_DENSE_SHIFT_PX, nmad / 2):
        yield Finding(
            "dense_shift",
            f"Half of the dense disparities are {_too(bias)} by {abs(bias):.2f} px or more, which matched "
            "patches are not: the matcher shifts, or takes a pixel's middle for its corner.",
        )


def _error_findings(matches: PairMatches, rig: StereoRig) -> Iterator[Finding]:
    if matches.errors is None or matches.errors.errors.n < _ENOUGH:
        return
    errors = matches.errors
    bias = _bias(matches)
    uncertain = errors.errors.nmad_px / math.sqrt(errors.errors.n)
    if errors.outlier_pct > _MOST_OUTLIERS_PCT:
        yield Finding(
            "wrong_truth",
            f"{errors.outlier_pct:.0f} % of the {matches.kind} are more than 3 px off the truth: it "
            f"{_misread(matches, rig)}.",
        )
    elif abs(bias) > max(_SHIFT_PX, _CERTAIN * uncertain):
        hint = ""
        if abs(abs(bias) - 0.5) < 0.05:
            hint = " Half a pixel is the difference between counting pixels from their middles and corners."
        yield Finding(
            "shift",
            f"Disparities of {matches.kind} are {_too(bias)} by {abs(bias):.2f} px in the median: a picture "
            f"is shifted along its rows, or the truth belongs to other pictures.{hint}",
        )
    elif errors.within_3_std_pct < _WITHIN_PCT:
        yield Finding(
            "overconfident",
            f"Only {errors.within_3_std_pct:.0f} % of the {matches.kind} lie within 3 of their predicted "
            "standard deviations of the truth: their predicted accuracy is too good to be true.",
        )


def _bias(matches: PairMatches) -> float:
    """Median error of the disparities, px; 0 where nothing is known."""
    error = matches.disparity_px - matches.truth_px
    error = error[np.isfinite(error)]
    return float(np.median(error)) if len(error) else 0.0


def _misread(matches: PairMatches, rig: StereoRig) -> str:
    """What the truth would fit if it were read in another of the ways people mean it."""
    truth = matches.truth_px
    focal_baseline = rig.left.fx * rig.baseline_m
    with np.errstate(divide="ignore", invalid="ignore"):
        readings = {
            "looks like u_right - u_left: change its sign": -truth,
            "looks like a disparity with doffs added: subtract it": truth - rig.doffs_px,
            "looks like a depth in metres": focal_baseline / truth - rig.doffs_px,
            "looks like a depth in millimetres": focal_baseline / (truth / 1e3) - rig.doffs_px,
        }
    for words, reading in readings.items():
        error = np.abs(matches.disparity_px - reading)
        error = error[np.isfinite(error)]
        if len(error) and np.median(error) < _READ_PX:
            return words
    return "belongs to other pictures, or is no disparity u_left - u_right"


def _too(bias: float) -> str:
    return "too large (too near)" if bias > 0 else "too small (too far)"
