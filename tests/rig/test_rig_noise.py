"""Pixel noise has the statistics it states."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rigsim.errors import InvalidNoise
from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from tests.helpers.sampling import close

COUNT = 200_000
# four standard errors of a variance from COUNT samples, relative
VARIANCE_RTOL = 4 * math.sqrt(2 / COUNT)


def errors(noise: PixelNoise, seed: int = 3) -> Array:
    """Noise (COUNT, 4) px on positions spread evenly between pixels."""
    rng = np.random.default_rng(seed)
    uv_left, uv_right = rng.uniform(0, 1000, (2, COUNT, 2))
    noisy_left, noisy_right = noise.apply(uv_left, uv_right, rng)
    return np.hstack([noisy_left - uv_left, noisy_right - uv_right])


@pytest.mark.parametrize(
    "noise",
    [
        PixelNoise(0.3),
        PixelNoise(0.3, correlation=0.6),
        PixelNoise(0.3, correlation=-1.0),
        PixelNoise(0.0, quantization_px=1.0),
        PixelNoise(0.2, correlation=0.5, quantization_px=0.25),
    ],
)
def test_samples_have_the_stated_covariance(noise: PixelNoise) -> None:
    e = errors(noise)
    variance = noise.coordinate_var_px2
    close(e.mean(axis=0), np.zeros(4), atol=5 * math.sqrt(variance / COUNT))
    close(np.cov(e.T), noise.covariance_px2, atol=1.5 * VARIANCE_RTOL * variance)
    disparity = e[:, 0] - e[:, 2]
    close(disparity.var(), noise.disparity_std_px**2, rtol=VARIANCE_RTOL, atol=1e-20)


def test_figures_by_hand() -> None:
    close(PixelNoise(0.25).disparity_std_px, 0.25 * math.sqrt(2))
    # rounding both positions to whole pixels: 1/sqrt(6) of disparity
    close(PixelNoise(0.0, quantization_px=1.0).disparity_std_px, 1 / math.sqrt(6))
    # correlated noise cancels in the disparity: 2 sigma^2 (1 - rho)
    close(PixelNoise(0.5, correlation=0.75).disparity_std_px, math.sqrt(2 * 0.25 * 0.25))
    close(
        PixelNoise(2.0, correlation=0.5).covariance_px2,
        [[4, 0, 2, 0], [0, 4, 0, 2], [2, 0, 4, 0], [0, 2, 0, 4]],
    )


def test_rounding_two_positions_by_hand() -> None:
    # a triangular error: mean |e_d| = 1/3
    e = errors(PixelNoise(0.0, quantization_px=1.0))
    assert np.abs(e).max() <= 0.5 + 1e-9
    close(np.abs(e[:, 0] - e[:, 2]).mean(), 1 / 3, rtol=0.01)
    rounded, _ = PixelNoise(0.0, quantization_px=0.5).apply(
        np.array([[10.2, 10.3]]), np.zeros((1, 2)), np.random.default_rng(0)
    )
    close(rounded, [[10.0, 10.5]])


def test_outliers_hit_the_right_image_alone() -> None:
    e = errors(PixelNoise(0.0, outlier_fraction=0.1, outlier_px=5.0))
    assert (e[:, :2] == 0).all()
    hit = (e[:, 2:] != 0).any(axis=1)
    close(hit.mean(), 0.1, atol=4 * math.sqrt(0.09 / COUNT))
    close(np.abs(e[hit, 2:]).max(), 5.0, rtol=1e-3)


def test_no_noise_changes_nothing_and_a_seed_repeats() -> None:
    uv = np.arange(8.0).reshape(4, 2)
    still = PixelNoise(0.0).apply(uv, uv + 1, np.random.default_rng(0))
    close(still[0], uv, rtol=0)
    close(still[1], uv + 1, rtol=0)
    one, other = (PixelNoise(0.3).apply(uv, uv, np.random.default_rng(5)) for _ in range(2))
    close(one[0], other[0], rtol=0)
    assert np.abs(one[0] - one[1]).min() > 0


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: PixelNoise(-0.1), "noise -0.1 px: must be >= 0"),
        (lambda: PixelNoise(math.nan), "noise nan px: must be >= 0"),
        (lambda: PixelNoise(0.1, quantization_px=-1), "quantisation -1 px: must be >= 0"),
        (lambda: PixelNoise(0.1, correlation=1.5), "correlation 1.5: must be between -1 and 1"),
        (lambda: PixelNoise(0.1, outlier_fraction=2), "outlier fraction 2: must be between 0 and 1"),
        (lambda: PixelNoise(0.1, outlier_px=math.inf), "outlier size inf px: must be >= 0 and finite"),
    ],
)
def test_impossible_noise_is_named(make, says: str) -> None:
    with pytest.raises(InvalidNoise, match=says):
        make()
