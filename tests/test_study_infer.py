"""Disparity noise from depth errors: worked examples backwards, coverage, laws, bias, another rig."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.errors import InvalidRange
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.infer import (
    DepthErrors,
    depth_gain,
    disparity_of_bounds,
    infer_disparity_noise,
    transfer,
)
from rigsim.study.infer_bias import bias_part
from rigsim.theory.triangulation import triangulate

REPETITIONS = 200
RIG = StereoRig.rectified(Intrinsics.from_focal(1280, 720, 900.0), 0.12)
W7 = StereoRig.rectified(Intrinsics.from_focal(1000, 800, 500.0), 0.1)
W8 = StereoRig.rectified(Intrinsics.from_hfov(1280, 720, 90.0), 0.1)


def depths(*metres: float) -> np.ndarray:
    return np.array(metres, dtype=float)


def test_w7_backwards() -> None:
    # changh95, visual-slam-roadmap: f 500, B 0.1 m; 0.02, 0.5 and 2 m at 2, 10 and 20 m come of 0.25 px
    found = infer_disparity_noise(W7, DepthErrors(depths(2, 10, 20), depths(0.02, 0.5, 2.0)))
    assert found.disparity_std_px == pytest.approx(0.25, rel=1e-9)
    assert found.gains_m_per_px == pytest.approx([0.08, 2.0, 8.0], rel=1e-9)
    assert found.fit is not None
    assert found.fit.exponent == pytest.approx(2.0, abs=1e-9)
    assert found.verdict == "consistent"


def test_w8_backwards() -> None:
    # g-rousseau, pinhole-stereo-error: HFOV 90 deg, 1280 px, B 0.1 m; [8.10, 13.06] m at 10 m is +-1.5 px
    assert disparity_of_bounds(W8, 8.10, 13.06) == pytest.approx(1.5, abs=2e-3)
    # the exact bounds of 1.5 px by hand: 64 / (6.4 +- 1.5)
    assert disparity_of_bounds(W8, 64 / 7.9, 64 / 4.9) == pytest.approx(1.5, rel=1e-12)


def test_one_claim_by_hand() -> None:
    # 1 % of 4 m is 40 mm; K = 16 / (900 * 0.12) = 0.1481 m/px
    found = infer_disparity_noise(RIG, DepthErrors(depths(4), depths(0.04)))
    assert found.disparity_std_px == pytest.approx(0.04 * 108 / 16, rel=1e-9)
    assert math.isnan(found.low_px)
    assert (found.interval_from, found.verdict, found.fit) == ("none", "untested", None)


def simulated(rng: np.random.Generator, sigma_px: float, metres: np.ndarray, count: int) -> np.ndarray:
    """Sample std of depths of `count` triangulated noisy disparities at each of `metres`."""
    found = np.empty(len(metres))
    noise = PixelNoise(sigma_px / math.sqrt(2))
    for i, z in enumerate(metres):
        points = np.tile([0.0, 0.0, z], (count, 1))
        uv_left, uv_right = noise.apply(*RIG.project(points), rng)
        found[i] = triangulate(RIG, uv_left, uv_right)[:, 2].std(ddof=1)
    return found


@pytest.mark.parametrize("sigma_px", [0.05, 0.2])
def test_intervals_cover_what_was_put_in(sigma_px: float) -> None:
    # measured end to end: noisy pixels, triangulated, their std inferred back
    rng = np.random.default_rng(20)
    metres, count = depths(0.8, 1.2, 2.0, 2.8, 3.5, 4.0), 60
    by_samples = by_fit = 0
    for _ in range(REPETITIONS):
        stds = simulated(rng, sigma_px, metres, count)
        told = infer_disparity_noise(RIG, DepthErrors(metres, stds, counts=np.full(6, float(count))))
        untold = infer_disparity_noise(RIG, DepthErrors(metres, stds))
        by_samples += told.low_px <= sigma_px <= told.high_px
        by_fit += untold.low_px <= sigma_px <= untold.high_px
    assert 0.92 * REPETITIONS <= by_samples <= 0.98 * REPETITIONS
    assert 0.92 * REPETITIONS <= by_fit <= 0.98 * REPETITIONS


def test_stereo_noise_is_seldom_called_something_else() -> None:
    rng = np.random.default_rng(5)
    metres = depths(0.8, 1.2, 2.0, 2.8, 3.5, 4.0)
    wrong = 0
    for _ in range(REPETITIONS):
        stds = simulated(rng, 0.1, metres, 40)
        wrong += infer_disparity_noise(RIG, DepthErrors(metres, stds)).verdict == "inconsistent"
    assert wrong <= 0.08 * REPETITIONS


@pytest.mark.parametrize(("power", "law"), [(1.0, "linear"), (0.0, "constant")])
@pytest.mark.parametrize("counted", [False, True])
def test_other_laws_are_told(power: float, law: str, counted: bool) -> None:
    rng = np.random.default_rng(7)
    metres = depths(1, 1.5, 2, 3, 4, 6)
    stds = 0.01 * metres**power * np.exp(rng.normal(0, 0.05, 6))
    counts = np.full(6, 200.0) if counted else None
    found = infer_disparity_noise(RIG, DepthErrors(metres, stds, counts=counts))
    assert found.verdict == "inconsistent"
    assert found.fit is not None
    assert found.fit.best == law
    assert found.fit.exponent == pytest.approx(power, abs=0.1)
    assert found.fit.exponent_high < 2
    # scatter that the counts cannot explain widens the interval
    assert found.interval_from == "fit"


@given(
    sigma_px=st.floats(0.01, 2.0),
    baseline_m=st.floats(0.02, 1.0),
    focal_px=st.floats(200.0, 3000.0),
    factor=st.floats(1.1, 5.0),
)
def test_what_is_carried_over_is_inferred_back(
    sigma_px: float, baseline_m: float, focal_px: float, factor: float
) -> None:
    metres = 1.0 * factor ** np.arange(3)
    found = infer_disparity_noise(RIG, DepthErrors(metres, sigma_px * depth_gain(RIG, metres)))
    other = StereoRig.rectified(Intrinsics.from_focal(1280, 720, focal_px), baseline_m)
    carried = transfer(found, other, metres)
    assert carried.stds_m == pytest.approx(metres**2 / (focal_px * baseline_m) * sigma_px, rel=1e-6)
    back = infer_disparity_noise(other, DepthErrors(metres, carried.stds_m))
    assert back.disparity_std_px == pytest.approx(sigma_px, rel=1e-6)
    assert carried.trusted.tolist() == (focal_px * baseline_m / metres >= 4 * sigma_px).tolist()


def test_verged_rigs_follow_their_own_law() -> None:
    verged = StereoRig.verged(Intrinsics.from_focal(1280, 720, 900.0), 0.12, 10.0)
    metres = depths(0.5, 1.0, 2.0)
    stds = 0.3 * depth_gain(verged, metres)
    assert infer_disparity_noise(verged, DepthErrors(metres, stds)).disparity_std_px == pytest.approx(0.3)
    assert depth_gain(verged, metres) != pytest.approx(depth_gain(RIG, metres), rel=1e-3)


def test_bias_is_kept_apart_and_taken_to_pieces() -> None:
    metres = depths(1, 2, 3, 4)
    stds = 0.1 * depth_gain(RIG, metres)
    # the disparity measured 0.2 px too large puts points nearer; the baseline assumed 0.5 % too long farther
    biases = 108 / (108 / metres + 0.2) * 1.005 - metres
    found = infer_disparity_noise(RIG, DepthErrors(metres, stds, biases))
    assert found.disparity_std_px == pytest.approx(0.1, rel=1e-9)
    assert found.bias is not None
    assert found.bias.disparity_offset_px == pytest.approx(0.2, rel=0.02)
    assert found.bias.scale == pytest.approx(0.005, rel=0.02)
    assert found.bias.left_rms_m < 2e-4
    shares = (biases / metres) ** 2
    assert found.bias.share == pytest.approx(shares.sum() / (shares + (stds / metres) ** 2).sum(), rel=1e-12)


def test_two_distances_give_an_offset_alone() -> None:
    found = infer_disparity_noise(
        RIG, DepthErrors(depths(1, 2), depths(0.001, 0.004), -0.1 * depth_gain(RIG, depths(1, 2)))
    )
    assert found.bias is not None
    assert found.bias.disparity_offset_px == pytest.approx(0.1, rel=1e-9)
    assert math.isnan(found.bias.scale)


def test_equal_distances_leave_the_law_untested() -> None:
    found = infer_disparity_noise(RIG, DepthErrors(depths(2, 2, 2), depths(0.01, 0.011, 0.012)))
    assert found.verdict == "untested"
    assert found.low_px < found.disparity_std_px < found.high_px


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: DepthErrors(depths(), depths()), "no depth errors"),
        (lambda: DepthErrors(depths(-1), depths(1)), "distance -1000 mm: must be > 0"),
        (lambda: DepthErrors(depths(1), depths(-0.01)), "depth std -10 mm: must be > 0"),
        (lambda: DepthErrors(depths(1), depths(0.1), depths(math.nan)), "depth bias"),
        (lambda: DepthErrors(depths(1), depths(0.1), counts=depths(1)), "n 1: a standard deviation needs"),
        (lambda: depth_gain(StereoRig.verged(W7.left, 0.1, 170.0), depths(0.001, 5)), "no depth there"),
    ],
)
def test_impossible_errors_are_named(make, says: str) -> None:
    with pytest.raises(InvalidRange, match=says):
        make()


def test_standard_errors_of_the_bias_by_hand() -> None:
    # one distance, 100 measurements of std 20 mm: the mean is sure to 2 mm, 0.02 m/px make it 0.1 px
    found = bias_part(np.array([2.0]), np.array([0.02]), np.array([100]), np.array([0.02]), np.array([0.01]))
    assert found.disparity_offset_px == pytest.approx(-0.5)
    assert found.disparity_offset_se_px == pytest.approx(0.1)
    assert math.isnan(found.scale_se)
    # without a count nothing is left over to tell it by
    alone = bias_part(np.array([2.0]), np.array([0.02]), None, np.array([0.02]), np.array([0.01]))
    assert math.isnan(alone.disparity_offset_se_px)


@pytest.mark.parametrize("counted", [True, False])
def test_standard_errors_of_the_bias_are_the_scatter_of_its_estimates(counted: bool) -> None:
    rng = np.random.default_rng(4)
    depths = np.array([0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0])
    gains = depths**2 / 100
    stds = 0.2 * gains
    counts = np.full(len(depths), 50)
    found = [
        bias_part(
            depths,
            stds,
            counts if counted else None,
            gains,
            0.1 * gains + 0.003 * depths + stds / math.sqrt(50) * rng.standard_normal(len(depths)),
        )
        for _ in range(2000)
    ]
    for value, error in (("disparity_offset_px", "disparity_offset_se_px"), ("scale", "scale_se")):
        scatter = np.std([getattr(item, value) for item in found])
        claimed = math.sqrt(np.mean([getattr(item, error) ** 2 for item in found]))
        # with counts the larger of two is taken, which is a little more on average
        assert 0.95 < claimed / scatter < (1.2 if counted else 1.05)
