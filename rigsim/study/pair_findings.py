"""What a measured pair gives away about its calibration and its truth, in sentences with numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.pair_result import DenseMap, Finding, PairMatches

LOW_SHARE = 0.08
"""Rectified pairs match a tenth of their points even in heavy noise; swapped ones, or pairs whose rows
are several pixels off, a twentieth at most."""

EPIPOLAR_RMS_PX = 0.3
"""A pair that is off by a third of a row shows more than this."""

EPIPOLAR_TYPICAL_PX = 0.1
"""Half of the matches of a pair whose rows correspond are nearer than this in any noise; a few wrong ones
alone can raise the RMS."""

_ENOUGH = 30
_SHIFT_PX = 0.1
_DENSE_SHIFT_PX = 0.25  # sgbm alone is off by a tenth
_CERTAIN = 5.0
_WITHIN_PCT = 90.0
_TILT_PX = 0.15
_HUBER_PX = 0.3
_MOST_OUTLIERS_PCT = 50.0
_READ_PX = 1.0
_REWEIGHTED = 20


def match_findings(matches: PairMatches, rig: StereoRig) -> Iterator[Finding]:
    """What patches say."""
    share = matches.n / matches.n_tried
    if share < LOW_SHARE:
        yield Finding(
            "few_matches",
            f"Only {matches.n} of {matches.n_tried} points ({100 * share:.1f} %) found a match that can be "
            "trusted: is the pair rectified as the rig says, taken at one moment, in focus, and of something "
            "with texture? What matched may be chance.",
        )
    yield from _row_findings(matches, rig)
    yield from _error_findings(matches, rig)


def board_findings(corners: PairMatches, rig: StereoRig, *, alone: bool) -> Iterator[Finding]:
    """What corners say; of the rows only when they are `alone`, for the patches have said it."""
    if alone:
        yield from _row_findings(corners, rig)
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


def is_misaligned(matches: PairMatches) -> bool:
    """Whether matches lie off their epipolar lines by more than noise and a few wrong ones explain."""
    return matches.epipolar_rms_px > EPIPOLAR_RMS_PX and matches.epipolar_typical_px > EPIPOLAR_TYPICAL_PX


def _row_findings(matches: PairMatches, rig: StereoRig) -> Iterator[Finding]:
    if not is_misaligned(matches):
        return
    rms = matches.epipolar_rms_px
    claimed = "rectified as the rig says" if rig.is_rectified else "as the rig says"
    # what matches by chance tells nothing about the kind of error
    fault = _row_fault(matches) + " " if matches.n >= LOW_SHARE * matches.n_tried else ""
    yield Finding(
        "not_rectified",
        f"The pair is not {claimed}: matches lie {rms:.2f} px (RMS) off their epipolar lines, at most "
        f"{EPIPOLAR_RMS_PX:g} is usual. {fault}Depths and predicted accuracies are not to be trusted: "
        "calibrate or rectify again.",
    )


def _row_fault(matches: PairMatches) -> str:
    """What kind of error the rows show: ``offset = a + b u + c v``, fitted with little weight on outliers."""
    known = np.isfinite(matches.epipolar_px)
    offset, uv = matches.epipolar_px[known], matches.uv_right[known]
    middle = (uv.max(axis=0) + uv.min(axis=0)) / 2
    half_width, half_height = np.maximum(np.ptp(uv, axis=0) / 2, 1.0)
    fitted = np.array([float(np.median(offset)), 0.0, 0.0])
    if len(offset) >= _ENOUGH:
        J = np.column_stack([np.ones(len(uv)), uv - middle])
        for _ in range(_REWEIGHTED):
            off = np.abs(offset - J @ fitted)
            weight = np.sqrt(_HUBER_PX / np.maximum(off, _HUBER_PX))
            fitted = np.linalg.lstsq(J * weight[:, None], offset * weight, rcond=None)[0]
    says = []
    if abs(fitted[0]) > _SHIFT_PX:
        says.append(f"{abs(fitted[0]):.2f} px too {'low' if fitted[0] > 0 else 'high'}")
    if abs(fitted[1]) * half_width > _TILT_PX:
        turn = "clockwise" if fitted[1] > 0 else "counter-clockwise"
        says.append(f"turned {turn} by about {math.degrees(abs(math.atan(fitted[1]))):.2g} deg")
    if abs(fitted[2]) * half_height > _TILT_PX:
        says.append(f"{'larger' if fitted[2] > 0 else 'smaller'} by about {100 * abs(fitted[2]):.2g} %")
    if not says:
        return "They share no shift and no turn: wrong matches, or pictures not taken at one moment."
    return f"The right picture is {_listed(says)}."


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


def _listed(parts: list[str]) -> str:
    return " and ".join([", ".join(parts[:-1]), parts[-1]]) if len(parts) > 1 else parts[0]
