"""One rig, one noise level, one triangulator: many noisy repetitions beside their prediction.

The true rig projects; the assumed rig triangulates. With no perturbation they are the same object.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array, Ids, Mask
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.plan import Triangulator
from rigsim.study.statistics import ErrorStatistics
from rigsim.theory.triangulation import triangulate
from rigsim.theory.uncertainty import (
    LEAST_DEPTH_SIGMAS,
    depth_in_sigmas,
    predict_covariance,
    predict_depth_rmse,
)

_BLOCK = 1 << 16


@dataclass(frozen=True, slots=True, eq=False)
class Prediction:
    """What should happen to each point, (N,)."""

    depth_rmse_m: Array
    """Second-order prediction of the RMS depth error, m."""
    truncation_m: Array
    """First neglected term, m: how far the prediction itself may be off."""
    square_std_m2: Array
    """Standard deviation of the squared depth error, m^2: how far a simulation may scatter."""
    whitening: Array
    """(6, N), 1/m; see `ErrorStatistics.add`."""
    low_disparity: Mask
    """Whether the depth is below `LEAST_DEPTH_SIGMAS` of its own standard deviations."""


def predict(rig: StereoRig, points_left: Array, noise: PixelNoise) -> Prediction:
    """Predict the errors of points (N, 3) m seen through `noise`.

    With ``a = var(Z) / Z^2``, the fourth moment of ``1 / (1 + x) - 1`` for Gaussian x of variance a is
    ``3 a^2 (1 + 50 a + 1225 a^2 + ...)``.
    """
    rmse_m, truncation_m = predict_depth_rmse(rig, points_left, noise)
    covariance_m2 = predict_covariance(rig, points_left, noise)
    variance_m2 = covariance_m2[:, 2, 2]
    a = variance_m2 / points_left[:, 2] ** 2
    return Prediction(
        depth_rmse_m=rmse_m,
        truncation_m=truncation_m,
        square_std_m2=variance_m2 * np.sqrt(3 * (1 + 50 * a + 1225 * a * a) - 1),
        whitening=_whitening(covariance_m2),
        low_disparity=depth_in_sigmas(rig, points_left, noise) < LEAST_DEPTH_SIGMAS,
    )


def run_trials(
    true_rig: StereoRig,
    assumed_rig: StereoRig,
    points_left: Array,
    noise: PixelNoise,
    triangulators: Mapping[str, Triangulator],
    whitening: Array,
    groups: Ids,
    n_trials: int,
    rng: np.random.Generator,
) -> dict[str, ErrorStatistics]:
    """Project, add noise, triangulate and compare, `n_trials` times for each point (N, 3) m.

    Every triangulator gets the same noisy pixels. `groups` (N,) sorts the points for the histogram.
    Memory stays bounded whatever `n_trials` is.
    """
    n = len(points_left)
    n_groups = int(groups.max(initial=-1)) + 1
    result = {label: ErrorStatistics(n, groups, n_groups) for label in triangulators}
    uv_left, uv_right = true_rig.project(points_left)
    for size in _blocks(n_trials, n):
        noisy_left, noisy_right = noise.apply(
            np.broadcast_to(uv_left, (size, n, 2)), np.broadcast_to(uv_right, (size, n, 2)), rng
        )
        flat_left, flat_right = noisy_left.reshape(-1, 2), noisy_right.reshape(-1, 2)
        for label, method in triangulators.items():
            found_left = triangulate(assumed_rig, flat_left, flat_right, method)
            result[label].add(found_left.reshape(size, n, 3) - points_left, whitening)
    return result


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
