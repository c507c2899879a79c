"""Metrics: every definition by hand on a few pixels, then by law."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.errors import InvalidImage, InvalidRange, MeasurementFailed
from rigsim.pixels.dense.metrics import disparity_errors, errors_by_region, phase_errors
from rigsim.pixels.dense.quality import depth_quality
from rigsim.pixels.dense.regions import near_discontinuity, occluded, regions, textureless
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig

NAN = math.nan

# --- errors -------------------------------------------------------------------------------------


def test_every_number_by_hand() -> None:
    truth = np.array([[10.0, 10.0, 10.0, 10.0, 100.0, 100.0, 10.0, 10.0, 10.0, NAN]])
    found = np.array([[10.0, 10.4, 9.0, 12.5, 104.0, 106.0, 10.0, 10.0, NAN, 50.0]])
    # errors 0, .4, -1, 2.5, 4, 6, 0, 0 over nine pixels of known truth
    errors = disparity_errors(found, truth)
    assert errors.n == 9
    assert errors.invalid_pct == pytest.approx(100 / 9)
    assert errors.fill_pct == pytest.approx(800 / 9)
    assert errors.bad_0_5_pct == pytest.approx(400 / 9)
    assert errors.bad_1_pct == pytest.approx(300 / 9)  # an error of 1 exactly is not more than 1
    assert errors.bad_2_pct == pytest.approx(300 / 9)
    assert errors.bad_4_pct == pytest.approx(100 / 9)
    assert errors.d1_pct == pytest.approx(100 / 9)  # 4 px is more than 3, but less than 5 % of 100
    assert errors.epe_px == pytest.approx(13.9 / 8)
    assert errors.rms_px == pytest.approx(math.sqrt((0.16 + 1 + 6.25 + 16 + 36) / 8))
    assert errors.mean_px == pytest.approx(11.9 / 8)
    assert errors.median_abs_px == pytest.approx(0.7)
    # median .2; deviations .2 .2 .2 .2 1.2 2.3 3.8 5.8
    assert errors.nmad_px == pytest.approx(1.4826 * 0.7)


def test_nothing_to_judge_is_not_a_number() -> None:
    errors = disparity_errors(np.zeros((2, 2)), np.full((2, 2), NAN))
    assert errors.n == 0
    assert math.isnan(errors.bad_1_pct)
    assert math.isnan(errors.epe_px)
    blind = disparity_errors(np.full((2, 2), NAN), np.zeros((2, 2)))
    assert blind.invalid_pct == 100
    assert blind.bad_1_pct == 0
    assert math.isnan(blind.rms_px)


def test_truth_of_another_size_is_one_line() -> None:
    with pytest.raises(InvalidImage, match=r"truth of shape \(2, 3\): the disparity has \(3, 2\)"):
        disparity_errors(np.zeros((3, 2)), np.zeros((2, 3)))
    with pytest.raises(InvalidImage):
        phase_errors(np.zeros((3, 2)), np.zeros((2, 3)))


@given(st.integers(0, 2**32 - 1), st.floats(-2, 2))
def test_an_offset_moves_the_mean_and_nothing_that_is_free_of_it(seed: int, offset: float) -> None:
    rng = np.random.default_rng(seed)
    truth = rng.uniform(5, 50, (20, 30))
    found = truth + rng.normal(0, 1, truth.shape)
    found[rng.random(truth.shape) < 0.1] = NAN
    plain, moved = disparity_errors(found, truth), disparity_errors(found + offset, truth)
    assert moved.mean_px == pytest.approx(plain.mean_px + offset)
    assert moved.nmad_px == pytest.approx(plain.nmad_px)
    assert moved.invalid_pct == plain.invalid_pct
    assert moved.bad_0_5_pct >= moved.bad_1_pct >= moved.bad_2_pct >= moved.bad_4_pct
    assert moved.median_abs_px <= moved.rms_px * math.sqrt(2)
    assert abs(moved.mean_px) <= moved.epe_px <= moved.rms_px


def test_normal_errors_have_their_own_std_as_nmad() -> None:
    truth = np.full((300, 300), 20.0)
    found = truth + np.random.default_rng(0).normal(0, 0.3, truth.shape)
    assert disparity_errors(found, truth).nmad_px == pytest.approx(0.3, rel=0.01)
    assert disparity_errors(found, truth).rms_px == pytest.approx(0.3, rel=0.01)


# --- regions ------------------------------------------------------------------------------------


def test_what_a_near_thing_hides() -> None:
    # background at disparity 1, a thing at 3 on pixels 5 to 7: in the right image it covers 2 to 4,
    # where the background's 3, 4 and 5 would be; 5 is the thing itself, and 0 lands at -1
    truth = np.array([[1.0, 1, 1, 1, 1, 3, 3, 3, 1, 1]])
    assert np.flatnonzero(occluded(truth)[0]).tolist() == [0, 3, 4]


def test_a_slanted_surface_does_not_hide_itself() -> None:
    truth = np.broadcast_to(10 + 0.4 * np.arange(100.0), (3, 100))
    inside = np.round(np.arange(100) - truth[0]) >= 0
    assert inside.sum() > 80
    assert (occluded(truth) == ~inside).all()


def test_a_stretched_surface_is_not_looked_through() -> None:
    # the front grows by two in the right image: its columns there are 10, 12, 14, ... with holes between
    u = np.arange(200.0)
    truth = np.full((1, 200), 2.0)
    front = (u >= 100) & (u < 130)
    truth[0, front] = 60 - (u[front] - 100)  # lands on 40, 42, ... 98
    behind = (u - 2 >= 41) & (u - 2 <= 97)
    assert occluded(truth)[0, behind].all()


def test_unknown_pixels_hide_nothing_and_are_not_hidden() -> None:
    truth = np.array([[1.0, 1, 1, 1, 1, NAN, NAN, NAN, 1, 1]])
    assert np.flatnonzero(occluded(truth)[0]).tolist() == [0]


def test_textureless_is_the_mean_of_nine_squared_steps() -> None:
    image = np.zeros((9, 20))
    image[:, 10:] = 5.9  # a step of 5.9 in one of three columns: 34.81 / 3 = 11.6 >= 4
    assert np.flatnonzero(~textureless(image)[4]).tolist() == [8, 9, 10]
    image[:, 10:] = 3.4  # 11.56 / 3 = 3.85 < 4
    assert textureless(image).all()
    assert textureless(image.T * 100).all()  # steps down the columns are no help


def test_near_discontinuity_reaches_four_pixels() -> None:
    truth = np.full((30, 40), 10.0)
    truth[:, 20:] = 12.5
    assert np.flatnonzero(near_discontinuity(truth)[15]).tolist() == list(range(15, 25))
    assert near_discontinuity(truth.T)[:, 15].sum() == 10
    truth[:, 20:] = 12.0  # a gap of 2 exactly is none
    assert not near_discontinuity(truth).any()


def test_regions_divide_what_is_known() -> None:
    rng = np.random.default_rng(3)
    truth = np.full((60, 80), 6.0)
    truth[20:40, 30:50] = 14.0
    truth[rng.random(truth.shape) < 0.05] = NAN
    image = rng.uniform(0, 255, truth.shape)
    image[:, :20] = 7.0
    found = regions(truth, image)
    assert list(found) == ["all", "non-occluded", "occluded", "textureless", "near-discontinuity"]
    assert (found["non-occluded"] ^ found["occluded"] == found["all"]).all()
    assert not (found["textureless"] & found["occluded"]).any()
    assert found["textureless"].any()
    assert found["near-discontinuity"].any()
    by_region = errors_by_region(truth + 1.5, truth, found)
    assert by_region["occluded"].n == found["occluded"].sum()
    assert all(errors.mean_px == pytest.approx(1.5) for errors in by_region.values())
    better = regions(truth, image, hidden=np.zeros(truth.shape, bool))
    assert not better["occluded"].any()


# --- the phase of a pixel -----------------------------------------------------------------------


def test_pixel_locking_shows_as_a_wave() -> None:
    truth = np.random.default_rng(0).uniform(5, 60, (200, 200))
    locked = truth - 0.12 * np.sin(2 * np.pi * truth)
    phase = phase_errors(locked, truth, bins=8)
    assert phase.amplitude_px == pytest.approx(0.12, rel=0.02)
    assert phase.phase_px.tolist() == pytest.approx([1 / 16 + k / 8 for k in range(8)])
    assert phase.mean_error_px[1] == pytest.approx(-0.12 * 0.974 * math.sin(3 * math.pi / 8), abs=0.005)
    assert phase.mean_error_px[6] > 0.09
    assert phase.count.sum() == phase.measured_count.sum() == truth.size
    # answers crowd at whole pixels
    assert phase.measured_count[[0, 7]].sum() > 2 * phase.measured_count[[3, 4]].sum()


def test_an_honest_matcher_shows_no_wave_and_wrong_matches_are_left_out() -> None:
    rng = np.random.default_rng(1)
    truth = rng.uniform(5, 60, (200, 200))
    found = truth + rng.normal(0, 0.05, truth.shape)
    found[:50] += 20
    found[-1] = NAN
    phase = phase_errors(found, truth)
    assert phase.amplitude_px < 0.003
    assert phase.count.sum() == 149 * 200
    half = phase_errors(found, truth, truth < 30)
    assert 0 < half.count.sum() < phase.count.sum()
    assert math.isnan(phase_errors(np.full((1, 4), NAN), np.ones((1, 4))).amplitude_px)


# --- the Depth Quality Tool's -------------------------------------------------------------------

RIG = StereoRig.rectified(
    Intrinsics.from_focal(161, 121, 200.0), 0.05, right=Intrinsics.from_focal(161, 121, 200.0, cx=84.0)
)


def plane(distance_m: float, slope_x: float = 0.0, slope_y: float = 0.0) -> Array:
    """Disparity of the plane ``Z = distance + slope_x X + slope_y Y``, by rays."""
    v, u = np.mgrid[:121, :161].astype(float)
    x, y = (u - RIG.left.cx) / 200.0, (v - RIG.left.cy) / 200.0
    depth = distance_m / (1 - slope_x * x - slope_y * y)
    return np.asarray(200.0 * 0.05 / depth - RIG.doffs_px)


def test_an_exact_plane_is_exact() -> None:
    quality = depth_quality(plane(0.8, 0.3, -0.2), RIG, truth_m=0.8)
    assert quality.fill_rate_pct == 100
    assert quality.distance_mm == pytest.approx(800)
    assert quality.plane_fit_rms_mm == pytest.approx(0, abs=1e-6)
    assert quality.subpixel_rms_px == pytest.approx(0, abs=1e-9)
    assert quality.z_accuracy_pct == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(("truth_m", "accuracy_pct"), [(0.8, 0.0), (1.0, -20.0), (0.5, 60.0)])
def test_accuracy_is_positive_when_too_far(truth_m: float, accuracy_pct: float) -> None:
    quality = depth_quality(plane(0.8), RIG, truth_m=truth_m)
    assert quality.z_accuracy_pct == pytest.approx(accuracy_pct, abs=1e-9)
    assert math.isnan(depth_quality(plane(0.8), RIG).z_accuracy_pct)


def test_disparity_noise_is_read_back_and_becomes_depth_noise() -> None:
    noise = np.random.default_rng(0).normal(0, 0.05, (121, 161))
    quality = depth_quality(plane(0.8) + noise, RIG)
    # 0.5 % trimmed from either end of a normal distribution leaves 0.963 of its std
    assert quality.subpixel_rms_px == pytest.approx(0.05 * 0.963, rel=0.01)
    assert quality.plane_fit_rms_mm == pytest.approx(0.963 * 0.05 * 0.8**2 / 10.0 * 1e3, rel=0.02)
    assert quality.plane_fit_rms_pct == pytest.approx(quality.plane_fit_rms_mm / 8, rel=0.01)


def test_half_a_percent_at_either_end_is_left_out() -> None:
    disparity = plane(0.8)
    wild = disparity.copy()
    wild[60, 10:150] += 1.5  # 140 of 19481: 0.7 %, nearer; 97 of them are left out
    wild[0, :40] = NAN
    few = disparity.copy()
    few[60, 10:90] += 1e-3
    assert depth_quality(wild, RIG).subpixel_rms_px > 0.05
    assert depth_quality(few, RIG).subpixel_rms_px < 1e-5
    assert depth_quality(wild, RIG).fill_rate_pct == pytest.approx(100 * (1 - 40 / 19481))


def test_the_region_is_the_target() -> None:
    disparity = plane(0.8)
    disparity[:, 80:] = plane(0.4)[:, 80:]
    left = np.zeros(disparity.shape, bool)
    left[:, :80] = True
    assert depth_quality(disparity, RIG, left).plane_fit_rms_mm == pytest.approx(0, abs=1e-6)
    assert depth_quality(disparity, RIG).plane_fit_rms_mm > 10


def test_what_spans_no_plane_is_one_line() -> None:
    line = np.full((121, 161), NAN)
    line[60] = plane(0.8)[60]
    for disparity in (line, np.full((121, 161), NAN)):
        with pytest.raises(MeasurementFailed, match="span no plane"):
            depth_quality(disparity, RIG)
    with pytest.raises(InvalidRange, match="true distance 0 mm"):
        depth_quality(plane(0.8), RIG, truth_m=0.0)
