"""A pair of one's own: points by hand, broken pairs, and truths that mean something else."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.subjects.checker_images import board_homography, board_image
from rigsim.errors import InvalidImage, InvalidRange, MeasurementFailed
from rigsim.present.measure.words import sentence
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from rigsim.study.measure.result import PairMeasurement
from rigsim.study.measure.rows import is_misaligned, row_verdict
from rigsim.study.measure.run import Wanted, measure_pair
from rigsim.study.measure.truth import truth_at
from tests.helpers.textured_images import Pair, Waves, affine_pair, noisy, plane_pair

SIZE = {"width": 200, "height": 150}
NAN = float("nan")


def flat(seed: int = 1, **options: float) -> Pair:
    """A wall 2 m away: f 400 px, baseline 100 mm, disparity 20 px."""
    return affine_pair(seed, **SIZE, **options)


def measured(pair: Pair, right: Array | None = None, **options) -> PairMeasurement:
    truth = options.pop("truth", None)
    left, right = noisy(pair.left, 1.0, 0), noisy(pair.right if right is None else right, 1.0, 1)
    return measure_pair(left, right, pair.rig, Wanted(**{"matcher": None, **options}), truth=truth)


def truth_of(pair: Pair) -> Array:
    return np.broadcast_to(pair.disparity, pair.left.shape).copy()


def keys(result: PairMeasurement) -> set[str]:
    return {finding.key for finding in result.findings}


def said(result: PairMeasurement, key: str) -> str:
    (says,) = (sentence(finding, result.rig) for finding in result.findings if finding.key == key)
    return says


# --- points and their predicted accuracy --------------------------------------------------------


def test_a_wall_is_where_the_formula_says():
    patches = measured(flat()).patches
    # Z = f b / d = 400 * 0.1 / 20 = 2 m, at pixel (u, v): X = (u - 99.5) Z / 400
    assert patches.n > 100
    assert np.median(patches.points_left[:, 2]) == pytest.approx(2.0, abs=1e-3)
    u = patches.uv_left[:, 0]
    np.testing.assert_allclose(patches.points_left[:, 0], (u - 99.5) * patches.points_left[:, 2] / 400)
    # sigma_Z = Z^2 / (f b) sigma_d
    z = patches.points_left[:, 2]
    np.testing.assert_allclose(patches.depth_std_m, z**2 / 40 * patches.disparity_std_px, rtol=1e-6)


def test_an_offset_of_the_principal_points_moves_depth_but_is_no_disparity():
    pair = flat(doffs=5.0)
    result = measured(pair, truth=truth_of(pair))
    # Z = f b / (d + doffs) = 40 / 25
    assert np.median(result.patches.points_left[:, 2]) == pytest.approx(1.6, abs=1e-3)
    assert abs(result.patches.errors.errors.mean_px) < 0.01
    assert np.nanmedian(np.abs(result.patches.depth_error_m)) < 1e-3
    assert not result.findings


def test_the_depth_error_is_that_of_the_disparity():
    pair = flat()
    patches = measured(pair, truth=truth_of(pair) - 2.0).patches
    # 20 px where 18 are true: 40/20 - 40/18 m, too near
    assert np.median(patches.depth_error_m) == pytest.approx(40 / 20 - 40 / 18, abs=2e-3)


@pytest.mark.parametrize("std", [1.0, 4.0])
def test_what_is_predicted_is_what_the_truth_finds(std: float):
    pair = flat(a=0.02, b=-0.05)
    result = measure_pair(
        noisy(pair.left, std, 0),
        noisy(pair.right, std, 1),
        pair.rig,
        Wanted(matcher=None),
        truth=truth_of(pair),
    )
    errors = result.patches.errors
    assert errors.within_3_std_pct > 97
    assert errors.outlier_pct == 0
    assert 0.5 < errors.inlier_std_px / result.patches.predicted_rms_px < 1.2
    # a disparity is as uncertain as two coordinates
    assert result.patches.noise_px == pytest.approx(errors.inlier_std_px / math.sqrt(2))
    assert not result.findings


def test_without_a_truth_the_noise_is_the_predicted_one():
    patches = measured(flat()).patches
    assert patches.errors is None
    assert np.isnan(patches.truth_px).all()
    rms = math.sqrt(np.mean(patches.disparity_std_px**2))
    assert patches.noise_px == pytest.approx(rms / math.sqrt(2))


# --- any rig ------------------------------------------------------------------------------------


def test_a_verged_pair_is_rectified_and_its_points_are_the_planes():
    rig = StereoRig.verged(Intrinsics.from_focal(240, 180, 300.0), 0.12, 6.0)
    normal, distance = (0.2, 0.1, 1.0), 1.5
    left, right = plane_pair(rig, 3, normal=normal, distance_m=distance)
    result = measure_pair(left.astype(np.uint8), right.astype(np.uint8), rig)
    n = np.asarray(normal) / np.linalg.norm(normal)
    assert np.median(np.abs(result.patches.points_left @ n - distance)) < 2e-3
    assert result.dense.rectified
    assert result.dense.rig.is_rectified
    assert result.dense.image_left.dtype == np.uint8
    points, known = result.dense.points_left()
    assert known.mean() > 0.6
    off = points @ n - distance
    # a tenth of a pixel is 6 mm here; turned the wrong way, the plane would lean by 0.1 rad
    assert np.median(np.abs(off)) < 0.012
    assert abs(np.polyfit(points[:, 0], off, 1)[0]) < 0.02
    assert result.patches.epipolar_rms_px < 0.1


def test_a_truth_for_a_rig_that_is_not_rectified_judges_matches_alone():
    rig = StereoRig.verged(Intrinsics.from_focal(240, 180, 300.0), 0.12, 6.0)
    left, right = plane_pair(rig, 3, normal=(0, 0, 1), distance_m=1.5)
    v, u = np.mgrid[:180, :240].astype(float)
    uv = np.stack([u, v], axis=-1).reshape(-1, 2)
    rays = np.column_stack([rig.left.normalize(uv), np.ones(len(uv))]) * 1.5
    truth = (uv[:, 0] - rig.project(rays)[1][:, 0]).reshape(180, 240)
    result = measure_pair(left, right, rig, truth=truth)
    assert result.dense.errors is None
    assert "dense_not_judged" in keys(result)
    assert result.patches.errors.errors.n > 100
    assert abs(result.patches.errors.errors.mean_px) < 0.01


# --- broken pairs show --------------------------------------------------------------------------


def test_swapped_pictures_are_refused():
    pair = flat()
    with pytest.raises(MeasurementFailed, match=r"left and right image are swapped: \d+ of \d+ points"):
        measure_pair(pair.right, pair.left, pair.rig)


@pytest.mark.parametrize(("shift", "side"), [(0.5, "too small (too far)"), (-0.5, "too large (too near)")])
def test_half_a_pixel_shows_against_the_truth(shift: float, side: str):
    pair, waves = flat(), Waves.random(1)
    u, v = np.arange(200.0), np.arange(150.0)[:, None]
    right = waves.at(u + 20 - shift, v)
    result = measured(pair, right, truth=truth_of(pair))
    assert result.patches.errors.errors.mean_px == pytest.approx(-shift, abs=0.02)
    says = said(result, "shift")
    assert side in says
    assert "0.50 px" in says
    assert "middles and corners" in says


@pytest.mark.parametrize(("rows", "side"), [(1.0, "1.00 px too low"), (-1.0, "1.00 px too high")])
def test_a_row_too_low_shows_without_any_truth(rows: float, side: str):
    pair, waves = affine_pair(1, **SIZE, highest=0.1), Waves.random(1, highest=0.1)
    u, v = np.arange(200.0), np.arange(150.0)[:, None]
    result = measured(pair, waves.at(u + 20, v - rows))
    assert result.patches.epipolar_rms_px == pytest.approx(1.0, abs=0.1)
    assert result.patches.epipolar_median_px == pytest.approx(rows, abs=0.1)
    says = said(result, "not_rectified")
    number = float(says.split("picture is ")[1].split(" px")[0])
    assert number == pytest.approx(1.0, abs=0.1)
    assert side.split(" px ")[1] in says


@pytest.mark.parametrize(("turn", "word"), [(0.02, " clockwise"), (-0.02, "counter-clockwise")])
def test_a_turned_camera_is_named(turn: float, word: str):
    pair, waves = affine_pair(1, **SIZE, highest=0.1), Waves.random(1, highest=0.1)
    u, v = np.arange(200.0), np.arange(150.0)[:, None]
    # what lies in row v of the left picture lies `turn (u - 99.5)` lower in the right one
    result = measured(pair, waves.at(u + 20, v - turn * (u - 99.5)))
    says = said(result, "not_rectified")
    assert word in says
    assert float(says.split("by about ")[1].split(" deg")[0]) == pytest.approx(math.degrees(0.02), rel=0.2)


def test_a_few_wrong_matches_are_no_fault_of_the_rig():
    patches = measured(flat()).patches
    off = patches.epipolar_px.copy()
    off[::10] = 2.0
    wrong = replace(patches, epipolar_px=off)
    assert wrong.epipolar_rms_px > 0.6
    assert not is_misaligned(wrong)
    assert is_misaligned(replace(patches, epipolar_px=off * 0 - 0.35))


def test_pictures_of_different_things_do_not_pass():
    pair, other = flat(), flat(seed=99)
    try:
        result = measured(pair, other.right)
    except MeasurementFailed:
        return
    assert "few_matches" in keys(result)


# --- the truth ----------------------------------------------------------------------------------


def test_truth_is_interpolated_within_one_surface_only():
    truth = np.array([[10.0, 11.0, NAN, 20.0], [12.0, 13.0, 30.0, 21.0]])
    at = np.array(
        [[0, 0], [1, 1], [0.5, 0.25], [1.5, 0.0], [1.5, 1.0], [3.0, 0.5], [3.2, 0], [-0.1, 0], [2, 1]]
    )
    # (0.5, 0.25): 0.75 * 10.5 + 0.25 * 12.5; then a hole, a step, a column, and beyond both borders
    expected = [10.0, 13.0, 11.0, NAN, NAN, 20.5, NAN, NAN, 30.0]
    np.testing.assert_allclose(truth_at(truth, at), expected)


@pytest.mark.parametrize(
    ("meant", "says"),
    [
        (lambda d: -d, "u_right - u_left: change its sign"),
        (lambda d: d + 5.0, "doffs added"),
        (lambda d: 40 / (d + 5.0), "depth in metres"),
        (lambda d: 40e3 / (d + 5.0), "depth in millimetres"),
        (lambda d: d + 50.0, "belongs to other pictures"),
    ],
)
def test_a_truth_that_means_something_else_is_recognised(meant, says: str):
    pair = flat(doffs=5.0)
    result = measured(pair, truth=meant(truth_of(pair)))
    assert says in said(result, "wrong_truth")


def test_unknown_truth_counts_for_nothing():
    pair = flat()
    truth = truth_of(pair)
    truth[:, :100] = np.inf
    result = measured(pair, truth=truth)
    assert np.isnan(result.truth[:, :100]).all()
    known = np.isfinite(result.patches.truth_px)
    assert (result.patches.uv_left[known, 0] >= 100).all()
    assert result.patches.errors.errors.n == known.sum() > 30


# --- dense --------------------------------------------------------------------------------------


def test_a_matcher_that_is_half_a_pixel_off_is_caught():
    pair = flat(doffs=5.0)
    result = measured(pair, truth=truth_of(pair), matcher=lambda left, right, rig: truth_of(pair) + 0.5)
    everywhere = result.dense.errors.regions["all"]
    assert everywhere.mean_px == pytest.approx(0.5)
    assert everywhere.fill_pct == 100
    assert everywhere.n == pair.left.size
    assert "too large (too near) by 0.50 px" in said(result, "dense_shift")
    # 40 / 25.5 m where 40 / 25 m are true
    assert result.dense.errors.depth.z_accuracy_pct == pytest.approx(100 * (25 / 25.5 - 1))
    assert result.dense.errors.depth.rms_mm == pytest.approx(1e3 * (1.6 - 40 / 25.5))


def test_sgbm_finds_the_wall_where_patches_say_it_is():
    pair = flat()
    result = measured(pair, truth=truth_of(pair), matcher="sgbm")
    assert result.dense.errors.regions["non-occluded"].fill_pct > 90
    assert result.dense.errors.regions["all"].median_abs_px < 0.1
    assert not result.findings
    points, known = result.dense.points_left()
    assert len(points) == known.sum()
    assert np.median(points[:, 2]) == pytest.approx(2.0, abs=0.01)
    v, u = np.argwhere(known)[0]
    np.testing.assert_allclose(pair.rig.left.project(points[:1]), [[u, v]], atol=1e-9)


def test_a_flat_target_is_judged_by_itself():
    pair = flat()
    wavy = truth_of(pair) + 0.1 * (-1.0) ** np.arange(200)
    result = measured(pair, matcher=lambda *_: wavy, truth=truth_of(pair), target=(50, 40, 100, 60))
    quality = result.target_quality
    assert quality.distance_mm == pytest.approx(2000, abs=1)
    assert quality.subpixel_rms_px == pytest.approx(0.1, abs=1e-3)
    # 0.1 px at 2 m: 2^2 / 40 * 0.1 m
    assert quality.plane_fit_rms_mm == pytest.approx(10.0, rel=0.01)
    assert abs(quality.z_accuracy_pct) < 0.6


# --- boards -------------------------------------------------------------------------------------


def board_pair(disparity: float = 20.0) -> tuple[Array, Array, StereoRig]:
    """A board of 3 x 4 corners, 20 px a square, at 400 * 0.1 / 20 = 2 m: squares of 100 mm."""
    pictures = [
        board_image(
            [(board_homography((u, 75.0), 20.0, roll=0.05, tilt=0.0), 3, 4)], (150, 200), supersample=4
        )
        for u in (110.0, 110.0 - disparity)
    ]
    rig = StereoRig.rectified(Intrinsics.from_focal(200, 150, 400.0), 0.1)
    return noisy(pictures[0], 0.5, 0), noisy(pictures[1], 0.5, 1), rig


def test_a_board_says_how_large_its_squares_are():
    left, right, rig = board_pair()
    truth = np.full(left.shape, 20.0)
    result = measure_pair(left, right, rig, Wanted(board=(3, 4), matcher=None), truth=truth)
    (fit,) = result.boards
    assert fit.n == 12
    assert fit.distance_m == pytest.approx(2.0, abs=2e-3)
    assert fit.square_m == pytest.approx(0.1, abs=2e-4)
    assert fit.flatness_rms_m < 4e-3
    assert result.corners.epipolar_rms_px < 0.03
    assert np.abs(result.corners.disparity_px - 20).max() < 0.05
    z = result.corners.points_left[:, 2]
    np.testing.assert_allclose(
        result.corners.depth_std_m, z**2 / 40 * result.corners.disparity_std_px, rtol=1e-6
    )


@pytest.mark.parametrize(("rows", "side"), [(1, "low"), (-1, "high")])
def test_corners_alone_will_do_and_their_rows_are_checked(
    rows: int, side: str, monkeypatch: pytest.MonkeyPatch
):
    def nothing(*_: object, **__: object) -> None:
        raise MeasurementFailed("left image: no texture")

    monkeypatch.setattr("rigsim.study.measure.run.match_patches", nothing)
    left, right, rig = board_pair()
    result = measure_pair(left, np.roll(right, rows, axis=0), rig, Wanted(board=(4, 3), matcher=None))
    assert result.patches is None
    assert result.best_matches is result.corners
    assert result.corners.epipolar_median_px == pytest.approx(rows, abs=0.05)
    assert "no texture" in said(result, "no_patches")
    assert f"px too {side}" in said(result, "not_rectified")
    with pytest.raises(MeasurementFailed, match="no texture"):
        measure_pair(left, right, rig, Wanted(matcher=None))


# --- what cannot be measured --------------------------------------------------------------------


def test_the_same_picture_twice_is_no_pair():
    pair = flat()
    with pytest.raises(InvalidImage, match="the same picture"):
        measure_pair(pair.left, pair.left, pair.rig)


@pytest.mark.parametrize(
    ("options", "error", "says"),
    [
        ({"truth": np.zeros((10, 20))}, InvalidImage, "truth of 20 x 10 px: the pictures have 200 x 150"),
        ({"truth": np.full((150, 200), np.inf)}, InvalidImage, "no disparity is known"),
        ({"target": (0, 0, 10, 10)}, InvalidRange, "dense"),
        ({"target": (150, 0, 60, 10), "matcher": "sgbm"}, InvalidRange, "60 x 10 px at 150,0"),
        ({"target": (0, 0, 0, 10), "matcher": "sgbm"}, InvalidRange, "0 x 10 px"),
        ({"board": (6, 9)}, MeasurementFailed, "left image: no checker board of 6 x 9 inner corners"),
        ({"matcher": lambda *_: np.zeros((2, 2))}, MeasurementFailed, "shape"),
    ],
)
def test_what_does_not_fit_is_refused(options, error, says: str):
    with pytest.raises(error, match=says):
        measured(flat(), **options)


def test_a_target_needs_rows_that_correspond():
    rig = StereoRig.verged(Intrinsics.from_focal(200, 150, 400.0), 0.1, 2.0)
    pair = flat()
    with pytest.raises(InvalidRange, match="rectified rig"):
        measure_pair(pair.left, pair.right, rig, Wanted(target=(0, 0, 10, 10)))


# --- conclusions ----------------------------------------------------------------------------------


def far_wall(rows: int, along: int = 0) -> PairMeasurement:
    """A wall measured with the right picture so many rows too low and so many columns too far left."""
    pair = flat(seed=3)
    return measured(pair, np.roll(pair.right, (rows, -along), axis=(0, 1)))


@pytest.mark.parametrize(("rows", "side"), [(10, "low"), (-10, "high"), (15, "low")])
def test_a_shift_of_many_rows_is_found_and_told(rows: int, side: str):
    # 150 rows: 15 are a tenth; rows further than 3 px off hardly match at all
    try:
        result = far_wall(rows)
    except MeasurementFailed as error:
        says = str(error)
    else:
        assert result.verdicts[0].kind == "flagged"
        says = said(result, "not_rectified")
    number, rest = says.split("right picture is ")[1].split(" px too ")[:2]
    assert float(number) == pytest.approx(abs(rows), abs=0.05)
    assert rest.startswith(side)
    # atan(10 / 400) = 1.43 deg, atan(15 / 400) = 2.15 deg; a picture that is too low looks up
    turn = math.degrees(math.atan(abs(rows) / 400))
    assert f"looked {'up' if rows > 0 else 'down'} by {turn:.2g} deg" in says
    assert f"cy in the rig were {float(number):.2f} px too {'small' if rows > 0 else 'large'}" in says


def test_a_third_of_a_row_is_flagged_and_none_is_not():
    pair, waves = flat(), Waves.random(1)
    u, v = np.arange(200.0), np.arange(150.0)[:, None]
    shifted = measured(pair, waves.at(u + 20, v - 0.3))
    assert shifted.verdicts[0].kind == "flagged"
    number = float(said(shifted, "not_rectified").split("picture is ")[1].split(" px too low")[0])
    assert number == pytest.approx(0.3, abs=0.03)
    assert measured(pair).verdicts[0].key == "rows_fit"


def test_what_rows_cannot_tell_is_said_to_be_open():
    result = far_wall(0, along=8)
    rows, along = result.verdicts
    assert rows.kind == "agrees"
    assert along.kind == "untold"
    assert "shifted along its rows" in sentence(along, result.rig)
    # 28 px of disparity instead of 20: 1.43 m instead of 2
    assert np.median(result.patches.points_left[:, 2]) == pytest.approx(40 / 28, abs=1e-3)
    pair = flat()
    assert measured(pair, truth=truth_of(pair)).verdicts[1].kind == "agrees"


@pytest.mark.parametrize(
    ("side_mm", "kind", "word"),
    [(100.0, "agrees", "no shift"), (90.0, "flagged", "large"), (110.0, "flagged", "small")],
)
def test_squares_of_a_known_side_tell_the_scale(side_mm: float, kind: str, word: str):
    left, right, rig = board_pair()
    result = measure_pair(left, right, rig, Wanted(board=(3, 4), square_m=side_mm / 1e3, matcher=None))
    along = result.verdicts[1]
    assert along.kind == kind
    assert word in sentence(along, result.rig)
    if kind == "flagged":
        # 100 mm read where 90 are true: 11 % too far, as 20 px of disparity less 2.2 px would be
        off = abs(100 / side_mm - 1)
        assert f"{100 * off:.2g} % too" in sentence(along, result.rig)
        assert float(sentence(along, result.rig).split("by some ")[1].split(" px")[0]) == pytest.approx(
            20 * off, rel=0.05
        )


def test_a_few_matches_are_not_enough_to_tell():
    patches = measured(flat()).patches
    few = replace(patches, n_tried=20 * patches.n)
    verdict = row_verdict(few, flat().rig)
    assert verdict.kind == "untold"
    assert verdict.key == "rows_untold"


def test_swapped_pictures_are_not_called_swapped_for_certain():
    # 60 px to the right: a disparity of -40, behind the cameras
    pair, waves = flat(), Waves.random(1)
    right = waves.at(np.arange(200.0) + 20 - 60, np.arange(150.0)[:, None])
    with pytest.raises(MeasurementFailed, match="shifted along its rows"):
        measured(pair, right)
