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
from rigsim.study.infer.random_effects import random_effects
from rigsim.study.infer.run import (
    ErrorsByDistance,
    depth_gain,
    disparity_of_bounds,
    infer_disparity_noise,
    transfer,
)
from rigsim.theory.triangulation import triangulate

REPETITIONS = 200
RIG = StereoRig.rectified(Intrinsics.from_focal(1280, 720, 900.0), 0.12)
W7 = StereoRig.rectified(Intrinsics.from_focal(1000, 800, 500.0), 0.1)
W8 = StereoRig.rectified(Intrinsics.from_hfov(1280, 720, 90.0), 0.1)


def depths(*metres: float) -> np.ndarray:
    return np.array(metres, dtype=float)


def test_w7_backwards() -> None:
    # changh95, visual-slam-roadmap: f 500, B 0.1 m; 0.02, 0.5 and 2 m at 2, 10 and 20 m come of 0.25 px
    found = infer_disparity_noise(W7, ErrorsByDistance(depths(2, 10, 20), depths(0.02, 0.5, 2.0)))
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
    found = infer_disparity_noise(RIG, ErrorsByDistance(depths(4), depths(0.04)))
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
        told = infer_disparity_noise(RIG, ErrorsByDistance(metres, stds, counts=np.full(6, float(count))))
        untold = infer_disparity_noise(RIG, ErrorsByDistance(metres, stds))
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
        wrong += infer_disparity_noise(RIG, ErrorsByDistance(metres, stds)).verdict == "inconsistent"
    assert wrong <= 0.08 * REPETITIONS


@pytest.mark.parametrize(("power", "law"), [(1.0, "linear"), (0.0, "constant")])
@pytest.mark.parametrize("counted", [False, True])
def test_other_laws_are_told(power: float, law: str, counted: bool) -> None:
    rng = np.random.default_rng(7)
    metres = depths(1, 1.5, 2, 3, 4, 6)
    stds = 0.01 * metres**power * np.exp(rng.normal(0, 0.05, 6))
    counts = np.full(6, 200.0) if counted else None
    found = infer_disparity_noise(RIG, ErrorsByDistance(metres, stds, counts=counts))
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
    found = infer_disparity_noise(RIG, ErrorsByDistance(metres, sigma_px * depth_gain(RIG, metres)))
    other = StereoRig.rectified(Intrinsics.from_focal(1280, 720, focal_px), baseline_m)
    carried = transfer(found, other, metres)
    assert carried.stds_m == pytest.approx(metres**2 / (focal_px * baseline_m) * sigma_px, rel=1e-6)
    back = infer_disparity_noise(other, ErrorsByDistance(metres, carried.stds_m))
    assert back.disparity_std_px == pytest.approx(sigma_px, rel=1e-6)
    assert carried.trusted.tolist() == (focal_px * baseline_m / metres >= 4 * sigma_px).tolist()


def test_verged_rigs_follow_their_own_law() -> None:
    verged = StereoRig.verged(Intrinsics.from_focal(1280, 720, 900.0), 0.12, 10.0)
    metres = depths(0.5, 1.0, 2.0)
    stds = 0.3 * depth_gain(verged, metres)
    assert infer_disparity_noise(verged, ErrorsByDistance(metres, stds)).disparity_std_px == pytest.approx(
        0.3
    )
    assert depth_gain(verged, metres) != pytest.approx(depth_gain(RIG, metres), rel=1e-3)


def test_bias_is_kept_apart_and_taken_to_pieces() -> None:
    metres = depths(1, 2, 3, 4)
    # the disparity measured 0.2 px too large puts points nearer; the baseline assumed 0.5 % too long farther
    measured = 108 / (108 / metres + 0.2) * 1.005
    biases = measured - metres
    stds = 0.1 * measured**2 / (108 * 1.005)  # to first order: at 27 px and more the second is under 1e-4
    found = infer_disparity_noise(RIG, ErrorsByDistance(metres, stds, biases))
    assert found.disparity_std_px == pytest.approx(0.1, rel=1e-4)
    assert found.bias is not None
    assert found.bias.disparity_offset_px == pytest.approx(0.2, rel=0.02)
    assert found.bias.scale == pytest.approx(0.005, rel=0.02)
    assert found.bias.left_rms_m < 2e-4
    shares = (biases / metres) ** 2
    assert found.bias.share == pytest.approx(shares.sum() / (shares + (stds / metres) ** 2).sum(), rel=1e-12)


def test_two_distances_give_an_offset_alone() -> None:
    found = infer_disparity_noise(
        RIG, ErrorsByDistance(depths(1, 2), depths(0.001, 0.004), depths(108 / 108.1 - 1, 108 / 54.1 - 2))
    )
    assert found.bias is not None
    # what the noise adds to the mean, Z a^1, is 1e-6 and 4e-6 of the distances
    assert found.bias.disparity_offset_px == pytest.approx(0.1, abs=5e-4)
    assert math.isnan(found.bias.scale)


def test_equal_distances_leave_the_law_untested() -> None:
    found = infer_disparity_noise(RIG, ErrorsByDistance(depths(2, 2, 2), depths(0.01, 0.011, 0.012)))
    assert found.verdict == "untested"
    assert found.low_px < found.disparity_std_px < found.high_px


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: ErrorsByDistance(depths(), depths()), "no depth errors"),
        (lambda: ErrorsByDistance(depths(-1), depths(1)), "distance -1000 mm: must be > 0"),
        (lambda: ErrorsByDistance(depths(1), depths(-0.01)), "depth std -10 mm: must be > 0"),
        (lambda: ErrorsByDistance(depths(1), depths(0.1), depths(math.nan)), "depth bias"),
        (
            lambda: ErrorsByDistance(depths(1), depths(0.1), counts=depths(1)),
            "n 1: a standard deviation needs",
        ),
        (lambda: depth_gain(StereoRig.verged(W7.left, 0.1, 170.0), depths(0.001, 5)), "no depth there"),
    ],
)
def test_impossible_errors_are_named(make, says: str) -> None:
    with pytest.raises(InvalidRange, match=says):
        make()


def measured_by(
    fb: float, metres: np.ndarray, offset_px: float, scale: float, sigma_px: float = 1e-4, n: float = 1e4
) -> ErrorsByDistance:
    """What a rectified rig of f B = `fb` px m gives without sampling error, by the law itself."""
    means = (1 + scale) * fb / (fb / metres + offset_px)
    return ErrorsByDistance(
        metres,
        sigma_px * means**2 / (fb * (1 + scale)),
        means - metres,
        np.full(len(metres), n),
    )


def rectified(fb: float) -> StereoRig:
    return StereoRig.rectified(Intrinsics.from_focal(1280, 720, fb / 0.05), 0.05)


@pytest.mark.parametrize(
    ("fb", "metres", "offset_px", "scale"),
    [
        # D435, f B 21.2 px m: .7 px too small, no scale; to first order it was -1.03 px and -2.9 %
        (21.2, (0.5, 1, 2, 3, 4, 6), -0.7, 0.0),
        # 25 m read as 12 m: 80.3 (1/12 - 1/25) = 3.48 px; to first order 1.95
        (80.3, (2, 5, 10, 15, 25), 3.48, 0.0),
        (108.0, (1, 2, 3, 4), 0.3, 0.5),
        (108.0, (1, 2, 3, 4), -2.0, -0.3),
    ],
)
def test_large_offsets_and_scales_are_split_exactly(
    fb: float, metres: tuple[float, ...], offset_px: float, scale: float
) -> None:
    found = infer_disparity_noise(rectified(fb), measured_by(fb, depths(*metres), offset_px, scale))
    assert found.bias is not None
    assert found.bias.disparity_offset_px == pytest.approx(offset_px, abs=1e-5)
    assert found.bias.scale == pytest.approx(scale, abs=1e-6)
    assert found.disparity_std_px == pytest.approx(1e-4, rel=1e-4)
    assert found.verdict == "consistent"
    assert found.bias.left_rms_m < 1e-6


def test_one_distance_tells_the_offset_by_hand() -> None:
    # 25 m read as 12 m: 80.3/12 - 80.3/25 = 3.479667 px; K = 144/80.3 m/px at 12 m, so .1 m is .0557639 px
    errors = ErrorsByDistance(depths(25), depths(0.1), depths(-13), counts=depths(100))
    found = infer_disparity_noise(rectified(80.3), errors)
    assert found.bias is not None
    assert found.bias.disparity_offset_px == pytest.approx(3.479667, abs=1e-3)
    assert found.bias.disparity_offset_se_px == pytest.approx(0.00557639, rel=1e-3)
    assert found.disparity_std_px == pytest.approx(0.0557639, rel=1e-3)
    assert math.isnan(found.bias.scale_se)
    # without a count nothing is left over to tell it by
    alone = infer_disparity_noise(rectified(80.3), ErrorsByDistance(depths(25), depths(0.1), depths(-13)))
    assert alone.bias is not None
    assert math.isnan(alone.bias.disparity_offset_se_px)


def test_what_noise_adds_to_the_mean_is_no_offset() -> None:
    # E[Z] = Z0 (1 + a + 3 a^2 + 15 a^3), var = Z0^2 (a + 8 a^2 + 69 a^3), a = (sigma/d)^2: at 8 sigma the
    # mean is 1.6 % too far, which the first order would call an offset of -.02 px of 1
    fb, metres, sigma_px = 20.0, depths(5, 10, 15, 20), 0.125
    a = (sigma_px * metres / fb) ** 2
    means = metres * (1 + a + 3 * a**2)
    stds = metres * np.sqrt(a + 8 * a**2 + 69 * a**3)
    found = infer_disparity_noise(
        rectified(fb), ErrorsByDistance(metres, stds, means - metres, np.full(4, 500.0))
    )
    assert found.bias is not None
    assert found.bias.disparity_offset_px == pytest.approx(0.0, abs=1e-9)
    assert found.bias.scale == pytest.approx(0.0, abs=1e-9)
    assert found.disparity_std_px == pytest.approx(sigma_px, rel=1e-9)


def test_the_offset_of_any_rig_is_that_of_its_pixels() -> None:
    # independent of the fit: the right pixel is moved, and the rays are intersected again
    verged = StereoRig.verged(Intrinsics.from_focal(1280, 720, 900.0), 0.12, 10.0)
    metres = depths(0.5, 0.8, 1.2, 2.0, 3.0)
    uv_left, uv_right = verged.project(np.column_stack([0 * metres, 0 * metres, metres]))
    means = triangulate(verged, uv_left, uv_right - [0.8, 0.0])[:, 2]
    stds = 1e-4 * depth_gain(verged, means)
    found = infer_disparity_noise(verged, ErrorsByDistance(metres, stds, means - metres))
    assert found.bias is not None
    assert found.bias.disparity_offset_px == pytest.approx(0.8, rel=0.02)
    assert found.bias.scale == pytest.approx(0.0, abs=5e-4)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (
            lambda: ErrorsByDistance(depths(1), depths(0.1), depths(-1.2)),
            "distance 1000 mm with a bias of -1200 mm",
        ),
        (
            lambda: ErrorsByDistance(depths(1), depths(0.1), depths(-1.0)),
            "the mean measured depth must be > 0",
        ),
        (
            lambda: infer_disparity_noise(
                RIG, ErrorsByDistance(depths(1, 2, 3), depths(0.01, 0.01, 0.01), depths(2, 0, -2))
            ),
            "does not grow with the distance",
        ),
    ],
)
def test_impossible_biases_are_refused(make, says: str) -> None:
    with pytest.raises(InvalidRange, match=says):
        make()


@pytest.mark.parametrize("scatter", [0.0, 0.1])
@pytest.mark.parametrize("counted", [True, False])
def test_intervals_of_offset_scale_and_noise_cover(scatter: float, counted: bool) -> None:
    # distances whose noise and offset scatter by 10 % and .03 px beyond their samples, as real walls do
    rng = np.random.default_rng(11)
    fb, metres, sigma_px, n = 60.0, depths(1, 1.5, 2, 3, 4, 6, 8, 10), 0.1, 60
    offset_px, scale = -1.5, 0.02  # 10 m is measured as 13.6
    inside = np.zeros(3)
    for _ in range(REPETITIONS):
        own_px = sigma_px * np.exp(scatter * rng.standard_normal(8))
        moved = offset_px + 0.3 * scatter * rng.standard_normal(8)
        noisy = fb / metres + moved + own_px * rng.standard_normal((n, 8))
        measured = (1 + scale) * fb / noisy
        errors = ErrorsByDistance(
            metres,
            measured.std(axis=0, ddof=1),
            measured.mean(axis=0) - metres,
            np.full(8, float(n)) if counted else None,
        )
        found = infer_disparity_noise(rectified(fb), errors)
        assert found.bias is not None
        for i, (value, (low, high)) in enumerate(
            [
                (offset_px, found.bias.offset_interval_px),
                (scale, found.bias.scale_interval),
                (sigma_px, (found.low_px, found.high_px)),
            ]
        ):
            inside[i] += low <= value <= high
    # 95 % of 200 scatter by 1.5 %
    assert (inside >= 0.915 * REPETITIONS).all()
    assert (inside <= 0.985 * REPETITIONS).all()


def test_random_effects_by_hand() -> None:
    # the mean of 1, 2, 6 with own variances of 1: squares 14 - 2 = 12 over 1 + v come to 2 at v = 6;
    # then se = sqrt(7 / 3) and Student's t of 2 degrees, 4.302653
    fit = random_effects(np.ones((3, 1)), np.array([1.0, 2.0, 6.0]), np.ones(3))
    assert fit.values[0] == pytest.approx(3.0)
    assert fit.between == pytest.approx(6.0, rel=1e-9)
    assert fit.half_width(0) == pytest.approx(4.302653 * math.sqrt(7 / 3), rel=1e-6)
    # 1, 2, 3 scatter by no more than their variances say: those are all there is
    fit = random_effects(np.ones((3, 1)), np.array([1.0, 2.0, 3.0]), np.ones(3))
    assert (fit.between, fit.values[0]) == (0.0, pytest.approx(2.0))
    assert fit.ses[0] == pytest.approx(1 / math.sqrt(3))
    assert fit.half_width(0) == pytest.approx(1.959964 / math.sqrt(3), rel=1e-6)
    # unequal variances: v = 1, 4 weigh 4 to 1
    fit = random_effects(np.ones((2, 1)), np.array([0.0, 1.0]), np.array([1.0, 4.0]))
    assert fit.values[0] == pytest.approx(0.2)
