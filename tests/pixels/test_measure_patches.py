"""Patches: against formulas, the bound of what can be known, and on purpose against broken pairs."""

from __future__ import annotations

import dataclasses
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.errors import InvalidImage, InvalidRange, MeasurementFailed, RigsimError
from rigsim.pixels.dense.rectify import rectify
from rigsim.pixels.patches.interest import estimate_noise, interest_points
from rigsim.pixels.patches.neighbours import borne_out
from rigsim.pixels.patches.patches import PatchMatches, match_patches
from rigsim.pixels.patches.refine import Fits, fit_patches
from rigsim.pixels.patches.spline import (
    REACH,
    RowSpline,
    derivative_noise_gain,
    error_kernels,
    noise_gain,
    phase_of,
    tap_weights,
)
from rigsim.pixels.patches.trust import predicted_std
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from tests.helpers.textured_images import Pair, Waves, affine_pair, noisy, plane_pair, plane_truth

# --- the spline ---------------------------------------------------------------------------------


def test_spline_reproduces_a_parabola_and_its_slope() -> None:
    u = np.arange(80.0)
    spline = RowSpline.through(np.stack([(u - 40) ** 2, u]))
    # (30.25 - 40)^2 and 2 (30 - 40); the mirrored ends are far enough away
    assert spline.sample(np.array([0, 1]), np.array([30.25, 30.25])) == pytest.approx(
        [95.0625, 30.25], abs=1e-9
    )
    assert spline.derivative()[:, 30] == pytest.approx([-20.0, 1.0], abs=1e-9)


def test_spline_passes_through_the_pixels_and_ends_with_them() -> None:
    image = np.random.default_rng(0).uniform(0, 255, (3, 17))
    spline = RowSpline.through(image)
    assert spline.sample(np.arange(3)[:, None], np.arange(17.0)) == pytest.approx(image, abs=1e-9)
    assert np.isnan(spline.sample(np.array(0), np.array([-0.01, 16.01]))).all()


@given(st.floats(0, 1))
def test_weights_are_a_partition_of_one_and_noise_gain_is_even(fraction: float) -> None:
    t = np.array(fraction)
    assert float(sum(tap_weights(t))) == pytest.approx(1, abs=1e-12)
    assert float(noise_gain(t)) == pytest.approx(float(noise_gain(1 - t)), abs=1e-9)


def test_noise_gains_are_those_of_noise() -> None:
    noise = np.random.default_rng(1).standard_normal((400, 400))
    spline = RowSpline.through(noise)
    for fraction in (0.0, 0.3, 0.5):
        values = spline.sample(np.arange(400)[:, None], np.arange(20.0, 380) + fraction)
        assert float(noise_gain(np.array(fraction))) == pytest.approx(values.var(), rel=0.02)
    assert derivative_noise_gain() == pytest.approx(spline.derivative()[:, 20:-20].var(), rel=0.02)


# --- the fit ------------------------------------------------------------------------------------

RADIUS = 7


def fit(pair: Pair, left: Array, right: Array, uv: np.ndarray) -> tuple[Fits, Array, Array]:
    """Fit windows at `uv`; their errors, and the bound of a shift alone (Robinson & Milanfar) per grey."""
    start = np.round(pair.disparity[uv[:, 1], uv[:, 0]])
    fits = fit_patches(
        left, RowSpline.through(left).derivative(), RowSpline.through(right), uv, start, radius=RADIUS
    )
    at = fits.uv_left.astype(int)
    error = fits.disparity - pair.disparity[at[:, 1], at[:, 0]]
    y, x = np.mgrid[-RADIUS : RADIUS + 1, -RADIUS : RADIUS + 1]
    slope = pair.slope[uv[:, 1, None] + y.ravel(), uv[:, 0, None] + x.ravel()]
    return fits, error, np.sqrt(2 / np.sum(slope**2, axis=1))


def grid(pair: Pair) -> np.ndarray:
    height, width = pair.left.shape
    u, v = np.meshgrid(np.arange(70, width - 30, 13), np.arange(12, height - 12, 13))
    return np.stack([u.ravel(), v.ravel()], axis=1)


@pytest.mark.parametrize(("a", "b"), [(0.0, 0.0), (0.15, 0.0), (-0.15, 0.1), (0.0, -0.25)])
def test_a_slanted_plane_is_found_with_its_slant(a: float, b: float) -> None:
    pair = affine_pair(1, d=20.3, a=a, b=b)
    uv = grid(pair)
    uv = uv[uv[:, 0] - pair.disparity[uv[:, 1], uv[:, 0]] < 300]
    uv = uv[uv[:, 0] - pair.disparity[uv[:, 1], uv[:, 0]] > 12]
    fits, error, _ = fit(pair, pair.left, pair.right, uv)
    assert np.isfinite(error).mean() > 0.99
    assert np.nanmax(np.abs(error)) < 0.01
    # the right patch grows by minus the disparity's slope
    assert np.nanmedian(fits.stretch) == pytest.approx(-a, abs=1e-3)
    assert np.nanmedian(fits.shear) == pytest.approx(-b, abs=1e-3)


@pytest.mark.parametrize(("highest", "limit"), [(0.25, 0.003), (0.35, 0.01)])
def test_no_bias_over_the_phase_of_a_pixel(highest: float, limit: float) -> None:
    for phase in np.arange(0, 1, 0.125):
        pair = affine_pair(2, d=20 + phase, highest=highest)
        _, error, _ = fit(pair, pair.left, pair.right, grid(pair))
        assert abs(error.mean()) < limit
        assert np.sqrt(np.mean(error**2)) < limit


@pytest.mark.parametrize("noise", [0.5, 2.0, 5.0])
def test_noise_costs_little_more_than_it_must_and_is_predicted(noise: float) -> None:
    ratios, scaled = [], []
    for seed, phase in enumerate((0.0, 0.3, 0.5, 0.8)):
        pair = affine_pair(seed, d=20 + phase)
        left, right = noisy(pair.left, noise, 10 + seed), noisy(pair.right, noise, 20 + seed)
        fits, error, bound = fit(pair, left, right, grid(pair))
        std, noise_std = predicted_std(fits, noise**2)
        assert (std >= noise_std).all()
        ratios.append(error / (bound * noise))
        scaled.append(error / std)
    assert np.sqrt(np.mean(np.square(ratios))) < 1.1
    # curvature and parts of the window may be blamed by chance, so a little too careful is right
    assert 0.8 < np.sqrt(np.mean(np.square(scaled))) < 1.05
    assert np.mean(np.abs(scaled) < 3) > 0.99


def test_gain_and_offset_of_the_right_camera_do_not_matter() -> None:
    pair = affine_pair(3, d=20.4)
    fits, error, _ = fit(pair, pair.left, 0.7 * pair.right + 25, grid(pair))
    assert np.abs(error).max() < 0.01
    assert np.median(fits.gain) == pytest.approx(0.7, abs=1e-3)


def test_the_noise_of_the_images_is_read_from_the_fits() -> None:
    pair = affine_pair(4, d=20.4)
    fits, _, _ = fit(pair, noisy(pair.left, 3.0, 1), noisy(pair.right, 3.0, 2), grid(pair))
    assert np.sqrt(np.median(fits.noise_var)) == pytest.approx(3.0, rel=0.03)


def test_a_curved_surface_is_trusted_less() -> None:
    pair = affine_pair(5, d=20.0)
    u, v = np.arange(320.0), np.arange(240.0)[:, None]
    waves = Waves.random(5)
    # disparity 20 + 0.004 (u - 160)^2 over the right image's columns, inverted by fixed point
    seen = u + 20.0
    for _ in range(200):
        seen = u + 20.0 + 0.004 * (seen - 160) ** 2 * (np.abs(seen - 160) < 60)
    right = waves.at(seen, v)
    uv = np.stack([np.full(20, 160), np.arange(15, 215, 10)], axis=1)
    curved, _, _ = fit(pair, pair.left, right, uv)
    flat, _, _ = fit(pair, pair.left, pair.right, uv)
    assert np.median(predicted_std(curved, 1.0)[0]) > 2 * np.median(predicted_std(flat, 1.0)[0])


# --- where to look ------------------------------------------------------------------------------


def test_interest_points_lie_on_gradient_along_the_row_alone() -> None:
    u, v = np.arange(200.0), np.arange(150.0)[:, None]
    image = np.where(u < 100, 50 * np.sin(v / 2), 50 * np.sin(u / 2)) + np.zeros_like(v)
    gradient = RowSpline.through(image).derivative()
    uv = interest_points(gradient, np.ones(image.shape, bool), 50, radius=5, noise_var=0.01)
    assert len(uv) == 50
    assert (uv[:, 0] >= 94).all()


def test_interest_points_cover_the_image_and_obey_the_mask() -> None:
    image = Waves.random(1, contrast=20).at(np.arange(300.0), np.arange(200.0)[:, None])
    image[:100] = 128 + 5 * (image[:100] - 128)  # five times the contrast above
    usable = np.zeros(image.shape, bool)
    usable[:, 10:250] = True
    uv = interest_points(RowSpline.through(image).derivative(), usable, 100, radius=5, noise_var=0.01)
    assert len(np.unique(uv, axis=0)) == len(uv) == 100
    assert usable[uv[:, 1], uv[:, 0]].all()
    assert 35 <= np.sum(uv[:, 1] >= 100) <= 65


def test_noise_is_estimated_where_the_image_is_calm() -> None:
    image = np.full((300, 300), 100.0)
    image[:, :150] = Waves.random(2).at(np.arange(150.0), np.arange(300.0)[:, None])
    assert estimate_noise(noisy(image, 4.0, 1)) == pytest.approx(4.0, rel=0.1)


# --- the whole way ------------------------------------------------------------------------------


def faults(matches: PatchMatches, pair: Pair) -> set[str]:
    """What a set of matches gets wrong; empty when it is to be believed."""
    valid = matches.observations.valid
    uv = matches.observations.uv_left[valid].astype(int)
    error = matches.disparity[valid] - pair.disparity[uv[:, 1], uv[:, 0]]
    found = set()
    if valid.mean() < 0.5:
        found.add("few")
    if not abs(np.median(error)) < 0.02:
        found.add("biased")
    if not np.mean(np.abs(error) < 3 * matches.disparity_std_px[valid]) > 0.98:
        found.add("overconfident")
    if not np.sqrt(np.nanmean(matches.epipolar_px**2)) < 0.2:
        found.add("rows")
    return found


@pytest.fixture(scope="module")
def pair() -> Pair:
    pair = affine_pair(7, d=18.37, a=0.05, b=-0.03)
    return replace(pair, left=noisy(pair.left, 2.0, 1), right=noisy(pair.right, 2.0, 2))


def test_matches_of_an_honest_pair(pair: Pair) -> None:
    matches = match_patches(pair.left, pair.right, pair.rig, n_points=300)
    assert faults(matches, pair) == set()
    seen = matches.observations
    assert len(seen.valid) <= 300
    assert matches.n_valid == seen.valid.sum()
    assert matches.noise_std_grey == pytest.approx(2.0, rel=0.05)
    for column in (seen.uv_left, seen.uv_right, matches.disparity, matches.disparity_std_px, matches.score):
        assert np.isfinite(column[seen.valid]).all()
        assert np.isnan(column[~seen.valid]).all()
    uv_left, uv_right = seen.uv_left[seen.valid], seen.uv_right[seen.valid]
    assert (uv_left == np.round(uv_left)).all()
    assert (uv_right[:, 1] == uv_left[:, 1]).all()
    low, high = matches.disparity_range
    assert low < pair.disparity[:, 40:].min() < pair.disparity.max() < high
    assert uv_left[:, 0] - uv_right[:, 0] == pytest.approx(matches.disparity[seen.valid], abs=1e-9)


def shifted(image: Array, u: float) -> Array:
    """The picture moved to the right by `u` px."""
    columns = np.clip(np.arange(image.shape[1]) - u, 0, image.shape[1] - 1)
    return RowSpline.through(image).sample(np.arange(len(image))[:, None], columns[None])


@pytest.mark.parametrize(
    ("breakage", "fault"),
    [("half a pixel", "biased"), ("swapped", "few"), ("row", "rows"), ("three rows", "few")],
)
def test_a_broken_pair_is_caught(pair: Pair, breakage: str, fault: str) -> None:
    left, right = {
        "half a pixel": (pair.left, shifted(pair.right, 0.5)),
        "swapped": (pair.right, pair.left),
        "row": (pair.left, np.roll(pair.right, 1, axis=0)),
        "three rows": (pair.left, np.roll(pair.right, 5, axis=0)),
    }[breakage]
    try:
        matches = match_patches(left, right, pair.rig, n_points=300)
    except MeasurementFailed:
        caught = {"few"}
    else:
        caught = faults(matches, pair)
    assert fault in caught


def test_a_row_too_low_is_measured_as_a_row_too_low() -> None:
    # texture this smooth still matches one row off; which way is positive is pinned here
    smooth = affine_pair(8, d=18.0, highest=0.08)
    matches = match_patches(smooth.left, np.roll(smooth.right, 1, axis=0), smooth.rig, n_points=200)
    assert np.nanmedian(matches.epipolar_px) == pytest.approx(1.0, abs=0.05)


def test_depth_steps_are_left_out_or_trusted_less() -> None:
    u, v = np.arange(400.0), np.arange(240.0)[:, None]
    near, far = Waves.random(11), Waves.random(12)
    front_left, front_right = (u >= 150) & (u < 250), (u >= 110) & (u < 210)
    left = noisy(np.where(front_left, near.at(u, v), far.at(u, v)), 2.0, 1)
    right = noisy(np.where(front_right, near.at(u + 40, v), far.at(u + 15, v)), 2.0, 2)
    rig = StereoRig.rectified(Intrinsics.from_focal(400, 240, 400.0), 0.1)
    matches = match_patches(left, right, rig, n_points=500)
    seen = matches.observations
    at = seen.uv_left[seen.valid, 0]
    truth = np.where((at >= 150) & (at < 250), 40.0, 15.0)
    error = np.abs(matches.disparity[seen.valid] - truth)
    assert seen.valid.sum() > 250
    assert np.mean(error < 3 * matches.disparity_std_px[seen.valid]) > 0.97
    # u 125 to 150 of the background is hidden behind the front in the right image
    hidden = (at >= 130) & (at < 145)
    assert hidden.sum() <= 3


def test_doffs_moves_the_search_not_the_disparity() -> None:
    # disparity -12 lies in front of the cameras because doffs is 30
    exact = affine_pair(9, d=-12.4, doffs=30.0)
    pair = replace(exact, left=noisy(exact.left, 1.0, 1), right=noisy(exact.right, 1.0, 2))
    assert faults(match_patches(pair.left, pair.right, pair.rig, n_points=200), pair) == set()
    # without doffs the same pictures show something beyond infinity
    behind = replace(pair, rig=affine_pair(9).rig)
    try:
        matches = match_patches(behind.left, behind.right, behind.rig, n_points=200)
    except MeasurementFailed:
        return
    assert "few" in faults(matches, behind)


def test_the_disparity_range_is_kept_to(pair: Pair) -> None:
    near = match_patches(pair.left, pair.right, pair.rig, n_points=200, disparity_range=(0.0, 60.0))
    assert faults(near, pair) == set()
    with pytest.raises(MeasurementFailed, match="disparities 100 to 120"):
        match_patches(
            Waves.random(1).at(np.arange(320.0), np.arange(240.0)[:, None]),
            Waves.random(2).at(np.arange(320.0), np.arange(240.0)[:, None]),
            pair.rig,
            n_points=20,
            disparity_range=(100.0, 120.0),
        )


@pytest.mark.parametrize(
    ("vergence_deg", "distortion"),
    [(12.0, None), (-4.0, None), (0.0, BrownConrady(k1=-0.2, k2=0.05, p1=0.001, p2=-0.001))],
)
def test_any_rig_is_matched_along_its_epipolar_lines(
    vergence_deg: float, distortion: BrownConrady | None
) -> None:
    lens = Intrinsics.from_focal(400, 300, 420.0, lens=distortion)
    rig = StereoRig.verged(lens, 0.12, vergence_deg)
    surface = {"normal": (0.25, -0.2, 1.0), "distance_m": 1.0}
    left, right = plane_pair(rig, 3, **surface)
    matches = match_patches(left, right, rig, n_points=250)
    seen = matches.observations
    truth = plane_truth(rig, seen.uv_left[seen.valid], **surface)
    error = seen.uv_right[seen.valid] - truth
    assert seen.valid.mean() > 0.5
    assert np.sqrt(np.mean(error[:, 0] ** 2)) < 0.01
    assert np.sqrt(np.mean(error[:, 1] ** 2)) < 0.01
    assert not np.allclose(seen.uv_left[seen.valid, 1], seen.uv_right[seen.valid, 1], atol=0.1)


# --- rectification ------------------------------------------------------------------------------

RANDOM_RIGS = st.builds(
    lambda turn, shift: StereoRig(
        Intrinsics(640, 480, 600.0, 590.0, 310.0, 250.0),
        Intrinsics(640, 480, 610.0, 605.0, 330.0, 235.0, BrownConrady(k1=-0.1, p2=0.002)),
        Pose.from_rotvec(np.array(turn), (-0.2, shift[0], shift[1])),
    ),
    st.tuples(*[st.floats(-0.1, 0.1)] * 3),
    st.tuples(st.floats(-0.03, 0.03), st.floats(-0.05, 0.05)),
)


@given(RANDOM_RIGS, st.integers(0, 2**32 - 1))
def test_a_rectified_rig_sees_what_the_rig_it_stands_for_sees(rig: StereoRig, seed: int) -> None:
    rectification = rectify(rig)
    assert rectification.rig.is_rectified
    assert rectification.rig.baseline_m == pytest.approx(rig.baseline_m, abs=1e-12)
    points_left = np.random.default_rng(seed).uniform((-0.3, -0.3, 2), (0.3, 0.3, 6), (20, 3))
    uv_left, uv_right = rectification.rig.project(points_left @ rectification.rectified_from_left.T)
    assert uv_left[:, 1] == pytest.approx(uv_right[:, 1], abs=1e-9)
    expected_left, expected_right = rig.project(points_left)
    assert rectification.left_pixels(uv_left) == pytest.approx(expected_left, abs=1e-8)
    assert rectification.right_pixels(uv_right) == pytest.approx(expected_right, abs=1e-8)


def test_a_rectified_rig_is_left_alone(pair: Pair) -> None:
    rectification = rectify(pair.rig)
    assert rectification.rig is pair.rig
    assert rectification.warp(pair.left, pair.right)[0] is pair.left


def test_cameras_one_behind_the_other_cannot_be_rectified() -> None:
    lens = Intrinsics.from_focal(640, 480, 600.0)
    rig = StereoRig(lens, lens, Pose(np.eye(3), np.array([-0.01, 0.0, -0.3])))
    with pytest.raises(MeasurementFailed, match="off their baseline"):
        rectify(rig)


def test_cameras_back_to_back_cannot_be_rectified() -> None:
    lens = Intrinsics.from_focal(640, 480, 600.0)
    rig = StereoRig(lens, lens, Pose.from_rotvec((0.0, 3.0, 0.0), (-0.3, 0.0, 0.0)))
    with pytest.raises(MeasurementFailed):
        rectify(rig)


# --- bad input ----------------------------------------------------------------------------------

SMALL_RIG = StereoRig.rectified(Intrinsics.from_focal(64, 48, 60.0), 0.1)
TINY_RIG = StereoRig.rectified(Intrinsics.from_focal(9, 9, 60.0), 0.1)
TEXTURE = Waves.random(1).at(np.arange(64.0), np.arange(48.0)[:, None])
STRIPES = np.broadcast_to(128 + 50 * np.sin(np.arange(48.0))[:, None], (48, 64))


@pytest.mark.parametrize(
    ("left", "right", "options", "error", "message"),
    [
        (TEXTURE, TEXTURE[:, 1:], {}, InvalidImage, "one size"),
        (TEXTURE[1:], TEXTURE[1:], {}, InvalidImage, "64 x 47 px: the rig's left camera has 64 x 48"),
        (np.zeros((48, 64)), TEXTURE, {}, InvalidImage, "left image"),
        (TEXTURE, np.full((48, 64), 255, np.uint8), {}, InvalidImage, "right image"),
        (STRIPES, STRIPES, {}, MeasurementFailed, "no texture along the rows"),
        (TEXTURE, TEXTURE, {"n_points": 0}, InvalidRange, "0 points: at least 1"),
        (TEXTURE, TEXTURE, {"window": 14}, InvalidRange, "window 14 px: must be odd"),
        (TEXTURE, TEXTURE, {"window": 3}, InvalidRange, "window 3 px"),
        (TEXTURE, TEXTURE, {"window": 51}, MeasurementFailed, "51 x 51 px window"),
        (TEXTURE[:9, :9], TEXTURE[:9, :9], {"rig": TINY_RIG}, MeasurementFailed, "9 x 9 px hold no 15 x 15"),
        (TEXTURE, TEXTURE, {"disparity_range": (9.0, 3.0)}, InvalidRange, "9 to 3 px"),
        (TEXTURE, TEXTURE, {"disparity_range": (0.0, np.nan)}, InvalidRange, "nan px"),
        (TEXTURE, TEXTURE, {"disparity_range": (100.0, 200.0)}, InvalidRange, "64 px wide"),
    ],
)
def test_bad_input_is_one_line(
    left: Array, right: Array, options: dict[str, object], error: type[RigsimError], message: str
) -> None:
    with pytest.raises(error, match=message) as caught:
        match_patches(left, right, **{"rig": SMALL_RIG, **options})
    assert "\n" not in str(caught.value)


# --- what the claims are worth --------------------------------------------------------------------


@pytest.mark.parametrize("phase", [0.25, 0.75])
def test_texture_up_to_the_finest_is_not_biased_by_the_spline(phase: float) -> None:
    # a quintic spline alone errs by 0.017 px here, towards the whole pixel it starts from
    pair = affine_pair(2, d=20 + phase, highest=0.48)
    fits, error, _ = fit(pair, pair.left, pair.right, grid(pair))
    known = np.isfinite(error)
    assert known.mean() > 0.9
    assert abs(error[known].mean()) < 0.003
    # the sign of what was taken out: at a quarter of a pixel the spline makes disparities too large
    assert np.sign(phase - 0.5) * fits.interpolation_px[known].mean() == pytest.approx(0.0165, abs=0.004)
    std, _ = predicted_std(fits, 0.01)
    assert np.sqrt(np.mean(error[known] ** 2)) < 1.25 * np.sqrt(np.mean(std[known] ** 2))


def test_error_kernels_shift_a_wave_back_to_itself() -> None:
    # 0.3 px of a wave of 0.45 cycles/px: what the spline makes of it, less its error, is the wave
    u = np.arange(400.0)
    wave = np.cos(2 * np.pi * 0.45 * u)
    moved = np.cos(2 * np.pi * 0.45 * (u - 0.3))  # seen 0.3 px further right
    back = RowSpline.through(moved[None]).sample(np.array(0), u[50:350] + 0.3)
    kernels, _ = error_kernels()
    kernel = kernels[int(phase_of(np.array(0.3)))]
    windows = np.lib.stride_tricks.sliding_window_view(wave, 2 * REACH + 1)
    error = windows[50 - REACH : 350 - REACH] @ kernel
    off, left = back - wave[50:350], back - error - wave[50:350]
    assert np.abs(off).max() > 0.2
    assert np.abs(left).max() < np.abs(off).max() / 3


def test_weak_texture_is_neither_held_back_nor_claimed_too_well_or_too_badly() -> None:
    errors, claims = [], []
    for seed, phase in enumerate((0.2, 0.4, 0.6, 0.8)):
        exact = affine_pair(seed, d=20 + phase)
        # 2.5 grey of texture under 2 grey of noise
        weak = [128 + (image - 128) / 16 for image in (exact.left, exact.right)]
        left, right = noisy(weak[0], 2.0, 10 + seed), noisy(weak[1], 2.0, 20 + seed)
        matches = match_patches(left, right, exact.rig, n_points=300, disparity_range=(0, 40))
        valid = matches.observations.valid
        errors.append(np.sign(0.5 - phase) * (matches.disparity[valid] - 20 - phase))
        claims.append(matches.disparity_std_px[valid])
    error, claim = np.concatenate(errors), np.concatenate(claims)
    assert len(error) > 100
    rms = np.sqrt(np.mean(error**2))
    # towards the whole pixel it was 0.036 px, and 3.3 times the error was claimed
    assert abs(error.mean()) < 4 * rms / np.sqrt(len(error))
    assert 0.8 < np.sqrt(np.mean(claim**2)) / rms < 1.4


def test_a_plane_through_two_surfaces_is_told_by_its_neighbours() -> None:
    """Nine matches on two walls, disparity 10 and 12, and one between them that makes a ramp of both."""
    u = np.array([20.0, 35, 50, 20, 35, 100, 115, 130, 115, 70])
    v = np.array([20.0, 20, 20, 40, 40, 20, 20, 20, 40, 30])
    n = len(u)
    disparity = np.where(u < 60, 10.0, 12.0)
    disparity[-1] = 11.0
    stretch = np.zeros(n)
    stretch[-1] = -0.3  # the ramp: disparity grows by 0.3 px a px
    blank = {item.name: np.ones(n) for item in dataclasses.fields(Fits)}
    fits = Fits(
        **blank
        | {
            "uv_left": np.stack([u, v], axis=1),
            "disparity": disparity,
            "stretch": stretch,
            "shear": np.zeros(n),
            "slope_var": np.tile(1e-8 * np.eye(2), (n, 1, 1)),
        }
    )
    std = np.full(n, 0.02)
    outvoted, on_plane, bend = borne_out(fits, np.ones(n, dtype=bool), std, std, window=15)
    assert not outvoted[:-1].any()
    assert (on_plane[:-1] >= 0.4).all()
    assert outvoted[-1] or on_plane[-1] == 0
    assert bend[:-1] == pytest.approx(0, abs=0.1)
