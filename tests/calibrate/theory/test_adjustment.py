"""Least squares of board corners: exact ones give the rig back, noisy ones what OpenCV finds."""

from __future__ import annotations

import numpy as np
import pytest

from rigsim.pixels.calibration.stereo import calibrate_stereo
from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.witness.bench import change_of
from rigsim.theory.calibration.adjust import adjust
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.information import board_information
from rigsim.theory.calibration.parameters import RigParameters
from tests.helpers.calibrate.board_pictures import RIG, boards_in_view

BOARD = Board(7, 5, 0.03)
PARAMETERS = RigParameters.of((BrownConrady, BrownConrady))


def bent_rig() -> StereoRig:
    change = np.zeros(len(PARAMETERS.names))
    change[[4, 5, 6, 7, 8]] = -0.2, 0.05, 1e-3, -5e-4, 0.01
    change[[13, 14, 15]] = -0.18, 0.03, 5e-4
    return PARAMETERS.moved(RIG, change)


def a_little_off(rig: StereoRig, poses: BoardPoses, seed: int) -> tuple[StereoRig, BoardPoses]:
    rng = np.random.default_rng(seed)
    scale = np.array([5.0] * 4 + [0.02, 0.02, 1e-3, 1e-3, 0.02])
    change = np.concatenate([scale, scale, [0.01] * 3, [0.005] * 3]) * rng.standard_normal(24)
    moves = rng.standard_normal((len(poses), 6)) * ([0.02] * 3 + [0.01] * 3)
    return PARAMETERS.moved(rig, change), poses.moved(moves)


def test_exact_corners_give_the_rig_back_from_a_start_that_is_off() -> None:
    true = bent_rig()
    poses = boards_in_view(true, BOARD, 8, 1, (0.3, 0.6))
    found = adjust(*_start(true, poses), poses.project(true, BOARD))
    assert found.settled
    assert found.rms_px < 1e-7
    assert change_of(PARAMETERS, true, found.rig) == pytest.approx(0, abs=1e-6)
    assert found.poses.t == pytest.approx(poses.t, rel=1e-6, abs=1e-8)


def _start(true: StereoRig, poses: BoardPoses) -> tuple[StereoRig, RigParameters, Board, BoardPoses]:
    rig, moved = a_little_off(true, poses, 0)
    return rig, PARAMETERS, BOARD, moved


def test_noisy_corners_give_what_opencv_finds() -> None:
    true = bent_rig()
    poses = boards_in_view(true, BOARD, 10, 2, (0.3, 0.6))
    exact = poses.project(true, BOARD)
    noisy = exact + 0.1 * np.random.default_rng(5).standard_normal(exact.shape)
    observed = noisy.astype(np.float32).astype(np.float64)  # as OpenCV reads them
    own = adjust(true, PARAMETERS, BOARD, poses, observed)
    theirs = calibrate_stereo(BOARD, observed, ((640, 480), (640, 480)), PARAMETERS.lenses, start=true)
    # theirs is of a corner's distance, own of one coordinate
    assert own.rms_px * np.sqrt(2) == pytest.approx(theirs.rms_px, rel=1e-5)
    apart = change_of(PARAMETERS, own.rig, theirs.rig)
    assert np.abs(apart / (0.1 * _std(true, poses))).max() < 1e-3
    # where their rig is, there is no lower place by what can be said of it in doubles
    held = RigParameters.of(PARAMETERS.lenses, fix=("focal", "principal", "lens", "pose"))
    there = adjust(theirs.rig, held, BOARD, own.poses, observed)
    assert there.rms_px == pytest.approx(own.rms_px, rel=1e-9)


def _std(rig: StereoRig, poses: BoardPoses) -> Array:
    told = board_information(rig, PARAMETERS, BOARD, poses).reduced.sum(axis=0)
    return np.asarray(np.sqrt(np.diagonal(np.linalg.inv(told))))


def test_what_is_held_stays_and_warps_are_found() -> None:
    parameters = RigParameters.of((None, None), fix=("aspect", "right.cx"), warped=True)
    warped = Board(7, 5, 0.03, (0.002, -0.001))
    poses = boards_in_view(RIG, warped, 8, 4, (0.3, 0.6))
    start = parameters.moved(RIG, np.array([4.0, 4.0 * RIG.left.fy / RIG.left.fx, *[0.0] * 14]))
    found = adjust(start, parameters, BOARD, poses, poses.project(RIG, warped))
    assert found.board.warp_m == pytest.approx(warped.warp_m, abs=1e-8)
    assert found.rig.left.fx == pytest.approx(RIG.left.fx, abs=1e-5)
    assert found.rig.left.fy / found.rig.left.fx == pytest.approx(RIG.left.fy / RIG.left.fx, rel=1e-12)
    assert found.rig.right.cx == RIG.right.cx


def test_boards_that_one_camera_sees_count() -> None:
    """Their corners make that camera surer, and are no misfit."""
    poses = boards_in_view(RIG, BOARD, 8, 6, (0.3, 0.6))
    parameters = RigParameters.of((None, None))
    exact = poses.project(RIG, BOARD)
    rng = np.random.default_rng(7)
    observed = exact + 0.05 * rng.standard_normal(exact.shape)
    observed[4:, 1] = np.nan
    found = adjust(RIG, parameters, BOARD, poses, observed)
    fewer = adjust(RIG, parameters, BOARD, poses.chosen(slice(0, 4)), observed[:4])
    assert found.settled
    assert np.isnan(found.residuals[4:, 1]).all()
    assert np.isfinite(found.residuals[4:, 0]).all()
    std, std_of_fewer = (
        np.sqrt(np.diagonal(np.linalg.inv(one.information.reduced.sum(axis=0)))) for one in (found, fewer)
    )
    assert (std[:4] < 0.8 * std_of_fewer[:4]).all()
