"""One rig, one noise level, one triangulator: many noisy repetitions beside their prediction.

The true rig projects; the assumed rig triangulates. With no perturbation they are the same object.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rigsim.errors import TriangulatorError
from rigsim.rig.arrays import Array, Ids, Mask
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.agreement.views import expand_views, predict_views, rays_ahead, views
from rigsim.study.calibrate.drawn import calibrated_views
from rigsim.study.scene.plan import Triangulator
from rigsim.study.scene.statistics import NEAREST_TO_INFINITY, ErrorStatistics
from rigsim.study.triangulators.registry import falls_short
from rigsim.theory.blocks import blocks
from rigsim.theory.calibration.covariance import CalibrationCovariance
from rigsim.theory.triangulation import triangulate
from rigsim.theory.uncertainty import (
    LEAST_DEPTH_SIGMAS,
    depth_in_sigmas,
    predict_covariance,
)

_BLOCK = 1 << 16
_NODES = 40
_WIDEST = 9.0  # standard deviations: nothing of double precision lies beyond
_ROWS = 8192


@dataclass(frozen=True, slots=True, eq=False)
class Prediction:
    """What should happen to each point, (N,)."""

    method: Triangulator
    """Who triangulates."""
    depth_rmse_m: Array
    """RMS depth error, m, of the trials that are not at infinity; see `ErrorStatistics.add`."""
    view_bias: Array
    """Mean error of (1/Z, X/Z, Y/Z), (N, 3), to second order; see `rigsim.study.agreement.views`."""
    view_covariance: Array
    """Covariance of that error in one trial, (N, 3, 3)."""
    whitening: Array
    """(6, N); see `ErrorStatistics.add`. Without noise: for noise of one pixel."""
    depth_sigmas: Array
    """Depth over its own standard deviation; of a wide lens, distance."""
    rounding: float
    """Share of the noise variance that is rounding and repeats in every trial, 0 to 1."""
    low_disparity: Mask
    """Whether the depth is below `LEAST_DEPTH_SIGMAS` of its own standard deviations."""
    shares_calibration: bool = False
    """Whether all points of one trial share the error of one calibration: points are then not independent."""


def predict(
    rig: StereoRig,
    points_left: Array,
    noise: PixelNoise,
    method: Triangulator = "optimal",
    calibration: CalibrationCovariance | None = None,
) -> Prediction:
    """Predict the errors of points (N, 3) m seen through `noise`.

    Every triangulator is held to the maximum-likelihood one, but those of textbooks that are known to
    fall short of it (`rigsim.theory.custom.Method.falls_short`): bias and covariance of their error are their
    own. With a `calibration` every trial is triangulated with another one, and what it leaves adds.
    """
    axes = rays_ahead(rig, points_left)
    sigmas, depth_rmse_m = _depths(rig, points_left, noise, axes)
    variance_px2 = noise.coordinate_var_px2
    if falls_short(method) and variance_px2 > 0:
        view_bias, view_covariance = expand_views(rig, points_left, noise, method, axes)
    else:
        view_bias, view_covariance = predict_views(rig, points_left, noise, axes)
    if calibration is not None:
        more, own = calibrated_views(calibration, rig, points_left, axes)
        view_covariance = view_covariance + more
        sigmas, depth_rmse_m = _with_calibration(points_left, (sigmas, depth_rmse_m), own, axes)
    yardstick = view_covariance
    if variance_px2 == 0 and calibration is None:
        _, yardstick = predict_views(rig, points_left, PixelNoise(1.0), axes)
    return Prediction(
        method=method,
        depth_rmse_m=depth_rmse_m,
        view_bias=view_bias,
        view_covariance=view_covariance,
        whitening=_whitening(yardstick),
        depth_sigmas=sigmas,
        rounding=noise.quantization_px**2 / 12 / variance_px2 if variance_px2 else 0.0,
        low_disparity=sigmas < LEAST_DEPTH_SIGMAS,
        shares_calibration=calibration is not None,
    )


def _with_calibration(
    points_left: Array, by_noise: tuple[Array, Array], own: Array, axes: Array | None
) -> tuple[Array, Array]:
    """What `_depths` says `by_noise` alone, with the covariance (N, 3, 3) m^2 that a calibration adds."""
    sigmas, depth_rmse_m = by_noise
    along = np.broadcast_to(np.eye(3)[2], points_left.shape) if axes is None else axes[:, 2]
    far_m = points_left[:, 2] if axes is None else np.linalg.norm(points_left, axis=1)
    more_m2 = np.einsum("ni,nij,nj->n", along, own, along)
    with np.errstate(divide="ignore", invalid="ignore"):
        both = far_m / np.sqrt((far_m / sigmas) ** 2 + more_m2)
    if axes is None:
        return both, _depth_rmse_m(far_m, both)
    return both, np.sqrt(depth_rmse_m**2 + own[:, 2, 2])


def _depths(rig: StereoRig, points_left: Array, noise: PixelNoise, axes: Array | None) -> tuple[Array, Array]:
    """Depth over its standard deviation, and RMS depth error, m, (N,) each.

    With `axes` of the points' own, their distance over its standard deviation; of the depth error, what lies
    along the ray is a distance's.
    """
    if axes is None:
        sigmas = depth_in_sigmas(rig, points_left, noise)
        return sigmas, _depth_rmse_m(points_left[:, 2], sigmas)
    covariance = predict_covariance(rig, points_left, noise)
    ray = axes[:, 2]
    distance_m = np.linalg.norm(points_left, axis=1)
    variance_m2 = np.einsum("ni,nij,nj->n", ray, covariance, ray)
    with np.errstate(divide="ignore"):
        sigmas = distance_m / np.sqrt(variance_m2)
    more_m2 = _depth_rmse_m(distance_m, sigmas) ** 2 - variance_m2
    return sigmas, np.sqrt(np.maximum(covariance[:, 2, 2] + ray[:, 2] ** 2 * more_m2, 0.0))


def _depth_rmse_m(depth_m: Array, sigmas: Array) -> Array:
    """RMS depth error (N,) m when ``1/Z`` is Gaussian, over the trials that are not at infinity.

    With s = Z / sigma_Z and a standard Gaussian g, ``Z' = Z / (1 + g / s)``, kept where ``s + g >= 1``:
    the mean square by Gauss-Legendre quadrature. To second order ``sigma_Z^2 (1 + 9 / s^2)``.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    rmse_m = np.zeros(len(depth_m))
    for block in blocks(len(depth_m), _ROWS):
        s = sigmas[block, None]
        low = np.clip(NEAREST_TO_INFINITY - s, -_WIDEST, _WIDEST - 1)
        g = low + (_WIDEST - low) / 2 * (1 + nodes)
        mass = weights * np.exp(-(g**2) / 2)
        mean_square = (mass * (g / (1 + g / s)) ** 2).sum(axis=1) / mass.sum(axis=1)
        rmse_m[block] = depth_m[block] / sigmas[block] * np.sqrt(mean_square)
    return rmse_m


def run_trials(
    rigs: tuple[StereoRig, StereoRig | Sequence[StereoRig]],
    points_left: Array,
    noise: PixelNoise,
    predictions: Mapping[str, Prediction],
    groups: Ids,
    n_trials: int,
    rng: np.random.Generator,
) -> dict[str, ErrorStatistics | TriangulatorError]:
    """Project, add noise, triangulate and compare, `n_trials` times for each point (N, 3) m.

    Every triangulator, by its label, gets the same noisy pixels, and is held to its prediction.
    Memory stays bounded whatever `n_trials` is.

    Args:
        rigs: the true one and the assumed one, or one for every trial.
        points_left: the points.
        noise: of the pixels.
        predictions: of each triangulator, by its label.
        groups: sort the points for the histogram, (N,).
        n_trials: how often.
        rng: random numbers.

    Returns:
        By the label, the statistics, or the error of a triangulator that broke: it is not asked again.
    """
    n = len(points_left)
    n_groups = int(groups.max(initial=-1)) + 1
    result = {
        label: ErrorStatistics(n, groups, n_groups, shared=predicted.shares_calibration)
        for label, predicted in predictions.items()
    }
    broken: dict[str, TriangulatorError] = {}
    true_rig, assumed = rigs
    done = 0
    uv_left, uv_right = true_rig.project(points_left)
    axes = rays_ahead(true_rig, points_left)
    true_views = views(points_left, axes)
    for size in _blocks(n_trials, n):
        noisy_left, noisy_right = noise.apply(
            np.broadcast_to(uv_left, (size, n, 2)), np.broadcast_to(uv_right, (size, n, 2)), rng
        )
        flat_left, flat_right = noisy_left.reshape(-1, 2), noisy_right.reshape(-1, 2)
        for label, predicted in predictions.items():
            if label in broken:
                continue
            try:
                if isinstance(assumed, StereoRig):
                    found_left = triangulate(assumed, flat_left, flat_right, predicted.method)
                else:
                    own = zip(assumed[done : done + size], noisy_left, noisy_right, strict=True)
                    found_left = np.stack([triangulate(*one, predicted.method) for one in own])
            except TriangulatorError as error:
                broken[label] = error
                continue
            found_left = found_left.reshape(size, n, 3)
            with np.errstate(all="ignore"):
                error_view = views(found_left, axes) - true_views
            result[label].add(
                found_left - points_left, error_view, predicted.whitening, predicted.depth_sigmas
            )
        done += size
    return result | broken


def _blocks(n_trials: int, n_points: int) -> Iterator[int]:
    """Trials in a block: as many as fit the cache, the same in every run."""
    size = max(1, _BLOCK // max(n_points, 1))
    for start in range(0, n_trials, size):
        yield min(size, n_trials - start)


def _whitening(covariance_m2: Array) -> Array:
    """Lower triangle (6, N) of the inverse Cholesky factor of each (3, 3); NaN where there is none."""
    s00, s10, s11, s20, s21, s22 = (
        covariance_m2[:, i, j] for i, j in ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2))
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        l00 = np.sqrt(s00)
        l10, l20 = s10 / l00, s20 / l00
        l11 = np.sqrt(s11 - l10 * l10)
        l21 = (s21 - l20 * l10) / l11
        l22 = np.sqrt(s22 - l20 * l20 - l21 * l21)
        w00, w11, w22 = 1 / l00, 1 / l11, 1 / l22
        w10 = -l10 * w00 * w11
        w21 = -l21 * w11 * w22
        w20 = -(l20 * w00 + l21 * w10) * w22
    whitening = np.stack([w00, w10, w11, w20, w21, w22])
    whitening[~np.isfinite(whitening)] = np.nan
    return whitening
