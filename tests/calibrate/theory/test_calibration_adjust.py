"""Least squares, and what its covariance says of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import rotvec_from_rotation
from rigsim.rig.stereo import StereoRig
from rigsim.theory.calibration.adjust import Adjusted, adjust
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.covariance import covariance_of
from rigsim.theory.calibration.flatness import warp_moves, with_warps, without_warps
from rigsim.theory.calibration.information import board_information
from rigsim.theory.calibration.parameters import RigParameters
from tests.helpers.calibrate.board_rigs import BOARD, ESTIMATED, RIG, held, with_noise

PLAIN = StereoRig(replace(RIG.left, lens=None), replace(RIG.right, lens=None), RIG.right_from_left)
PINHOLES = RigParameters.of((None, None))
SMALL = Board(5, 4, 0.06)


def errors(found: Adjusted, rig: StereoRig, parameters: RigParameters, poses: BoardPoses) -> Array:
    """Found minus true: the rig's parameters, and the boards' mean motion in the left camera's frame."""
    off = np.zeros(len(parameters.names) + 6)
    for side, (camera, true) in enumerate(((found.rig.left, rig.left), (found.rig.right, rig.right))):
        off[parameters.columns(side)] = _numbers(camera) - _numbers(true)
    relative = found.rig.right_from_left.R @ rig.right_from_left.R.T
    off[parameters.pose] = [
        *rotvec_from_rotation(relative),
        *(found.rig.right_from_left.t - rig.right_from_left.t),
    ]
    turns = found.poses.R @ poses.R.transpose(0, 2, 1)
    shifts = found.poses.t - np.einsum("nij,nj->ni", turns, poses.t)
    off[-6:-3] = np.mean([rotvec_from_rotation(turn) for turn in turns], axis=0)
    off[-3:] = shifts.mean(axis=0)
    return off


def _numbers(camera: Intrinsics) -> Array:
    lens = camera.lens
    own = [] if lens is None else [getattr(lens, name) for name in lens.names()]
    return np.array([camera.fx, camera.fy, camera.cx, camera.cy, *own])


def test_exact_corners_give_the_rig_back() -> None:
    poses = held(10, 2)
    observed = poses.project(RIG, BOARD)
    off = 0.02 * np.random.default_rng(0).standard_normal(len(ESTIMATED.names)) * ESTIMATED.free
    off[:4] *= 200
    off[9:13] *= 200
    nearby = np.random.default_rng(1).normal(0, 0.01, (10, 6))
    found = adjust(ESTIMATED.moved(RIG, off), ESTIMATED, BOARD, poses.moved(nearby), observed)
    assert found.settled
    assert found.rms_px < 1e-8
    np.testing.assert_allclose(errors(found, RIG, ESTIMATED, poses), 0, atol=1e-5)


def test_a_board_that_one_camera_sees_tells_of_that_camera() -> None:
    poses = held(10, 2)
    observed = poses.project(RIG, BOARD)
    observed[:3, 0], observed[3:5, 1] = np.nan, np.nan
    found = adjust(RIG, ESTIMATED, BOARD, poses.moved(np.full((10, 6), 0.003)), observed)
    np.testing.assert_allclose(errors(found, RIG, ESTIMATED, poses), 0, atol=1e-5)


def test_the_warp_of_a_board_is_found() -> None:
    bent, parameters = replace(BOARD, warp_m=(0.002, -0.0015)), with_warps(ESTIMATED)
    parameters = RigParameters.of(parameters.lenses, fix=("k3",), warped=True)
    poses = held(10, 2)
    found = adjust(RIG, parameters, BOARD, poses, poses.project(RIG, bent))
    np.testing.assert_allclose(found.board.warp_m, bent.warp_m, rtol=1e-4)


def test_calibrations_scatter_as_their_covariance_says() -> None:
    """All of it at once, the boards' frame included: ``e^T S^-1 e`` over its degrees of freedom is 1."""
    poses, noise_px, count = held(6, 8, board=SMALL), 0.1, 150
    told = board_information(PLAIN, PINHOLES, SMALL, poses)
    expected = covariance_of(PLAIN, PINHOLES, poses, told, noise_px)
    scale = expected.std
    inverse = np.linalg.inv(expected.correlation)
    scatter = []
    for seed in range(count):
        observed = with_noise(poses, PLAIN, SMALL, noise_px, seed)
        off = errors(adjust(PLAIN, PINHOLES, SMALL, poses, observed), PLAIN, PINHOLES, poses) / scale
        scatter.append(off)
    squares = np.einsum("ni,ij,nj->n", np.array(scatter), inverse, np.array(scatter)) / len(scale)
    # 20 numbers, 150 times: within 3 of its standard deviations
    assert squares.mean() == pytest.approx(1.0, abs=3 * np.sqrt(2 / len(scale) / count))
    np.testing.assert_allclose(np.std(scatter, axis=0), 1.0, atol=0.25)
    # the frame moves with the rig, to the side that the covariance says
    together = np.corrcoef(np.array(scatter).T)
    strong = np.abs(expected.correlation) > 0.7
    assert (together * expected.correlation > 0)[strong].all()


def test_a_board_taken_for_flat_leads_astray_as_first_order_says() -> None:
    poses, rise = held(8, 4), np.array([2e-5, -1e-5])
    parameters = with_warps(ESTIMATED)
    told = board_information(RIG, parameters, BOARD, poses)
    per_px = covariance_of(RIG, ESTIMATED, poses, without_warps(told), 1.0)
    expected = warp_moves(per_px, poses, told) @ rise
    bent = replace(BOARD, warp_m=(float(rise[0]), float(rise[1])))
    found = adjust(RIG, ESTIMATED, BOARD, poses, poses.project(RIG, bent))
    off = errors(found, RIG, ESTIMATED, poses)
    np.testing.assert_allclose(off, expected, atol=0.02 * np.abs(expected).max(), rtol=0)
    np.testing.assert_allclose(off[-6:], expected[-6:], rtol=0.05, atol=1e-7)
    free = expected != 0
    np.testing.assert_allclose(
        off[free] / per_px.std[free], expected[free] / per_px.std[free], rtol=0.05, atol=1e-4
    )


def test_parameters_with_warps_are_those_and_two_more() -> None:
    wider = with_warps(ESTIMATED)
    assert wider.names == (*ESTIMATED.names, "warp_x_m", "warp_y_m")
    assert wider.warp == slice(len(ESTIMATED.names), len(ESTIMATED.names) + 2)
    assert wider.lenses == (BrownConrady, BrownConrady)
    assert with_warps(wider) is wider
