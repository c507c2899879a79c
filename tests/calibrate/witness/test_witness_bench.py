"""What one calibration is off by: of its parameters, and of depths against the boards, with their signs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.witness.bench import boards_motion, change_of, depth_errors
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.parameters import RigParameters
from tests.helpers.calibrate.board_pictures import RIG, small_bench

POINTS = np.array([[0.0, 0.0, 1.0], [0.1, -0.05, 2.0]])
STILL = Pose()


@given(st.lists(st.floats(-1, 1), min_size=24, max_size=24))
def test_a_change_is_what_moved_the_rig(numbers: list[float]) -> None:
    parameters = RigParameters.of((BrownConrady, BrownConrady))
    scale = np.array([9.0] * 4 + [0.1] * 5 + [9.0] * 4 + [0.1] * 5 + [0.1] * 3 + [0.05] * 3)
    change = scale * numbers
    assert change_of(parameters, RIG, parameters.moved(RIG, change)) == pytest.approx(change, abs=1e-9)


def test_boards_that_moved_as_one_tell_their_motion() -> None:
    rng = np.random.default_rng(0)
    true = BoardPoses.of(rng.normal(0, 0.5, (5, 6)))
    motion = Pose.from_rotvec([0.02, -0.01, 0.03], [0.01, 0.02, -0.03])
    found = BoardPoses(motion.R @ true.R, motion.apply(true.t))
    told = boards_motion(found, true)
    assert pytest.approx(motion.R, abs=1e-12) == told.R
    assert told.t == pytest.approx(motion.t, abs=1e-12)


def test_a_longer_baseline_puts_points_farther() -> None:
    """Rays are the same, so that the whole space grows by as much: 1 % of 1 m and of 2 m."""
    longer = StereoRig(RIG.left, RIG.right, Pose(RIG.right_from_left.R, 1.01 * RIG.right_from_left.t))
    assert depth_errors(longer, STILL, RIG, POINTS) == pytest.approx([0.01, 0.02], abs=1e-9)


def test_boards_that_are_taken_to_be_farther_bring_points_nearer() -> None:
    """Where boards are found 10 mm too far off, a point that is found right lies 10 mm before them."""
    motion = Pose(t=np.array([0.0, 0.0, 0.01]))
    assert depth_errors(RIG, motion, RIG, POINTS) == pytest.approx([-0.01, -0.01], abs=1e-9)


def test_errors_are_to_first_order_what_the_covariance_says_of_them() -> None:
    """The same linear map, with the same signs, by a calibration that is off in everything."""
    bench = small_bench()
    covariance = bench.covariance(0.1)
    rng = np.random.default_rng(1)
    change = 1e-5 * covariance.draws(1, rng)[0]
    found = bench.parameters.moved(bench.rig, change[:-6])
    motion = Pose.from_rotvec(change[-6:-3], change[-3:])
    poses = BoardPoses(motion.R @ bench.poses.R, motion.apply(bench.poses.t))
    errors = bench.errors(found, poses)
    assert errors.parameters == pytest.approx(change, rel=1e-4, abs=1e-12)
    moves = covariance.point_moves(bench.points)[:, 2] @ change
    assert errors.depth_m == pytest.approx(moves, rel=1e-3)


def test_parameters_of_another_model_have_no_errors() -> None:
    bench = replace(small_bench(), true_rig=RIG)
    assert np.isnan(bench.errors(RIG, bench.poses).parameters).all()
    assert bench.errors(RIG, bench.poses).depth_m == pytest.approx(0, abs=1e-9)
