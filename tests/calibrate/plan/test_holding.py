"""How a board is held, in words: worked out by hand, seen from behind the cameras."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest

from rigsim.present.calibrate.board_shapes import shape
from rigsim.present.calibrate.words import distance_words, holding_words, place_words, tilt_words
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose, rotation_from_rotvec
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.holding import EDGES, Holding, holdings
from rigsim.theory.calibration.boards import BoardPoses

RIG = StereoRig.rectified(Intrinsics.from_focal(1200, 800, 800.0), 0.1)
BOARD = Board(9, 6, 0.03)
BOTH = np.ones((1, 2), dtype=bool)


def held(
    turn: tuple[float, float, float], middle: tuple[float, float, float], seen: np.ndarray = BOTH
) -> Holding:
    """The board turned by a rotation vector, deg, around its middle, m."""
    vector = np.radians(turn)
    at = np.array(middle) - rotation_from_rotvec(vector) @ np.append(np.array(BOARD.size_m) / 2, 0)
    (one,) = holdings(RIG, BOARD, BoardPoses.of([[*vector, *at]]), seen)
    return one


@pytest.mark.parametrize(
    ("turn", "middle", "words"),
    [
        # about x, y turns towards z: the lower edge goes away
        ((30, 0, 0), (0, 0, 0.6), "60 cm away, middle, lower edge tilted 30° away"),
        ((-30, 0, 0), (0, 0, 0.6), "60 cm away, middle, upper edge tilted 30° away"),
        # about y, z turns towards x, and x towards -z: the right edge comes near
        ((0, 20, 0), (0, 0, 0.6), "60 cm away, middle, left edge tilted 20° away"),
        ((0, -20, 0), (0, 0, 0.6), "60 cm away, middle, right edge tilted 20° away"),
        # about both alike: the lower left corner goes away
        ((20, 20, 0), (0, 0, 0.6), "60 cm away, middle, lower left corner tilted 30° away"),
        # about z, x turns towards y, which is down: clockwise
        ((0, 0, 30), (0, 0, 0.6), "60 cm away, middle, facing the cameras, turned 30° clockwise"),
        ((0, 0, -30), (0, 0, 0.6), "60 cm away, middle, facing the cameras, turned 30° anticlockwise"),
        ((0, 0, 88), (0, 0, 0.6), "60 cm away, middle, facing the cameras, on its side"),
        ((0, 0, 178), (0, 0, 0.6), "60 cm away, middle, facing the cameras"),
        # x to the right, y down; 0.3 / 0.8 of 800 px is 300 px right of the middle of 1200
        ((0, 0, 0), (0.3, 0, 0.8), "85 cm away, right, facing the cameras"),
        ((0, 0, 0), (-0.3, -0.2, 0.8), "90 cm away, upper left, facing the cameras"),
        ((0, 0, 0), (0, 0.2, 0.8), "80 cm away, bottom, facing the cameras"),
        ((0, 0, 0), (0, 0, 2.04), "2.0 m away, middle, facing the cameras"),
    ],
)
def test_a_board_is_held_as_one_works_out(
    turn: tuple[float, float, float], middle: tuple[float, float, float], words: str
) -> None:
    assert holding_words(held(turn, middle)) == words


def test_a_board_that_one_camera_sees_is_said_where_that_shows_it() -> None:
    seen = np.array([[False, True]])
    one = held(
        (0, 0, 0), (0.1, 0, 0.8), seen
    )  # straight ahead of the right camera, 100 mm beside the left one
    assert one.across == pytest.approx(0.5, abs=1e-3)
    assert holding_words(one) == (
        "80 cm away, middle, facing the cameras, only the right camera sees it whole"
    )
    assert held((0, 0, 0), (0.1, 0, 0.8)).across == pytest.approx(0.5 + 100 / 1199, abs=1e-6)


@pytest.mark.parametrize("place", range(8))
def test_each_edge_goes_away_in_its_turn(place: int) -> None:
    # an edge at the angle a in the picture (clockwise from the right) recedes by a turn about (sin a, -cos a)
    angle = place * math.pi / 4
    axis = np.array([math.sin(angle), -math.cos(angle), 0.0])
    one = held(tuple(25 * axis), (0, 0, 0.7))
    assert one.away == EDGES[place]
    assert math.degrees(one.tilt_rad) == pytest.approx(25)
    # the board's own point out there is farther than its middle, whatever the words
    out = rotation_from_rotvec(np.radians(25) * axis) @ [math.cos(angle), math.sin(angle), 0.0]
    assert out[2] > 0.4


def test_places_and_distances_are_those_of_a_ruler() -> None:
    assert [place_words(*at) for at in ((0.1, 0.1), (0.5, 0.5), (0.9, 0.5), (0.5, 0.9))] == [
        "upper left",
        "middle",
        "right",
        "bottom",
    ]
    assert [distance_words(m) for m in (0.083, 0.42, 0.43, 1.49, 1.51)] == [
        "8 cm",
        "40 cm",
        "45 cm",
        "150 cm",
        "1.5 m",
    ]
    assert tilt_words(held((1, 0, 0), (0, 0, 0.6))) == "facing the cameras"


@pytest.mark.parametrize("side", [0, 1])
def test_the_drawn_board_is_where_opencv_projects_it(side: int) -> None:
    lens = BrownConrady(-0.25, 0.08, 0.001, -0.002, 0.01)
    camera = Intrinsics(1200, 800, 800.0, 810.0, 590.0, 410.0, lens)
    rig = StereoRig(camera, camera, Pose.from_rotvec([0.01, -0.02, 0.03], [-0.1, 0.002, 0.003]))
    poses = BoardPoses.of([[0.3, -0.4, 0.2, -0.1, -0.05, 0.6]])
    found = shape(rig, side, BOARD, poses, 0)
    corners = BOARD.outline
    points = poses.points_left(corners)[0]
    if side == 1:
        points = rig.right_from_left.apply(points)
    K = np.array([[800.0, 0, 590.0], [0, 810.0, 410.0], [0, 0, 1]])
    D = np.array([-0.25, 0.08, 0.001, -0.002, 0.01])
    expected, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), K, D)
    np.testing.assert_allclose(found.rim[::12], expected[:, 0], atol=1e-6)
    # a 9x6 board has 10 x 7 squares, half of them dark; the first is the one at the first corner
    assert found.dark.shape == (35, 4, 2)
    np.testing.assert_allclose(found.dark[0, 0], expected[0, 0], atol=1e-6)
