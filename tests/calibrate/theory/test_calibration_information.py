"""What boards tell of a rig: derivatives by differences, and information that adds up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import rigsim
from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.rig.lens.lens import Lens
from rigsim.rig.stereo import StereoRig
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.information import board_information, slopes
from rigsim.theory.calibration.parameters import RigParameters
from tests.helpers.calibrate.board_rigs import BOARD, ESTIMATED, RIG, held

LENSES: tuple[Lens | None, ...] = (
    None,
    rigsim.BrownConrady(-0.1, 0.05, 0.001, -0.002, 0.003),
    rigsim.Rational(
        -0.2, 0.06, 0.001, -0.001, 0.004, 0.1, 0.01, 0.003, 0.001, -0.001, 0.002, 0.001, 0.02, 0.01
    ),
    rigsim.KannalaBrandt(0.01, -0.003, 0.0005, -0.0001),
    rigsim.Mei(0.9, -0.2, 0.03, 0.0007, -0.0009),
    rigsim.DoubleSphere(-0.2, 0.55),
    rigsim.Eucm(0.59, 1.13),
    rigsim.FieldOfView(0.8),
)


def with_lenses(lens: Lens | None) -> tuple[StereoRig, RigParameters]:
    rig = StereoRig(replace(RIG.left, lens=lens), replace(RIG.right, lens=lens), RIG.right_from_left)
    model = None if lens is None else type(lens)
    return rig, RigParameters.of((model, model), warped=True)


@pytest.mark.parametrize("lens", LENSES, ids=lambda lens: "none" if lens is None else lens.model)
def test_slopes_are_what_a_small_change_does_to_the_pixels(lens: Lens | None) -> None:
    rig, parameters = with_lenses(lens)
    board, poses = replace(BOARD, warp_m=(0.002, -0.001)), held(3)
    by_rig, by_pose = slopes(rig, parameters, board, poses)

    def seen(change: Array) -> Array:
        return poses.project(parameters.moved(rig, change), parameters.warped_board(board, change))

    for k, name in enumerate(parameters.names):
        step = np.zeros(len(parameters.names))
        step[k] = 1e-3 if name.partition(".")[2] in ("fx", "fy", "cx", "cy") else 1e-6
        expected = (seen(step) - seen(-step)) / (2 * step[k])
        np.testing.assert_allclose(by_rig[..., k], expected, rtol=2e-5, atol=2e-4, err_msg=name)
    for k in range(6):
        step = np.zeros((3, 6))
        step[:, k] = 1e-6
        moved = [poses.moved(way * step).project(rig, board) for way in (1, -1)]
        np.testing.assert_allclose(by_pose[..., k], (moved[0] - moved[1]) / 2e-6, rtol=2e-5, atol=2e-4)


def test_a_board_tells_as_much_as_its_corners_do_when_its_pose_is_thrown_away() -> None:
    """The Schur complement against the inverse of the whole information of one board and a known prior."""
    poses = held(1, 5)
    told = board_information(RIG, ESTIMATED, BOARD, poses)
    prior = np.eye(len(ESTIMATED.names))
    whole = np.block([[told.rig[0] + prior, told.cross[0]], [told.cross[0].T, told.pose[0]]])
    expected = np.linalg.inv(whole)[: len(prior), : len(prior)]
    scale = np.sqrt(np.diagonal(expected))
    found = np.linalg.inv(told.reduced[0] + prior)
    np.testing.assert_allclose(found / scale / scale[:, None], expected / scale / scale[:, None], atol=1e-6)


def test_a_camera_that_does_not_see_a_board_learns_nothing_of_it() -> None:
    poses, seen = held(2), np.array([[True, False], [False, True]])
    told = board_information(RIG, ESTIMATED, BOARD, poses, seen)
    assert not told.rig[0, ESTIMATED.columns(1)].any()
    assert not told.rig[1, ESTIMATED.columns(0)].any()
    assert np.diagonal(told.rig[1])[ESTIMATED.columns(1)][:4].all()
    # where the right camera stands is all thrown away with a pose that it alone sees
    pose = told.reduced[1][ESTIMATED.pose, ESTIMATED.pose]
    assert np.abs(pose).max() < 1e-9 * np.abs(told.rig[1][ESTIMATED.pose, ESTIMATED.pose]).max()


def test_corners_that_are_left_out_count_as_unseen() -> None:
    poses = held(2)
    corners = np.ones((2, 2, BOARD.rows * BOARD.cols), dtype=bool)
    corners[:, :, BOARD.cols :] = False
    told = board_information(RIG, ESTIMATED, BOARD, poses, corners)
    by_rig, by_pose = slopes(RIG, ESTIMATED, BOARD, poses)
    first = by_rig[0, :, : BOARD.cols].reshape(-1, len(ESTIMATED.names))
    np.testing.assert_allclose(told.rig[0], first.T @ first, rtol=1e-12)
    np.testing.assert_allclose(
        told.cross[0], first.T @ by_pose[0, :, : BOARD.cols].reshape(-1, 6), rtol=1e-12
    )


def test_information_is_the_same_in_parts() -> None:
    """So many boards that they are gone through block by block."""
    many = Board(60, 60, 0.004)
    poses = held(30, board=many)
    told = board_information(RIG, ESTIMATED, many, poses)
    one = board_information(RIG, ESTIMATED, many, poses.chosen(slice(29, 30)))
    np.testing.assert_array_equal(told.rig[29], one.rig[0])


def test_poses_come_back_as_their_rows() -> None:
    rows = np.array([[0.1, -0.2, 0.3, 0.01, 0.02, 0.7], [0.0, 0.0, 0.0, 1.0, 2.0, 3.0]])
    np.testing.assert_allclose(BoardPoses.of(rows).rows, rows, atol=1e-15)
    # by hand: a quarter turn about z takes the board's x to the camera's y
    quarter = BoardPoses.of([[0.0, 0.0, np.pi / 2, 0.0, 0.0, 1.0]])
    np.testing.assert_allclose(
        quarter.points_left(np.array([[0.1, 0.0, 0.0]]))[0, 0], [0, 0.1, 1], atol=1e-15
    )
