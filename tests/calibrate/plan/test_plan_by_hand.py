"""A warp that nobody looks for: said as hands hold the board, not as a choice of poses can make it cancel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rigsim.rig.board import Board
from rigsim.study.calibrate.plan.asked import PlanAsked
from rigsim.study.calibrate.plan.held import HAND_M, HAND_RAD, held_by_hand, middle_of
from rigsim.study.calibrate.plan.reach import ReachedPoses
from rigsim.study.calibrate.plan.result import CalibrationPlan
from rigsim.study.calibrate.plan.run import plan_covariance, run_plan
from rigsim.theory.calibration.boards import BoardPoses, whole
from tests.helpers.calibrate.board_rigs import ESTIMATED, RIG

ASKED = PlanAsked(RIG, ESTIMATED, Board(9, 6, 0.03), poses=10, at_m=(2.0,), flatness_m=3e-4)
AXIS = [[0.0, 0.0, 2.0]]


@pytest.fixture(scope="module")
def plan() -> CalibrationPlan:
    return run_plan(ASKED)


def own_std(plan: CalibrationPlan, poses: BoardPoses) -> float:
    """What a plan of these very poses says."""
    return float(plan_covariance(ASKED, ReachedPoses(poses, plan.seen)).depth_std(AXIS)[0])


def test_what_is_said_of_a_warp_is_what_hands_make_of_it(plan: CalibrationPlan) -> None:
    said = plan.covariance.depth_std(AXIS)[0]
    flat = plan_covariance(replace(ASKED, flatness_m=0.0), ReachedPoses(plan.poses, plan.seen))
    assert said > 1.5 * flat.depth_std(AXIS)[0]
    own = [
        own_std(plan, held_by_hand(ASKED, plan.poses, plan.seen, np.random.default_rng([77, k])))
        for k in range(40)
    ]
    assert np.sqrt(np.mean(np.square(own))) == pytest.approx(said, rel=0.2)
    assert np.quantile(own, 0.1) < said < np.quantile(own, 0.95)


def test_the_curve_says_the_same(plan: CalibrationPlan) -> None:
    at = {point.pictures: point.calibration_m for point in plan.curve}
    assert at[10] == pytest.approx(plan.covariance.depth_std(AXIS)[0], rel=1e-3)
    part = ReachedPoses(plan.poses.chosen(slice(0, 6)), plan.seen[:6])
    six = plan_covariance(replace(ASKED, poses=6), part, by_hand=True).depth_std(AXIS)[0]
    assert at[6] == pytest.approx(six, rel=1e-3)


def test_poses_are_chosen_as_for_a_flat_board(plan: CalibrationPlan) -> None:
    flat = run_plan(replace(ASKED, flatness_m=0.0))
    np.testing.assert_array_equal(plan.poses.t, flat.poses.t)


def test_poses_that_were_given_are_taken_as_they_are(plan: CalibrationPlan) -> None:
    given = run_plan(replace(ASKED, poses=plan.poses))
    assert given.covariance.depth_std(AXIS)[0] == pytest.approx(own_std(plan, plan.poses), rel=1e-6)
    at = {point.pictures: point.calibration_m for point in given.curve}
    assert at[10] == pytest.approx(own_std(plan, plan.poses), rel=1e-3)


def test_hands_miss_a_pose_by_as_much_as_is_said_and_keep_the_board_in_the_picture() -> None:
    """In the middle of the picture nothing has to be tried again."""
    board, count = Board(7, 5, 0.02), 2000
    at = np.array([0.0, 0.0, 1.0]) - middle_of(board)
    poses = BoardPoses.of(np.tile([0.0, 0, 0, *at], (count, 1)))
    seen = np.ones((count, 2), dtype=bool)
    asked = replace(ASKED, board=board)
    held = held_by_hand(asked, poses, seen, np.random.default_rng(1))
    missed = held.points_left(middle_of(board)[None])[:, 0] - [0, 0, 1.0]
    np.testing.assert_allclose(missed.std(axis=0), HAND_M, rtol=0.06)
    np.testing.assert_allclose(held.rows[:, :3].std(axis=0), HAND_RAD, rtol=0.06)
    assert whole(RIG, held.project(RIG, board)).all()
    fewer = held_by_hand(asked, poses.chosen(slice(0, 5)), seen[:5], np.random.default_rng(1))
    np.testing.assert_array_equal(fewer.t, held.t[:5])
