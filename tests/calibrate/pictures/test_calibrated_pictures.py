"""A rig from corners of boards: what is found, what the others predict of each picture, what is left out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from rigsim.errors import InvalidImage, InvalidRange, MeasurementFailed
from rigsim.present.calibrate.pictures_words import headline
from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.rig.pose import rotation_from_rotvec
from rigsim.study.calibrate.pictures.asked import PicturesAsked
from rigsim.study.calibrate.pictures.at_once import ratios_at_once
from rigsim.study.calibrate.pictures.coverage import coverage
from rigsim.study.calibrate.pictures.fit import fit_rig
from rigsim.study.calibrate.pictures.held_out import held_out
from rigsim.study.calibrate.pictures.order import agreed_order, orders
from rigsim.study.calibrate.pictures.outliers import sort_out, without_suspects
from rigsim.study.calibrate.pictures.result import CalibratedPictures
from rigsim.study.calibrate.pictures.run import calibrate_pictures, duplicates, warp_check
from rigsim.study.calibrate.pictures.sightings import Sightings
from rigsim.theory.triangulation import triangulate
from tests.helpers.calibrate.board_pictures import boards_in_view
from tests.helpers.calibrate.sighted import BOARD, RIG, looked, sightings

ASKED = PicturesAsked(BOARD, following=False)


def calibrated(found: Sightings, asked: PicturesAsked = ASKED) -> CalibratedPictures:
    return calibrate_pictures(asked, looked(found))


def changed(found: Sightings, observed: Array) -> Sightings:
    return replace(found, observed=observed)


def test_the_noise_and_the_rig_are_found() -> None:
    result = calibrated(sightings(14, 0.2))
    assert result.fit.noise_px == pytest.approx(0.2, rel=0.05)  # 3024 coordinates
    # a distance of two coordinates, with 14 * 6 + 24 of 3024 numbers fitted away
    assert result.fit.rms_px == pytest.approx(0.2 * np.sqrt(2 * (1 - 108 / 3024)), rel=0.05)
    assert abs(result.rig.baseline_m - RIG.baseline_m) < 4 * result.baseline_std_m
    assert result.baseline_std_m < 1e-3
    assert {check.verdict for check in result.pictures} == {"good"}
    assert result.verdict == "agrees"
    assert result.ratio == pytest.approx(1, abs=0.1)
    assert [row.z_m for row in result.depths if row.place == "axis"] == [1, 2, 3, 5]


def test_opencv_finds_the_same() -> None:
    result = calibrated(sightings(8, 0.2))
    std = result.covariance.std[result.covariance.names.index("left.fx")]
    assert abs(result.opencv.rig.left.fx - result.rig.left.fx) < 0.01 * std
    assert result.opencv.rms_px == pytest.approx(result.fit.rms_px, rel=1e-4)
    assert "opencv_differs" not in {remark.code for remark in result.remarks}


def test_twice_the_noise_is_twice_every_std() -> None:
    once, twice = (calibrated(sightings(8, noise_px)) for noise_px in (1e-3, 2e-3))
    np.testing.assert_allclose(twice.covariance.std, 2 * once.covariance.std, rtol=0.02, atol=1e-12)


def test_the_others_predict_each_picture() -> None:
    """Observed over predicted, squared: 1 in the mean of 100 pictures that a rig of four others predicts."""
    small, ratios, bare = Board(5, 4, 0.05), [], []
    for seed in range(20):
        fit, _ = fit_rig(sightings(5, 0.3, seed, small), ASKED.parameters)
        ratios += (ratios_at_once(fit) ** 2).tolist()
        check = held_out(fit, seed % 5)
        bare.append(np.sum(check.residuals**2) / (80 - 6) / check.fit.noise_px**2)
    error = np.std(ratios) / np.sqrt(len(ratios))
    assert error < 0.05
    assert abs(np.mean(ratios) - 1) < 3 * error
    # the rig's own error is of weight: noise alone would predict too little
    assert np.mean(bare) > np.mean(ratios) + 2 * error


def test_all_at_once_is_as_one_by_one() -> None:
    for board, close in ((BOARD, 0.005), (Board(5, 4, 0.05), 0.04)):
        fit, _ = fit_rig(sightings(6, 0.2, board=board), ASKED.parameters)
        anew = [held_out(fit, k).ratio for k in range(6)]
        np.testing.assert_allclose(ratios_at_once(fit), anew, rtol=close)
        assert np.ptp(anew) > 0.02


def moved(found: Sightings) -> Array:
    """The board of pair 3 is 2 mm elsewhere, and turned a little, in the right picture."""
    poses = boards_in_view(RIG, BOARD, len(found), seed=7).chosen(np.array([3]))
    elsewhere = poses.moved(np.array([[0.01, 0.0, 0.02, 0.002, -0.002, 0.0]]))
    observed = found.observed.copy()
    observed[3, 1] = elsewhere.project(RIG, BOARD)[0, 1]
    return observed


def hidden(found: Sightings) -> Array:
    observed = found.observed.copy()
    observed[3, 0, 5:8] += (6.0, -4.0)
    return observed


def bent(found: Sightings) -> Array:
    poses = boards_in_view(RIG, BOARD, len(found), seed=7)
    observed = found.observed.copy()
    observed[3] = poses.project(RIG, replace(BOARD, warp_m=(3e-3, 1e-3)))[3]
    return observed


@pytest.mark.parametrize(("spoil", "reason"), [(moved, "moved"), (hidden, "hidden"), (bent, "bent")])
def test_a_bad_picture_is_left_out_and_the_reason_told(
    spoil: Callable[[Sightings], Array], reason: str
) -> None:
    found = sightings(10, 0.1)
    result = calibrated(changed(found, spoil(found)))
    bad = result.pictures[3]
    assert (bad.verdict, bad.reason) == ("outlier", reason)
    assert bad.ratio > 2
    assert {check.verdict for check in result.pictures if check is not bad} == {"good"}
    assert result.fit.noise_px == pytest.approx(0.1, rel=0.08)
    assert result.verdict == "flagged"
    assert "outliers" in {remark.code for remark in result.remarks}


def test_a_suspect_is_named_with_what_it_changes() -> None:
    """A board that slid by a pixel's half between the shots: it counts, and the rig with it is off."""
    found = sightings(14, 0.1)
    observed = found.observed.copy()
    observed[3, 1, :, 0] += 0.55
    result = calibrated(changed(found, observed))
    assert result.pictures[3].verdict == "suspect"
    assert result.verdict == "suspect"
    assert {check.verdict for k, check in enumerate(result.pictures) if k != 3} == {"good"}
    said = headline(result)
    assert f"but 1 suspect: 03 {result.pictures[3].ratio:.2f} times" in said
    assert "as it should be" not in said
    without = result.without_suspects
    assert without is not None
    # what is told is what calibrating without it gives
    rest = calibrated(changed(found, observed).chosen(np.arange(14) != 3))
    assert without.baseline_m == pytest.approx(rest.rig.baseline_m, rel=1e-7)
    moved_by = (rest.rig.baseline_m - result.rig.baseline_m) / result.baseline_std_m
    assert without.baseline_stds == pytest.approx(moved_by, rel=1e-2)
    seen = result.rig.project(np.array([[0.0, 0.0, 3.0]]))
    farther_m = triangulate(rest.rig, *seen)[0, 2] - 3
    assert without.depth_shift_m == pytest.approx(farther_m, rel=1e-2)
    assert max(abs(without.baseline_stds), abs(without.depth_shift_stds)) > 2
    assert without.beyond_chance > 3
    middle = next(row for row in rest.depths if row.place == "axis" and row.z_m == 3)
    # at its own corner noise, which the suspect no longer swells
    assert without.depth_std_m[1] == pytest.approx(middle.calibration_m, rel=1e-4)
    (remark,) = (each for each in result.remarks if each.code == "suspects")
    assert "leave out what was not of one moment" in remark.text


def test_honest_pairs_change_the_rig_as_far_as_is_said() -> None:
    """Left out one by one: both moves over what is foreseen, whose larger is 1.4 in the root mean square."""
    said = []
    for seed in range(8):
        fit, _ = fit_rig(sightings(6, 0.2, seed), ASKED.parameters)
        without = without_suspects(fit, np.arange(6) == seed % 6, fit.covariance, 2.0)
        assert without is not None
        said.append(without.beyond_chance)
    assert 0.6 < np.sqrt(np.mean(np.square(said))) < 2.0


def test_good_pairs_have_nothing_to_leave_out() -> None:
    result = calibrated(sightings(8, 0.2))
    assert result.without_suspects is None
    assert "suspects" not in {remark.code for remark in result.remarks}
    assert headline(result).endswith(", as it should be.")


def test_a_board_bent_beyond_doubt_is_no_plain_yes() -> None:
    found = sightings(8, 0.1, seen=replace(BOARD, warp_m=(1e-4, -3e-5)))
    result = calibrated(found)
    assert {check.verdict for check in result.pictures} == {"good"}
    assert (result.warp.clear, result.verdict) == (True, "suspect")
    assert headline(result).endswith("; the board looks bent.")
    counted = calibrated(found, replace(ASKED, warp=True))
    assert counted.verdict == "agrees"


def test_pairs_that_are_paired_wrongly_agree_on_no_rig() -> None:
    found = sightings(8, 0.1)
    observed = found.observed.copy()
    observed[:, 1] = np.roll(observed[:, 1], 1, axis=0)
    with pytest.raises(MeasurementFailed, match=r"no two of 8 pairs .*: are they paired wrongly, as 00\?"):
        calibrated(changed(found, observed))


def turned_over(found: Sightings, side: int) -> Sightings:
    """As pictures turned by half a turn show it, the board counted from its other end."""
    observed = found.observed.copy()
    observed[:, side] = [1279, 959] - observed[:, side, ::-1]
    return changed(found, observed)


def test_cameras_upside_down_are_told() -> None:
    found = sightings(6, 0.1)
    for side in (0, 1):
        told = {each.code: each.text for each in calibrated(turned_over(found, side)).remarks}
        assert "rolled by 179 deg" in told["upside_down"]  # 1.15 deg of the rig's own
        assert "swapped" not in told
    both = calibrated(turned_over(turned_over(found, 0), 1))
    told = {each.code: each.text for each in both.remarks}
    assert "both upside down" in told["swapped"]
    assert not {"swapped", "upside_down"} & {each.code for each in calibrated(found).remarks}


@pytest.mark.parametrize(
    ("square_m", "says"), [(30.0, "a baseline of 120.1 m comes"), (1.5e-4, "a baseline of 0.6003 mm comes")]
)
def test_a_baseline_out_of_all_proportion_asks_for_the_unit(square_m: float, says: str) -> None:
    found = sightings(6, 0.01)
    board = Board(9, 6, square_m)
    result = calibrated(replace(found, board=board), replace(ASKED, board=board))
    (remark,) = (each for each in result.remarks if each.code == "board_unit")
    assert says in remark.text


def test_a_blurred_picture_is_called_so() -> None:
    found = sightings(10, 0.1)
    observed, claimed = found.observed.copy(), np.full_like(found.claimed_px, 0.1)
    observed[3] += np.random.default_rng(1).normal(0, 0.5, observed[3].shape)
    claimed[3] = 0.45
    result = calibrated(replace(found, observed=observed, claimed_px=claimed))
    assert (result.pictures[3].verdict, result.pictures[3].reason) == ("outlier", "blurred")


def test_pictures_of_different_moments_are_mixed_up() -> None:
    found = sightings(8, 0.1)
    observed = found.observed.copy()
    observed[[2, 5], 1] = observed[[5, 2], 1]
    result = calibrated(changed(found, observed))
    assert [check.verdict for check in result.pictures] == ["good"] * 2 + ["outlier"] + ["good"] * 2 + [
        "outlier"
    ] + ["good"] * 2
    assert result.pictures[2].reason == result.pictures[5].reason == "mixed_up"


@pytest.mark.parametrize("board", [BOARD, Board(8, 6, 0.03), Board(7, 7, 0.03)])
def test_right_corners_are_counted_as_the_left_ones_are(board: Board) -> None:
    found = sightings(8, 0.1, board=board)
    ways = orders(board)
    assert len(ways) == (4 if board.rows == board.cols else 2)
    spoilt = found
    for pair, way in ((1, -1), (4, 1)):
        spoilt = spoilt.reordered(pair, ways[way])
    ordered = agreed_order(spoilt, ASKED.parameters.lenses, ())
    assert ordered.agrees.all()
    assert set(ordered.turned) == {1, 4}
    np.testing.assert_array_equal(ordered.sightings.observed, found.observed)


def test_colours_turn_a_board_without_a_word() -> None:
    found = sightings(8, 0.1)
    # a board of 9 x 6 turned by half a turn shows the other colour first
    spoilt = found.reordered(2, orders(BOARD)[1])
    polarity = np.ones((8, 2), dtype=np.int32)
    polarity[2, 1] = -1
    ordered = agreed_order(replace(spoilt, polarity=polarity), ASKED.parameters.lenses, ())
    assert ordered.turned == ()
    np.testing.assert_array_equal(ordered.sightings.observed, found.observed)


def test_mirrored_pictures_are_told() -> None:
    found = sightings(8, 0.1)
    observed = found.observed.copy()
    observed[:, 1, :, 0] = 1279 - observed[:, 1, :, 0]
    grid = np.arange(54).reshape(6, 9)[:, ::-1].ravel()  # as a finder counts it: from the left
    observed[:, 1] = observed[:, 1, grid]
    with pytest.raises(InvalidImage, match="mirrored against each other: 8 of 8 pairs"):
        calibrated(changed(found, observed))


def test_the_same_pictures_are_told() -> None:
    found = sightings(6, 0.1)
    still = found.observed.copy()
    still[:] = still[0] + np.random.default_rng(0).normal(0, 0.02, still.shape)
    with pytest.raises(InvalidImage, match="at the same place in all 6 pairs"):
        calibrated(changed(found, still))
    one = found.observed.copy()
    one[:, 1] = one[:, 0]
    with pytest.raises(InvalidImage, match="left and right pictures are the same"):
        calibrated(changed(found, one))
    twice = found.observed.copy()
    twice[4] = twice[1]
    assert duplicates(changed(found, twice)).tolist() == [False] * 4 + [True, False]
    result = calibrated(changed(found, twice))
    assert result.pictures[4].verdict == "duplicate"
    assert result.kept.sum() == 5


def test_one_pair_is_too_few() -> None:
    found = sightings(3, 0.1)
    observed = found.observed.copy()
    observed[1:, 1] = np.nan
    with pytest.raises(MeasurementFailed, match=r"1 pair\(s\) show the board in both .* must be >= 2"):
        calibrated(changed(found, observed))


def test_boards_without_tilt_hardly_tell_the_focal_length() -> None:
    flat = boards_in_view(RIG, BOARD, 5, seed=7)
    facing = replace(flat, R=np.array([rotation_from_rotvec(np.array([0, 0, 0.1 * k])) for k in range(5)]))
    found = sightings(5, 0.05)
    shift = np.array([[-0.1, -0.08, 0.6]]) + 0.01 * np.arange(5)[:, None] * np.array([[1, -1, 0.0]])
    observed = replace(facing, t=shift).project(RIG, BOARD)
    noisy = observed + np.random.default_rng(0).normal(0, 0.05, observed.shape)
    result = calibrated(changed(found, noisy), replace(ASKED, model="pinhole"))
    assert "focal_loose" in {remark.code for remark in result.remarks}
    assert "focal_loose" not in {remark.code for remark in calibrated(sightings(5, 0.05)).remarks}


def test_a_picture_of_one_camera_counts_for_it() -> None:
    found = sightings(9, 0.1)
    observed = found.observed.copy()
    observed[2, 1] = np.nan
    observed[3] = np.nan
    result = calibrated(changed(found, observed))
    assert result.pictures[2].verdict == "one_camera"
    assert result.pictures[2].corners == (54, 0)
    assert result.pictures[3].verdict == "not_found"
    assert np.isnan(result.pictures[3].rms_px)
    assert result.kept.sum() == 8
    assert result.pair_count == 7
    assert headline(result).startswith("Rig from 7 pairs and 1 picture of one camera: ")
    codes = {remark.code for remark in result.remarks}
    assert {"one_camera", "not_found"} <= codes


def test_a_bent_board_is_told_from_a_flat_one() -> None:
    flat = calibrated(sightings(8, 0.1))
    assert not flat.warp.significant
    really = replace(BOARD, warp_m=(1e-3, -5e-4))
    bent_board = calibrated(sightings(8, 0.1, seen=really))
    assert bent_board.warp.significant
    assert "warp" in {remark.code for remark in bent_board.remarks}
    estimated = calibrated(sightings(8, 0.1, seen=really), replace(ASKED, warp=True))
    for found, std, true in zip(estimated.warp.rise_m, estimated.warp.std_m, really.warp_m, strict=True):
        assert abs(found - true) < 4 * std < 4e-4
    assert estimated.fit.noise_px < 0.7 * bent_board.fit.noise_px


def test_a_flat_board_looks_bent_as_often_as_is_said() -> None:
    chances = []
    for seed in range(10):
        fit, _ = fit_rig(sightings(4, 0.2, seed), ASKED.parameters)
        chances.append(warp_check(fit).chance)
    assert min(chances) > 1e-3
    assert 0.2 < np.mean(chances) < 0.8


def test_coarse_corners_count_for_less() -> None:
    found = sightings(8, 0.1)
    rng = np.random.default_rng(5)
    weights, observed = found.weights.copy(), found.observed.copy()
    weights[::2] = 0.25  # a level of 2
    observed[::2] += rng.normal(0, 0.1 * np.sqrt(15), observed[::2].shape)
    result = calibrated(replace(found, observed=observed, weights=weights))
    assert result.fit.noise_px == pytest.approx(0.1, rel=0.06)
    assert result.ratio == pytest.approx(1, abs=0.1)
    assert {check.verdict for check in result.pictures} == {"good"}
    blind = calibrated(replace(found, observed=observed))
    assert blind.fit.noise_px > 0.2


def test_coverage_is_counted_in_cells() -> None:
    found = sightings(1, 0.0)
    observed = np.full((1, 2, 54, 2), np.nan)
    observed[0, 0, :3] = [[0.0, 0.0], [159.4, 159.4], [159.6, 0.0]]  # cells of 160 px: edges lie at 159.5
    cells = coverage(changed(found, observed))
    assert cells.left.shape == (6, 8)
    assert cells.left[0].tolist() == [True, True] + [False] * 6
    assert cells.shares == (2 / 48, 0.0)


def test_what_the_pictures_leave_names_the_next_pose() -> None:
    result = calibrated(sightings(5, 0.1), replace(ASKED, following=True))
    assert result.next_pose is not None
    assert 0.3 < result.next_pose.gain < 1


def test_outliers_are_few_or_the_rig_is_wrong() -> None:
    found = sightings(6, 0.1)
    observed = found.observed.copy()
    observed[:4] += np.random.default_rng(2).normal(0, 3, observed[:4].shape)
    ordered = agreed_order(changed(found, observed), ASKED.parameters.lenses, ())
    assert sort_out(ordered, ASKED.parameters, ()).kept.sum() >= 4  # a third at most is left out


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ({"model": "polynomial"}, "lens model 'polynomial': choose one of pinhole, brown"),
        ({"noise_px": -1.0}, "noise -1 px: must be > 0"),
        ({"fix": ("k9",)}, "fix 'k9'"),
        ({"at_m": (0.0,)}, "depth"),
    ],
)
def test_what_cannot_be_asked_is_one_line(words: dict[str, Any], says: str) -> None:
    with pytest.raises(InvalidRange, match=says):
        replace(ASKED, **words)
