"""Predicted errors against closed forms and against simulation."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import least_squares
from scipy.special import dawsn

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.noise import PixelNoise
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory.triangulation import triangulate
from rigsim.theory.uncertainty import (
    depth_bounds,
    depth_in_sigmas,
    parallax_px,
    pixel_gain,
    predict_covariance,
    predict_depth_bias,
    predict_depth_rmse,
    predict_depth_std,
)
from tests.helpers.sampling import PLAIN, RIGS, close, points_in_view, rectified_rigs, rigs

SEEDS = st.integers(0, 2**32 - 1)
RIG = StereoRig.rectified(PLAIN, 0.1)
POINT = np.array([[0.5, -0.4, 4.0]])  # f B = 80 px m: a disparity of 20 px


def test_depth_law_by_hand() -> None:
    noise = PixelNoise(0.25)
    close(predict_depth_std(RIG, POINT, noise), [16 / 80 * 0.25 * math.sqrt(2)])
    # a = (sigma_d/d)^2 = 0.125/400
    a = 0.125 / 400
    close(predict_depth_bias(RIG, POINT, noise), [4 * a], rtol=1e-6)
    rmse, left_out = predict_depth_rmse(RIG, POINT, noise)
    close(rmse, [4 * math.sqrt(a + 9 * a**2)])
    close(rmse + left_out, [4 * math.sqrt(a + 9 * a**2 + 75 * a**3)])
    close(parallax_px(RIG, POINT), [20.0])


@given(rectified_rigs(), SEEDS)
def test_rectified_covariance_in_closed_form(rig: StereoRig, seed: int) -> None:
    points = points_in_view(rig, 10, 1.0, 8.0, seed)
    sigma, f, fy, B = 0.3, rig.left.fx, rig.left.fy, rig.baseline_m
    X, Y, Z = points.T
    X = X - B / 2  # from the middle of the baseline
    k = 2 * sigma**2 / (f * B) ** 2
    expected = np.empty((10, 3, 3))
    expected[:, 0, 0] = (Z / f) ** 2 * sigma**2 / 2 + k * X**2 * Z**2
    expected[:, 1, 1] = (Z / fy) ** 2 * sigma**2 / 2 + k * Y**2 * Z**2
    expected[:, 2, 2] = k * Z**4
    expected[:, 0, 1] = expected[:, 1, 0] = k * X * Y * Z**2
    expected[:, 0, 2] = expected[:, 2, 0] = k * X * Z**3
    expected[:, 1, 2] = expected[:, 2, 1] = k * Y * Z**3
    scale = np.sqrt(np.einsum("nii,njj->nij", expected, expected))
    close(predict_covariance(rig, points, PixelNoise(sigma)) / scale, expected / scale, atol=1e-9)


@given(rectified_rigs(), SEEDS, st.floats(-0.9, 0.9))
def test_rectified_depth_follows_the_disparity_alone(rig: StereoRig, seed: int, correlation: float) -> None:
    points = points_in_view(rig, 10, 1.0, 8.0, seed)
    noise = PixelNoise(0.2, correlation, quantization_px=0.1)
    Z = points[:, 2]
    fB = rig.left.fx * rig.baseline_m
    close(predict_depth_std(rig, points, noise), Z**2 / fB * noise.disparity_std_px)
    close(predict_depth_bias(rig, points, noise), Z * (noise.disparity_std_px * Z / fB) ** 2, rtol=1e-5)
    close(parallax_px(rig, points), fB / Z)


@given(rigs(distorted=True), SEEDS)
def test_covariance_is_the_cramer_rao_bound_without_correlation(rig: StereoRig, seed: int) -> None:
    points = points_in_view(rig, 5, 1.0, 5.0, seed)
    J = rig.jacobian(points)
    bound = 0.2**2 * np.linalg.inv(np.einsum("nij,nik->njk", J, J))
    covariance = predict_covariance(rig, points, PixelNoise(0.2))
    close(covariance, bound, rtol=1e-6, atol=1e-9 * bound.max())
    close(predict_depth_std(rig, points, PixelNoise(0.2)), np.sqrt(covariance[:, 2, 2]))
    # correlation can only be told by least squares as it is: the sandwich, not the bound
    tied = PixelNoise(0.2, correlation=0.8)
    gain = np.linalg.pinv(J)
    close(
        predict_covariance(rig, points, tied),
        gain @ tied.covariance_px2 @ gain.transpose(0, 2, 1),
        rtol=1e-6,
        atol=1e-9 * bound.max(),
    )


SAMPLES = 100_000


def simulated(
    kind: str, correlation: float, relative_std: float
) -> tuple[StereoRig, Array, PixelNoise, Array, Array]:
    """Errors (SAMPLES, 3) m of one point at the noise that makes sigma_Z / Z what was asked, and their
    part that is linear in the noise."""
    rig = RIGS[kind]
    point = points_in_view(rig, 1, 2.0, 4.0, seed=8)
    unit = predict_depth_std(rig, point, PixelNoise(1.0, correlation))[0] / point[0, 2]
    noise = PixelNoise(relative_std / unit, correlation)
    uv_left, uv_right = (np.repeat(uv, SAMPLES, axis=0) for uv in rig.project(point))
    noisy_left, noisy_right = noise.apply(uv_left, uv_right, np.random.default_rng(4))
    error = triangulate(rig, noisy_left, noisy_right) - point
    linear = np.hstack([noisy_left - uv_left, noisy_right - uv_right]) @ pixel_gain(rig, point)[0].T
    return rig, point, noise, error, linear


@pytest.mark.parametrize("correlation", [0.0, 0.6])
@pytest.mark.parametrize("kind", RIGS)
def test_simulated_spread_and_bias_are_the_predicted(kind: str, correlation: float) -> None:
    relative_std = 0.02
    rig, point, noise, error, linear = simulated(kind, correlation, relative_std)
    a = relative_std**2
    # four standard errors of a variance, and the second order that the covariance leaves out
    room = 4 * math.sqrt(2 / SAMPLES) + 10 * a
    predicted = predict_covariance(rig, point, noise)[0]
    scale = np.sqrt(np.outer(np.diag(predicted), np.diag(predicted)))
    close(np.cov(error.T) / scale, predicted / scale, atol=room)
    close(error[:, 2].std(), predict_depth_std(rig, point, noise)[0], rtol=room)
    # without the linear part, whose mean is zero, the bias stands clear of the scatter
    second_order = (error - linear)[:, 2]
    standard_error = second_order.std() / math.sqrt(SAMPLES)
    bias = predict_depth_bias(rig, point, noise)[0]
    assert standard_error < 0.01 * bias
    close(second_order.mean(), bias, atol=4 * standard_error + 5 * a * bias)


def test_correlated_noise_bends_the_bias_of_crossed_cameras() -> None:
    # strongly verged and rolled, so that correlation ties the depth to the residual: a tenth of the bias
    rig = StereoRig(PLAIN, PLAIN, Pose.from_rotvec((0.0, -0.8, 1.0), (-1.5, 0.0, 0.6)))
    point = np.array([[0.785, -0.446, 1.103]])
    noise = PixelNoise(5.0, correlation=0.9)
    uv_left, uv_right = (np.repeat(uv, SAMPLES, axis=0) for uv in rig.project(point))
    noisy_left, noisy_right = noise.apply(uv_left, uv_right, np.random.default_rng(6))
    error = triangulate(rig, noisy_left, noisy_right) - point
    linear = np.hstack([noisy_left - uv_left, noisy_right - uv_right]) @ pixel_gain(rig, point)[0].T
    second_order = (error - linear)[:, 2]
    bias = predict_depth_bias(rig, point, noise)[0]
    room = 4 * second_order.std() / math.sqrt(SAMPLES)
    assert room < 0.04 * bias
    close(second_order.mean(), bias, atol=room)


@pytest.mark.parametrize("kind", RIGS)
def test_simulated_rmse_is_the_predicted(kind: str) -> None:
    rig, point, noise, error, _ = simulated(kind, 0.0, 0.06)
    rmse, left_out = predict_depth_rmse(rig, point, noise)
    simulated_rmse = math.sqrt((error[:, 2] ** 2).mean())
    room = 4 * math.sqrt(0.5 / SAMPLES) * 1.1
    close(simulated_rmse, rmse[0] + left_out[0], rtol=room)
    # first order alone is seen to be too small
    assert simulated_rmse > predict_depth_std(rig, point, noise)[0] * (1 + room)


def test_the_series_of_the_inverse() -> None:
    # the bias as a principal value exactly: sqrt(2) r Dawson(r / sqrt 2) - 1, r = d / sigma_d
    for r in (20.0, 40.0):
        exact = math.sqrt(2) * r * dawsn(r / math.sqrt(2)) - 1
        noise = PixelNoise(20.0 / r / math.sqrt(2))
        close(predict_depth_bias(RIG, POINT, noise)[0] / 4, exact, rtol=4 / r**2)
    # E[(1/(1+e) - 1)^2], e normal: a + 9 a^2 + 75 a^3 + ..., by Gauss-Hermite
    x, weights = np.polynomial.hermite_e.hermegauss(60)
    for s in (0.02, 0.05):
        a = s**2
        exact = (weights * (1 / (1 + s * x) - 1) ** 2).sum() / weights.sum()
        close(exact, a + 9 * a**2 + 75 * a**3, rtol=1000 * a**3)


def test_bounds_by_hand() -> None:
    # a disparity of 20 px off by 4: 80/24 and 80/16
    near, far = depth_bounds(RIG, POINT, 4.0)
    close([near[0], far[0]], [80 / 24, 5.0])
    near, far = depth_bounds(RIG, np.repeat(POINT, 3, axis=0), [0.0, 20.0, 30.0])
    close(near, [4.0, 2.0, 1.6])
    close(far, [4.0, math.inf, math.inf])


@pytest.mark.parametrize("kind", RIGS)
def test_bounds_are_the_first_and_last_depth_whose_images_lie_within_the_error(kind: str) -> None:
    rig, error = RIGS[kind], 1.5
    points = points_in_view(rig, 3, 1.0, 4.0, seed=5)
    for point, near, far in zip(points, *depth_bounds(rig, points, error), strict=True):
        seen = np.hstack(rig.project(point[None]))[0]

        def off(z: float, point: Array = point, seen: Array = seen) -> float:
            """Least distance, px, between `seen` and the images of a point at depth z."""

            def residual(xy: Array) -> Array:
                return np.hstack(rig.project([[*(xy * z), z]]))[0] - seen

            found = least_squares(residual, point[:2] / point[2], xtol=1e-15, ftol=1e-15, gtol=1e-15)
            return float(np.linalg.norm(found.fun))

        assert near < point[2] < far
        for bound in (near, far):
            close(off(bound), error / math.sqrt(2), rtol=1e-6)
            assert off(bound + 0.01 * (point[2] - bound)) < error / math.sqrt(2)


@given(rigs(distorted=True), SEEDS)
def test_bounds_are_one_standard_deviation_away(rig: StereoRig, seed: int) -> None:
    # one definition: near and far bound and std of seen pixels, whatever the lenses
    points = points_in_view(rig, 10, 1.0, 5.0, seed)
    noise = PixelNoise(1e-4)
    near, far = depth_bounds(rig, points, noise.disparity_std_px)
    std = predict_depth_std(rig, points, noise)
    close(points[:, 2] - near, std, rtol=2e-3)
    close(far - points[:, 2], std, rtol=2e-3)


def test_bounds_of_a_zoomed_right_camera_by_hand() -> None:
    # f 800 and 2400 px, B 0.1 m: x moves by dx, the right image by 2400 (dx - B dq); the least of
    # (800 dx)^2 + (2400 (dx - B dq))^2 over dx is (2400 B dq)^2 / 10, and r is 2 / sqrt(2)
    zoomed = Intrinsics.from_focal(1280, 960, 2400.0)
    rig = StereoRig.rectified(PLAIN, 0.1, right=zoomed)
    dq = math.sqrt(2) * math.sqrt(10) / 240
    near, far = depth_bounds(rig, [[0.1, 0.02, 5.0]], 2.0)
    close([near[0], far[0]], [1 / (0.2 + dq), 1 / (0.2 - dq)])
    assert depth_bounds(rig, [[0.1, 0.02, 5.0]], 30.0)[1][0] == math.inf


@pytest.mark.parametrize("kind", ["verged", "forward", "rolled", "unequal", "distorted"])
def test_parallax_is_the_way_to_infinity(kind: str) -> None:
    rig = RIGS[kind]
    points = points_in_view(rig, 50, 1.0, 5.0)
    infinity = rig.project(points * 1e9)[1]
    expected = np.linalg.norm(rig.project(points)[1] - infinity, axis=1)
    close(parallax_px(rig, points), expected, rtol=1e-6)


def test_a_ray_that_ends_behind_the_right_camera_has_no_far_limit() -> None:
    rig = StereoRig.verged(PLAIN, 0.2, 120.0)
    ahead = np.array([[0.07, 0.0, 0.1]])
    assert np.isfinite(rig.project(ahead)[1]).all()
    assert (rig.right_from_left.R @ ahead[0])[2] < 0
    close(parallax_px(rig, ahead), [math.inf])
    near, far = depth_bounds(rig, ahead, 500.0)
    assert 0 <= near[0] < 0.1 < far[0] < math.inf


def test_behind_a_camera_nothing_is_predicted() -> None:
    rig, noise = RIGS["forward"], PixelNoise(0.2)
    points = np.array([[0.0, 0.0, 0.2], [0.0, 0.0, -1.0], [np.nan, 0.0, 1.0]])
    for values in (
        predict_depth_std(rig, points, noise),
        predict_depth_bias(rig, points, noise),
        *predict_depth_rmse(rig, points, noise),
        parallax_px(rig, points),
        *depth_bounds(rig, points, 1.0),
    ):
        assert values.shape == (3,)
        assert np.isnan(values).all()
    assert np.isnan(predict_covariance(rig, points, noise)).all()
    assert predict_covariance(rig, np.empty((0, 3)), noise).shape == (0, 3, 3)


def test_wrong_input_is_named() -> None:
    with pytest.raises(InvalidRange, match="disparity error -1 px: must be >= 0"):
        depth_bounds(RIG, POINT, -1.0)
    with pytest.raises(InvalidRange, match="disparity error nan px: must be >= 0"):
        depth_bounds(RIG, POINT, math.nan)
    with pytest.raises(InvalidRange, match=r"points of shape \(3,\): must be \(N, 3\)"):
        predict_depth_std(RIG, POINT[0], PixelNoise(0.1))


def test_depth_in_sigmas_is_disparity_over_its_noise_when_rectified() -> None:
    # f 1000 px, B 0.1 m, Z 5 m: d = 20 px; 0.5 px a coordinate makes 0.5 sqrt(2) of disparity
    rig = StereoRig.rectified(Intrinsics.from_focal(1280, 720, 1000.0), 0.1)
    found = depth_in_sigmas(rig, [[0.3, -0.2, 5.0]], PixelNoise(0.5))
    np.testing.assert_allclose(found, [20 / (0.5 * math.sqrt(2))], rtol=1e-12)
    assert depth_in_sigmas(rig, [[0.0, 0.0, 5.0]], PixelNoise(0.0))[0] == math.inf


def test_depth_in_sigmas_counts_both_lenses_and_correlation() -> None:
    # right camera zoomed three times: its ray is three times as certain, so sigma_d = s sqrt(1 + 1/9)
    # of the left camera's pixels; a correlation of 0.5 takes s^2 (1 + 1/9 - 2 * 0.5 / 3)
    left, right = Intrinsics.from_focal(1280, 720, 1000.0), Intrinsics.from_focal(1280, 720, 3000.0)
    pose = StereoRig.rectified(left, 0.1).right_from_left
    rig = StereoRig(left, right, pose)
    alone = depth_in_sigmas(rig, [[0.05, 0.0, 5.0]], PixelNoise(0.5))
    np.testing.assert_allclose(alone, [20 / (0.5 * math.sqrt(1 + 1 / 9))], rtol=1e-9)
    together = depth_in_sigmas(rig, [[0.05, 0.0, 5.0]], PixelNoise(0.5, correlation=0.5))
    np.testing.assert_allclose(together, [20 / (0.5 * math.sqrt(1 + 1 / 9 - 1 / 3))], rtol=1e-9)


def test_nothing_is_predicted_where_nothing_is_seen() -> None:
    # k1 = -.3 folds at r^2 = 1/.9: x/z = 1.06 is the last that neither camera shows, and behind is behind
    lens = Intrinsics.from_focal(640, 480, 300.0, lens=BrownConrady(k1=-0.3))
    rig = StereoRig.rectified(lens, 0.1)
    points = np.array([[0.2, 0.1, 2.0], [2.4, 0.0, 2.0], [-2.05, 0.0, 2.0], [0.0, 0.0, -1.0]])
    noise = PixelNoise(0.25)
    unseen = np.isnan(np.concatenate(rig.project(points), axis=1)).any(axis=1)
    assert unseen.tolist() == [False, True, True, True]
    for told in (
        predict_covariance(rig, points, noise)[:, 2, 2],
        predict_depth_std(rig, points, noise),
        predict_depth_bias(rig, points, noise),
        predict_depth_rmse(rig, points, noise)[0],
        rig.jacobian(points).sum(axis=(1, 2)),
    ):
        assert np.isnan(told).tolist() == unseen.tolist()
