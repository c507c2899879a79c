"""A whole plan: what it says, how many pictures, which next, and why not."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import rigsim
from rigsim.errors import CalibrationUndetermined
from rigsim.rig.board import Board
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.plan.asked import DepthGoal, PlanAsked, Reach
from rigsim.study.calibrate.plan.given import counted
from rigsim.study.calibrate.plan.reach import ReachedPoses, random_poses
from rigsim.study.calibrate.plan.result import CalibrationPlan
from rigsim.study.calibrate.plan.run import plan_covariance, run_plan
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.parameters import RigParameters
from rigsim.theory.uncertainty import predict_depth_std
from tests.helpers.calibrate.board_rigs import ESTIMATED, RIG

ASKED = PlanAsked(RIG, ESTIMATED, Board(7, 5, 0.03), poses=8, at_m=(1.0, 2.0, 4.0))
GIVEN = run_plan(replace(ASKED, poses=12, seed=3)).poses
AXIS = [[0.0, 0.0, 2.0]]


def codes(plan: CalibrationPlan) -> list[str]:
    return [remark.code for remark in plan.remarks]


@pytest.fixture(scope="module")
def plan() -> CalibrationPlan:
    return run_plan(ASKED)


def test_a_plan_is_what_its_covariance_says(plan: CalibrationPlan) -> None:
    assert len(plan.poses) == 8
    row = next(row for row in plan.depths if row.place == "axis" and row.z_m == 2.0)
    assert row.calibration_m == pytest.approx(plan.covariance.depth_std(AXIS)[0])
    assert row.observation_m == pytest.approx(predict_depth_std(RIG, AXIS, 0.25)[0])
    at = {point.pictures: point for point in plan.curve}
    assert list(at) == list(range(2, 51))
    assert at[8].calibration_m == pytest.approx(row.calibration_m, rel=1e-4)
    assert at[8].joint_m == pytest.approx(row.joint_m, rel=1e-4)
    # the first five of the eight
    held = ReachedPoses(plan.poses.chosen(slice(0, 5)), plan.seen[:5])
    assert at[5].calibration_m == pytest.approx(plan_covariance(ASKED, held).depth_std(AXIS)[0], rel=1e-3)
    assert at[50].calibration_m < at[20].calibration_m < at[8].calibration_m < at[3].calibration_m
    assert at[8].calibration_m < 0.8 * at[8].random_m


def test_the_same_seed_makes_the_same_plan(plan: CalibrationPlan) -> None:
    again = run_plan(ASKED)
    np.testing.assert_array_equal(again.poses.t, plan.poses.t)
    assert again.curve == plan.curve


def test_the_next_pose_gains_what_it_says(plan: CalibrationPlan) -> None:
    following = plan.next_pose
    assert following is not None
    more = BoardPoses.of(np.vstack([plan.poses.rows, following.left_from_board]))
    seen = np.vstack([plan.seen, following.seen])
    after = plan_covariance(ASKED, ReachedPoses(more, seen)).depth_std(AXIS)[0]
    assert following.gain == pytest.approx(after / plan.covariance.depth_std(AXIS)[0], rel=1e-4)
    assert 0.5 < following.gain < 1


def test_as_many_pictures_as_needed_are_needed(plan: CalibrationPlan) -> None:
    observation = predict_depth_std(RIG, AXIS, 0.25)[0]
    calibration = {point.pictures: point.calibration_m for point in plan.curve}
    goal = DepthGoal(math.hypot(observation, calibration[13]) * 1.0001, 2.0)
    needed = run_plan(replace(ASKED, goal=goal)).needed
    assert needed.count == next(n for n in range(2, 51) if calibration[n] <= calibration[13] * 1.001)
    assert needed.hindrance == ""


def test_pixel_noise_alone_can_be_too_much() -> None:
    observation = predict_depth_std(RIG, AXIS, 0.25)[0]
    needed = run_plan(replace(ASKED, goal=DepthGoal(0.99 * observation, 2.0))).needed
    assert (needed.count, needed.hindrance) == (None, "observation")
    assert needed.observation_m == pytest.approx(observation)


@pytest.mark.parametrize(
    ("change", "hindrance"),
    [
        ({"reach": Reach(tilt_rad=math.radians(8))}, "tilt"),
        ({"flatness_m": 2e-3}, "flatness"),
    ],
)
def test_what_stands_in_the_way_is_named(change: dict[str, Any], hindrance: str) -> None:
    needed = run_plan(replace(ASKED, noise_px=1e-3, goal=DepthGoal(8e-4, 2.0), **change)).needed
    assert needed.count is None
    assert needed.hindrance == hindrance
    stds = [remedy.joint_m for remedy in needed.remedies]
    assert stds == sorted(stds)
    assert max(stds) < needed.most_pictures_m


def test_given_poses_are_taken_in_their_order() -> None:
    plan = run_plan(replace(ASKED, poses=GIVEN))
    np.testing.assert_array_equal(plan.poses.t, GIVEN.t)
    backwards = run_plan(replace(ASKED, poses=GIVEN.chosen(slice(None, None, -1))))
    np.testing.assert_allclose(plan.covariance.std, backwards.covariance.std, rtol=1e-6)
    assert plan.curve[3] != backwards.curve[3]
    assert plan.curve[10].calibration_m == pytest.approx(backwards.curve[10].calibration_m, rel=1e-4)


def changed(rows: dict[int, list[float]]) -> BoardPoses:
    poses = GIVEN.rows
    for place, row in rows.items():
        poses[place] = row
    return BoardPoses.of(poses)


def test_boards_that_no_camera_sees_are_left_out_and_numbered() -> None:
    odd = changed({1: [0, 0, 0, 5.0, 0, 0.6], 4: [0, 0, 0, -0.1, -0.1, -0.7]})
    plan = run_plan(replace(ASKED, poses=odd))
    assert len(plan.poses) == 10
    texts = {remark.code: remark.text for remark in plan.remarks}
    assert texts["not_whole"].startswith("board 2 is seen whole by neither camera")
    assert texts["behind"].startswith("board 5 is behind")
    without = [k for k in range(12) if k not in (1, 4)]
    alone = run_plan(replace(ASKED, poses=GIVEN.chosen(np.array(without))))
    np.testing.assert_allclose(plan.covariance.std, alone.covariance.std, rtol=1e-9)


def test_a_board_that_was_turned_round_is_told() -> None:
    """A wide board that fills the pictures' width: as a high one it reaches out of them below."""
    rig = StereoRig.rectified(rigsim.Intrinsics.from_focal(640, 480, 420.0), 0.1)
    poses = BoardPoses.of([[0, 0, 0.05 * k, -0.3, -0.2, 0.7 + 0.005 * k] for k in range(4)])
    right = replace(ASKED, rig=rig, board=Board(15, 10, 0.045))
    reached, remarks = counted(right, poses)
    assert len(reached) == 4
    assert not remarks
    _, remarks = counted(replace(right, board=Board(10, 15, 0.045)), poses)
    texts = {remark.code: remark.text for remark in remarks}
    assert texts["board_swapped"].startswith(
        "board 10x15@45mm is seen whole in 0 of 8 pictures, 15x10@45mm in 8"
    )


@pytest.mark.parametrize(
    ("poses", "reason", "words"),
    [
        (GIVEN.chosen(slice(0, 0)), "no_poses", "no board is seen whole by either camera"),
        (GIVEN.chosen(slice(0, 1)), "one_pose", "a single board leaves"),
        (BoardPoses.of(GIVEN.rows * [1, 1, 1, 1e3, 1e3, 1e3]), "open", "poses are rad and m"),
    ],
)
def test_what_leaves_the_rig_open_says_why(poses: BoardPoses, reason: str, words: str) -> None:
    with pytest.raises(CalibrationUndetermined, match=words) as caught:
        run_plan(replace(ASKED, poses=poses))
    assert caught.value.reason == reason


@pytest.mark.parametrize("tilt_deg", [0.0, 1e-3, 0.05])
def test_boards_parallel_to_the_pictures_are_refused(tilt_deg: float) -> None:
    rig = StereoRig(RIG.left, RIG.right, Pose.from_rotvec((0, 0, 0), (-0.12, 0, 0)))
    free = RigParameters.of(ESTIMATED.lenses)
    with pytest.raises(CalibrationUndetermined, match="no board is tilted") as caught:
        run_plan(
            replace(ASKED, rig=rig, parameters=free, reach=Reach(tilt_rad=math.radians(tilt_deg)), poses=20)
        )
    assert caught.value.reason == "no_tilt"


def test_boards_all_in_the_middle_are_refused() -> None:
    """Small ones a metre off: what the lens does to the picture's corners is anybody's guess."""
    rng, small = np.random.default_rng(0), Board(7, 5, 0.02)
    shifts = np.column_stack([rng.uniform(-0.02, 0.02, (20, 2)), rng.uniform(0.8, 1.2, 20)])
    poses = BoardPoses.of(np.column_stack([rng.uniform(-0.6, 0.6, (20, 3)), shifts]))
    with pytest.raises(CalibrationUndetermined, match="in the middle of the pictures") as caught:
        run_plan(replace(ASKED, board=small, poses=poses))
    assert caught.value.reason == "middle"
    held = RigParameters.of(ESTIMATED.lenses, fix=("lens",))
    assert len(run_plan(replace(ASKED, board=small, poses=poses, parameters=held)).poses) == 20


def test_boards_that_never_share_a_view_are_refused() -> None:
    reached, _ = counted(ASKED, random_poses(ASKED, 1, np.random.default_rng(0), 60).poses)
    apart = reached.chosen(~reached.both)
    assert len(apart) > 20
    with pytest.raises(CalibrationUndetermined, match="seen whole by both cameras") as caught:
        run_plan(replace(ASKED, poses=apart.poses))
    assert caught.value.reason == "one_camera"


def test_remarks_on_what_is_regular_and_poor() -> None:
    rig = StereoRig(RIG.left, RIG.right, Pose.from_rotvec((0, 0, 0), (-0.12, 0, 0)))
    flat = run_plan(replace(ASKED, rig=rig, reach=Reach(tilt_rad=math.radians(6)), poses=4))
    assert {"little_tilt", "few_pictures"} <= set(codes(flat))
    good = run_plan(replace(ASKED, poses=20, board=Board(9, 7, 0.03)))
    assert codes(good) == []


def test_pairs_that_are_hardly_told_apart(plan: CalibrationPlan) -> None:
    correlation, names = plan.covariance.correlation, plan.covariance.names
    assert plan.inseparable
    for pair in plan.inseparable:
        assert correlation[names.index(pair.first), names.index(pair.second)] == pytest.approx(
            pair.correlation
        )
        assert abs(pair.correlation) > 0.9
        assert not pair.first.endswith("k3")
    sizes = [abs(pair.correlation) for pair in plan.inseparable]
    assert sizes == sorted(sizes, reverse=True)


def test_without_a_goal_nothing_is_needed(plan: CalibrationPlan) -> None:
    assert plan.needed.count is None
    assert plan.needed.hindrance == ""
