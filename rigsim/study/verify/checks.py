"""Whether points that somebody triangulated are as good as their pixels allow.

Errors are judged in pixels: the found point is projected again and compared with the true point's
projection. There the errors of a least-squares triangulator are Gaussian whatever the depth, with a
covariance that only the noise decides, so that the bounds below are quantiles and nothing is typed in.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import rms
from rigsim.study.saying import saying
from rigsim.study.verify.bound import bound, depth_reach
from rigsim.study.verify.case import Case
from rigsim.study.verify.result import Check
from rigsim.theory.uncertainty import parallax_px, pixel_gain

EXACT_M = 1e-9
"""Largest error without noise, m, and relative to the distance beyond a metre."""
WORST_EFFICIENCY = 1.5
"""A triangulator's errors may be this many times those of the Cramer-Rao bound unless one is strict."""
FIRST_ORDER = 1.2
"""Times the expected number of rows may be lost: lenses that distort bend what noise does to 1/Z."""
AT_INFINITY_PX = 1e-6
"""A point with less parallax than this, px, is as good as at infinity."""

_ROUNDING = 16 * np.finfo(np.float64).eps


@dataclass(frozen=True, slots=True)
class Judgement:
    """The checks of one case and the three numbers that tables show."""

    checks: tuple[Check, ...]
    """In the order in which they are to be read."""
    depth_rms_m: float
    """RMS depth error over the answered rows, m."""
    predicted_depth_rms_m: float
    """What the pixels allow, m; 0 for exact pixels."""
    efficiency: float
    """Size of the errors over what the pixels allow; NaN for exact pixels."""


def statistical_checks(case: Case) -> int:
    """How many random numbers `judge` holds against a quantile in this case."""
    return 5 if case.kind == "noisy" and len(case) else 0


def judge(case: Case, found_left: Array, false_alarm: float) -> Judgement:
    """Hold found points (N, 3) m against a case.

    Args:
        case: the case.
        found_left: one row for each of the case's; NaN where nothing was found.
        false_alarm: probability with which one statistical check may fail a correct triangulator.
    """
    asked = case.answerable
    truth, found = case.points_left[asked], found_left[asked]
    error_px = _pixels(case, found) - _pixels(case, truth)
    answered = np.asarray(np.isfinite(error_px).all(axis=1))
    gain = pixel_gain(case.rig, truth)
    checks: list[Check] = []
    if not asked.all():
        checks.append(_nowhere(case, found_left, ~asked))
    if len(truth) == 0:
        return Judgement(tuple(checks), math.nan, math.nan, math.nan)
    checks.append(_answered(case, truth, found, answered, false_alarm))
    truth, found, error_px, gain = truth[answered], found[answered], error_px[answered], gain[answered]
    depth_rms_m = rms(found[:, 2] - truth[:, 2])
    if case.covariance_px2 is None:
        if len(truth):
            checks.append(_exact(case, truth, found, gain))
        return Judgement(tuple(checks), depth_rms_m, 0.0, math.nan)
    if len(truth) == 0:
        return Judgement(tuple(checks), math.nan, math.nan, math.nan)
    covariance = np.broadcast_to(case.covariance_px2, (len(case), 4, 4))[asked][answered]
    predicted_m = math.sqrt(float(np.einsum("ni,nij,nj->n", gain[:, 2], covariance, gain[:, 2]).mean()))
    if case.kind == "noisy":
        sigma_px = math.sqrt(float(covariance[0, 0, 0]))
        efficiency, more = _noisy(case, truth, found, error_px, gain, sigma_px, false_alarm)
    else:
        seen_px = np.hstack([case.uv_left, case.uv_right])[asked][answered] - _pixels(case, truth)
        efficiency, more = _measured(case, truth, found, error_px, gain, seen_px)
    return Judgement((*checks, *more), depth_rms_m, predicted_m, efficiency)


def exact_tolerance_m(rig: StereoRig, points_left: Array, gain: Array) -> Array:
    """Error (N,) m that exact pixels allow at points (N, 3), given their `pixel_gain` (N, 3, 4)."""
    width = max(rig.left.width, rig.right.width, rig.left.height, rig.right.height)
    rounding = _ROUNDING * width * np.linalg.norm(gain, axis=(1, 2))
    return np.asarray(EXACT_M * np.maximum(1.0, np.linalg.norm(points_left, axis=1)) + rounding)


def _pixels(case: Case, points_left: Array) -> Array:
    """(N, 4) px: u_left, v_left, u_right, v_right; NaN behind a camera."""
    return np.hstack(case.rig.project(points_left))


def _nowhere(case: Case, found_left: Array, rows: Mask) -> Check:
    """Rows without an answer: a point that is not behind a camera is made up, be it (0, 0, 0).

    Where a pixel is missing, any point is.
    """
    found_left = found_left[rows]
    right = case.rig.right_from_left.apply(found_left)
    given = np.isfinite(np.hstack([case.uv_left, case.uv_right])[rows]).all(axis=1)
    finite = np.isfinite(found_left).all(axis=1)
    made_up = finite & given & (found_left[:, 2] >= 0) & (right[:, 2] >= 0)
    made_up[made_up] = ~(parallax_px(case.rig, found_left[made_up]) <= AT_INFINITY_PX)
    made_up |= finite & ~given
    return Check(
        "nowhere",
        float(made_up.sum()),
        0.0,
        0.0,
        "rows",
        saying("nowhere"),
    )


def _answered(case: Case, truth: Array, found: Array, answered: Mask, false_alarm: float) -> Check:
    """Rows with an answer that came back as none, against how many the noise pushes behind a camera."""
    high = 0.0
    lost = found[~answered]
    lost = lost[np.isfinite(lost).all(axis=1)]
    n_behind = int(((lost[:, 2] <= 0) | (case.rig.right_from_left.apply(lost)[:, 2] <= 0)).sum())
    why = saying("answered")
    if case.kind == "noisy" and case.covariance_px2 is not None:
        sigma_px = math.sqrt(float(np.ravel(case.covariance_px2)[0]))
        expected = float(stats.norm.sf(depth_reach(case.rig, truth, sigma_px)).sum())
        high = float(stats.poisson.isf(false_alarm, FIRST_ORDER * expected)) if expected > 0 else 0.0
        why = saying("answered: noisy", expected=expected)
    return Check("answered", float((~answered).sum()), 0.0, high, "rows", why, n_behind=n_behind)


def _exact(case: Case, truth: Array, found: Array, gain: Array) -> Check:
    """The worst row, against 1e-9 and what rounding the pixels to double precision costs there."""
    error = np.linalg.norm(found - truth, axis=1)
    allowed = exact_tolerance_m(case.rig, truth, gain)
    worst = int(np.argmax(error / allowed))
    return Check(
        "exact",
        float(error[worst]),
        0.0,
        float(allowed[worst]),
        "m",
        saying("exact", rows=len(truth)),
    )


def _noisy(
    case: Case,
    truth: Array,
    found: Array,
    error_px: Array,
    gain: Array,
    sigma_px: float,
    false_alarm: float,
) -> tuple[float, list[Check]]:
    """Chi squared of the pixel error, of its mean, and of the depth alone."""
    n = len(truth)
    nees = float((error_px**2).sum(axis=1).mean()) / sigma_px**2 / 3
    low, high = (float(stats.chi2.ppf(p, 3 * n)) / (3 * n) for p in (false_alarm / 2, 1 - false_alarm / 2))
    low *= bound(case.rig, truth, sigma_px).squares  # rows that noise loses are those with large errors
    worst = WORST_EFFICIENCY
    return math.sqrt(nees), [
        Check(
            "size",
            math.sqrt(nees),
            math.sqrt(low),
            worst * math.sqrt(high),
            "",
            saying("size", rows=n, worst=worst),
        ),
        _noisy_depth(truth, found, sigma_px * np.linalg.norm(gain[:, 2], axis=1), false_alarm),
        _unbiased(case, truth, error_px, sigma_px, false_alarm),
        Check(
            "efficient",
            math.sqrt(nees),
            0.0,
            math.sqrt(high),
            "",
            saying("efficient"),
            only_strict=True,
        ),
    ]


def _noisy_depth(truth: Array, found: Array, depth_std_m: Array, false_alarm: float) -> Check:
    n, worst = len(truth), WORST_EFFICIENCY
    # 1/Z follows the disparity in a straight line, so its errors are Gaussian at any distance
    inverse_depth = (1 / found[:, 2] - 1 / truth[:, 2]) * truth[:, 2] ** 2 / depth_std_m
    return Check(
        "depth",
        math.sqrt(float((inverse_depth**2).mean())),
        0.0,
        worst * math.sqrt(float(stats.chi2.isf(false_alarm, n)) / n),
        "",
        saying("depth", worst=worst),
    )


def _unbiased(case: Case, truth: Array, error_px: Array, sigma_px: float, false_alarm: float) -> Check:
    n = len(truth)
    whitened = _whitened(case, truth, error_px) / sigma_px
    # beyond what chance allows, a triangulator may lean by its second order, sigma_d / d
    second_order = float(np.mean(np.minimum(1 / depth_reach(case.rig, truth, sigma_px), 1.0)))
    return Check(
        "unbiased",
        float(np.linalg.norm(whitened.mean(axis=0))),
        0.0,
        math.sqrt(float(stats.chi2.isf(false_alarm, 3)) / n) + second_order,
        "sigma",
        saying("unbiased", rows=n),
    )


def _measured(
    case: Case, truth: Array, found: Array, error_px: Array, gain: Array, seen_px: Array
) -> tuple[float, list[Check]]:
    """Errors against what these very pixel errors must become: nothing here is random."""
    due_m = np.einsum("nij,nj->ni", gain, seen_px)
    due_px = np.einsum("nij,nj->ni", case.rig.jacobian(truth), due_m)
    size = rms(error_px) / rms(due_px)
    inverse_depth = (1 / found[:, 2] - 1 / truth[:, 2]) * truth[:, 2] ** 2
    depth = rms(inverse_depth) / rms(due_m[:, 2])
    worst = WORST_EFFICIENCY
    return size, [
        Check("size", size, 1 / worst, worst, "", saying("size: measured", worst=worst)),
        Check("depth", depth, 1 / worst, worst, "", saying("depth: measured", worst=worst)),
    ]


def _whitened(case: Case, truth: Array, error_px: Array) -> Array:
    """(N, 3) errors along the left camera's axes, each of unit variance for one pixel of noise.

    ``M^-1/2 J^T e`` with M = J^T J: the symmetric root keeps the axes of the camera.
    """
    J = case.rig.jacobian(truth)
    values, vectors = np.linalg.eigh(J.transpose(0, 2, 1) @ J)
    along = np.einsum("nji,nj->ni", vectors, np.einsum("nji,nj->ni", J, error_px)) / np.sqrt(values)
    return np.asarray(np.einsum("nij,nj->ni", vectors, along))
