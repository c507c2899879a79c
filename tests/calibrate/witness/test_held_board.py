"""A board is drawn where it is held: not mirrored, not upside down, corners where the rig projects them."""

from __future__ import annotations

import numpy as np
import pytest

from rigsim.pixels.corners.boards import BoardCorners, find_sizes, nearest_order, refit
from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.rig.pose import Pose
from rigsim.sim.scenes.held import held_board, hold
from rigsim.sim.simulator import Simulator
from tests.helpers.calibrate.board_pictures import RIG

BOARD = Board(7, 5, 0.03)
"""Of its corner squares two are dark and two light: a mirrored one has them the other way round."""
FRONT = Pose.from_rotvec([0.3, -0.2, 0.1], [-0.1, -0.05, 0.7])
"""Seen from the front: its z points away from the cameras."""
UPSIDE_DOWN = FRONT @ Pose.from_rotvec([0.0, 0.0, np.pi], [0.18, 0.12, 0.0])


@pytest.mark.parametrize("left_from_board", [FRONT, UPSIDE_DOWN], ids=["upright", "upside-down"])
def test_corners_are_where_the_rig_projects_the_boards(left_from_board: Pose) -> None:
    expected = left_from_board.apply(BOARD.points)
    with Simulator(held_board(BOARD, 1.0)) as simulator:
        hold(simulator.scene, RIG, BOARD, left_from_board)
        assert simulator.true_corners().points_left == pytest.approx(expected, abs=1e-9)
        lights = [simulator.light(side, (RIG.left, RIG.right)[side].supersampled(2)) for side in (0, 1)]
    for fine, uv in zip(lights, RIG.project(expected), strict=True):
        grey = fine.mean(axis=2).reshape(480, 2, 640, 2).mean(axis=(1, 3))
        (found,) = find_sizes(grey, [(5, 7)])
        corners = found.uv[nearest_order(found, uv)]
        assert np.abs(corners - uv).max() < 0.03
        first, second = uv[[0, 1, 7, 8]].mean(axis=0), uv[[1, 2, 8, 9]].mean(axis=0)
        assert level(grey, first) == level(grey, 2 * uv[0] - first) < level(grey, second) / 3


def test_a_warped_board_is_drawn_as_bent_as_it_is() -> None:
    """Corners in its middle lie several pixels beside where a flat one's would."""
    warped = Board(7, 5, 0.03, (0.012, -0.006))
    expected = FRONT.apply(warped.points)
    with Simulator(held_board(warped, 1.0)) as simulator:
        hold(simulator.scene, RIG, warped, FRONT)
        lights = [simulator.light(side, (RIG.left, RIG.right)[side].supersampled(2)) for side in (0, 1)]
    flat = RIG.project(FRONT.apply(BOARD.points))
    for fine, uv, uv_of_flat in zip(lights, RIG.project(expected), flat, strict=True):
        grey = fine.mean(axis=2).reshape(480, 2, 640, 2).mean(axis=(1, 3))
        (found,) = find_sizes(grey, [(5, 7)])
        assert np.abs(found.uv[nearest_order(found, uv)] - uv).max() < 0.05
        assert np.abs(uv - uv_of_flat).max() > 2
        first, second = uv[[0, 1, 7, 8]].mean(axis=0), uv[[1, 2, 8, 9]].mean(axis=0)
        assert level(grey, first) < level(grey, second) / 3


def level(grey: Array, uv: Array) -> float:
    u, v = np.rint(uv).astype(int)
    return float(grey[v, u])


def test_a_found_board_is_fitted_again_in_another_picture() -> None:
    with Simulator(held_board(BOARD, 1.0)) as simulator:
        hold(simulator.scene, RIG, BOARD, FRONT)
        fine = simulator.light(0, RIG.left.supersampled(2))
    grey = 200 * fine.mean(axis=2).reshape(480, 2, 640, 2).mean(axis=(1, 3))
    rng = np.random.default_rng(0)
    first, second = (grey + 2.0 * rng.standard_normal(grey.shape) for _ in range(2))
    (found,) = find_sizes(first, [(5, 7)])
    again = refit(second, found)
    apart = again - found.uv
    assert np.isfinite(apart).all()
    assert 0 < np.abs(apart).max() < 0.2
    # its claim is of one of both
    claimed = np.sqrt(2 * np.trace(found.cov, axis1=1, axis2=2).mean() / 2)
    assert np.sqrt((apart**2).mean()) == pytest.approx(claimed, rel=0.4)


def test_what_was_not_found_first_is_not_fitted() -> None:
    uv = np.array([[x, y] for y in (20.0, 40.0, 60.0) for x in (20.0, 40.0, 60.0)])
    valid = np.ones(9, dtype=bool)
    valid[4] = False
    uv[4] = np.nan
    board = BoardCorners(3, 3, uv, np.zeros((9, 2, 2)), valid, 1)
    picture = np.random.default_rng(0).uniform(0, 255, (80, 80))
    assert np.isnan(refit(picture, board)[4]).all()


@pytest.mark.parametrize("quarters", [0, 1, 2, 3])
def test_the_nearest_order_undoes_a_turn_of_the_grid(quarters: int) -> None:
    places = np.stack(np.meshgrid(np.arange(3.0), np.arange(3.0)), axis=-1)
    turned = np.rot90(places, quarters).reshape(-1, 2)
    board = BoardCorners(3, 3, turned, np.zeros((9, 2, 2)), np.ones(9, dtype=bool), 1)
    order = nearest_order(board, places.reshape(-1, 2) + 0.1)
    assert turned[order] == pytest.approx(places.reshape(-1, 2))
