"""What many calibrations say, beside what the covariance predicts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from rigsim.rig.arrays import Array
from rigsim.study.calibrate.witness.bench import CalibrationBench, CalibrationErrors
from rigsim.study.calibrate.witness.judge import JudgedErrors, Slack, judge
from rigsim.study.calibrate.witness.result import CalibrationWitness, WitnessedDepth
from rigsim.theory.calibration.covariance import CalibrationCovariance

_TAIL = 0.025
_LEAST_EIGENVALUE = 1e-11
"""Of a correlation matrix: below, what it is of is held."""
_NO_INTERVAL = (0.0, math.inf)


@dataclass(frozen=True, slots=True, eq=False)
class Calibrated:
    """One calibration that settled."""

    errors: CalibrationErrors
    """How far off it is."""
    rms_px: float
    """Root mean square residual of one coordinate, px."""
    residuals: int
    """How many coordinates there were."""


@dataclass(frozen=True, slots=True)
class Met:
    """Who speaks, of how many calibrations, at which noise."""

    name: str
    """``simulated`` or ``measured``."""
    tried: int
    """Calibrations."""
    noise_px: float
    """Standard deviation of one coordinate of a corner, px."""
    slack: Slack
    """What is excused."""


def conclude(
    met: Met, done: Sequence[Calibrated], bench: CalibrationBench, predicted: CalibrationCovariance
) -> CalibrationWitness:
    """What one witness says.

    Args:
        met: Who speaks.
        done: The calibrations that settled.
        bench: What was calibrated.
        predicted: The covariance at the noise that was met.
    """
    predicted_m = predicted.depth_std(bench.points)
    count, p = len(done), len(predicted.names)
    depth_m = np.array([one.errors.depth_m for one in done]).reshape(count, len(predicted_m))
    spread = _parameter_squares(
        np.array([one.errors.parameters for one in done]).reshape(count, p), predicted
    )
    misfit, degrees = _misfit(met, done, bench)
    found = JudgedErrors(
        tried=met.tried,
        depth_z=depth_m / np.where(predicted_m > 0, predicted_m, math.nan),
        parameter_square=float(spread.sum()) if bench.in_model else math.nan,
        parameter_degrees=spread.size,
        misfit=misfit,
        # what boards are not flat by is no noise, and is there to be seen
        misfit_degrees=0 if bench.warps and not bench.parameters.warped else degrees,
    )
    ratio = math.sqrt(found.parameter_square / spread.size) if spread.size and bench.in_model else math.nan
    return CalibrationWitness(
        name=met.name,
        calibrations=met.tried,
        failed=met.tried - count,
        corner_noise_px=met.noise_px,
        rms_px=float(np.median([one.rms_px for one in done])) if done else math.nan,
        misfit=misfit,
        depths=tuple(_depth(z_m, float(predicted_m[k]), depth_m[:, k]) for k, z_m in enumerate(bench.at_m)),
        parameter_ratio=ratio,
        parameter_interval=_interval(ratio, spread.size) if bench.in_model else (math.nan, math.nan),
        agreement=judge(met.name, found, met.slack),
    )


def _depth(z_m: float, predicted_m: float, errors_m: Array) -> WitnessedDepth:
    count = len(errors_m)
    std_m = float(errors_m.std(ddof=1)) if count > 1 else math.nan
    ratio = std_m / predicted_m if predicted_m > 0 else math.nan
    mean_m = float(errors_m.mean()) if count else math.nan
    return WitnessedDepth(z_m, predicted_m, std_m, mean_m, _interval(ratio, count - 1))


def _interval(ratio: float, degrees: int) -> tuple[float, float]:
    """95 % of the true ratio of standard deviations, of which `ratio` was found with so many degrees."""
    if degrees < 1 or math.isnan(ratio):
        return _NO_INTERVAL
    low, high = (float(chdtri(degrees, tail)) for tail in (_TAIL, 1 - _TAIL))
    return ratio * math.sqrt(degrees / low), ratio * math.sqrt(degrees / high)


def _parameter_squares(errors: Array, predicted: CalibrationCovariance) -> Array:
    """Squares (k, q) of the parameters' errors (k, p + 6), in standard deviations along the covariance's own
    axes: each is chi-squared of one degree."""
    free = predicted.std > 0
    values, vectors = np.linalg.eigh(predicted.correlation[np.ix_(free, free)])
    kept = values > _LEAST_EIGENVALUE
    whitened = (errors[:, free] / predicted.std[free]) @ vectors[:, kept] / np.sqrt(values[kept])
    return np.asarray(whitened**2)


def _misfit(met: Met, done: Sequence[Calibrated], bench: CalibrationBench) -> tuple[float, int]:
    """Residuals over what noise alone would leave, and the degrees of freedom of all calibrations."""
    poses = 6 * int(bench.seen.any(axis=1).sum())
    taken = bench.parameters.basis(bench.rig).shape[1] + poses
    degrees = sum(one.residuals - taken for one in done)
    square = sum(one.residuals * one.rms_px**2 for one in done)
    if degrees <= 0 or met.noise_px <= 0:
        return math.nan, 0
    return math.sqrt(square / degrees) / met.noise_px, degrees
