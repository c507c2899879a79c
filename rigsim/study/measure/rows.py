"""Whether a pair's rows correspond as its rig says: a claim with a test and a way to say that it is open.

The residuals of N matches, how far below its epipolar line each lies, are fitted by ``a + b u + c v`` with
little weight on outliers. Neighbouring windows share pixels, so N of them count for N / 4: the standard error
of `a` is ``1.25 scatter / sqrt(N / 4)``.

- flagged: a shift over 0.1 px and over 5 standard errors; a turn or a scale over 0.15 px at the borders, and
  over 5 of theirs; or residuals over 0.3 px RMS and 0.1 px in the median, which share neither.
- agrees: none of these, and the shift within 0.3 px with 3 standard errors on top.
- untold: the rest, under 30 patches or 8 corners, and pairs that match under 8 % of their points, unless they
  match on other rows (`rigsim.pixels.patches.vertical`), which is flagged.

docs/reference/measure.md gives false alarms and power.
"""

from __future__ import annotations

import math

import numpy as np

from rigsim.rig.stereo import StereoRig
from rigsim.statistics import robust_rms
from rigsim.study.measure.result import Finding, PairMatches, RowFit

LOW_SHARE = 0.08
"""Rectified pairs match a tenth of their points even in heavy noise; swapped ones, or pairs whose rows
are several pixels off, a twentieth at most."""

EPIPOLAR_RMS_PX = 0.3
"""A pair that is off by a third of a row shows more than this."""

EPIPOLAR_TYPICAL_PX = 0.1
"""Half of the matches of a pair whose rows correspond are nearer than this in any noise; a few wrong ones
alone can raise the RMS."""

_ENOUGH = {"patches": 30, "corners": 8}
_OVERLAP = {"patches": 4.0, "corners": 1.0}
_HUBER_PX = 0.3
_REWEIGHTED = 20


def fit_rows(matches: PairMatches) -> RowFit:
    """Fit the residuals of matches; of too few, the median alone."""
    known = np.isfinite(matches.epipolar_px)
    offset, uv = matches.epipolar_px[known], matches.uv_right[known]
    n = len(offset)
    if n == 0:
        return RowFit(0, math.nan, math.nan, 0.0, 0.0, 1.0, 1.0)
    middle = (uv.max(axis=0) + uv.min(axis=0)) / 2
    half_width, half_height = np.maximum(np.ptp(uv, axis=0) / 2, 1.0)
    fitted = np.array([float(np.median(offset)), 0.0, 0.0])
    J = np.column_stack([np.ones(n), uv - middle])
    if n >= _ENOUGH[matches.kind]:
        for _ in range(_REWEIGHTED):
            off = np.abs(offset - J @ fitted)
            weight = np.sqrt(_HUBER_PX / np.maximum(off, _HUBER_PX))
            fitted = np.linalg.lstsq(J * weight[:, None], offset * weight, rcond=None)[0]
    scatter = robust_rms(offset - J @ fitted)
    se = 1.25 * scatter / math.sqrt(max(n / _OVERLAP[matches.kind], 1.0))
    turn, growth = float(fitted[1]), float(fitted[2])
    at = (float(middle[0]), float(middle[1]))
    return RowFit(n, float(fitted[0]), se, turn, growth, half_width, half_height, at)


def is_misaligned(matches: PairMatches) -> bool:
    """Whether matches lie off their epipolar lines by more than noise and a few wrong ones explain."""
    return matches.epipolar_rms_px > EPIPOLAR_RMS_PX and matches.epipolar_typical_px > EPIPOLAR_TYPICAL_PX


def row_verdict(matches: PairMatches, rig: StereoRig, found_px: float | None = None) -> Finding:
    """Whether rows correspond as the rig says.

    Args:
        matches: patches or corners.
        rig: the rig.
        found_px: how far too low the right picture was found to be when matches were looked for on other
            rows; None when they were not, or found nothing.
    """
    if found_px is not None:
        return Finding("not_rectified", "other-rows", numbers={"shift_px": found_px})
    rows = fit_rows(matches)
    share = matches.n / matches.n_tried
    if rows.n < _ENOUGH[matches.kind] or (matches.kind == "patches" and share < LOW_SHARE):
        few = {"n": rows.n, "n_tried": matches.n_tried}
        return Finding("rows_untold", "too-few", "untold", few, matches.kind)
    if rows.is_shifted or rows.is_tilted or rows.is_scaled or is_misaligned(matches):
        depth_m = matches.points_left[:, 2]
        depth_m = depth_m[np.isfinite(depth_m)]
        off = {
            "epipolar_rms_px": matches.epipolar_rms_px,
            "shift_px": rows.shift_px,
            "depth_m": float(np.median(depth_m)) if len(depth_m) else math.nan,
        }
        return Finding("not_rectified", "off-lines", numbers=off, rows=rows)
    if abs(rows.shift_px) + 3 * rows.shift_se_px > EPIPOLAR_RMS_PX:
        return Finding("rows_untold", "too-uncertain", "untold", rows=rows)
    return Finding("rows_fit", "fit", "agrees", rows=rows)


def shift_words(shift_px: float, rig: StereoRig) -> str:
    """How far too low the right picture is, and what of the rig would make it so, as errors say it."""
    turn_deg = math.degrees(math.atan(abs(shift_px) / rig.right.fy))
    up, small = ("up", "small") if shift_px > 0 else ("down", "large")
    return (
        f"The right picture is {abs(shift_px):.2f} px too {down(shift_px)}, as if its camera looked {up} by "
        f"{turn_deg:.2g} deg more, or its cy in the rig were {abs(shift_px):.2f} px too {small}."
    )


def down(shift_px: float) -> str:
    """Which way a picture is off that is too low by so much."""
    return "low" if shift_px > 0 else "high"
