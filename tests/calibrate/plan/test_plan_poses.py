"""Boards that somebody can hold, and the choice among them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import rigsim
from rigsim.errors import InvalidRange
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.depths import depth_stds
from rigsim.study.calibrate.plan.asked import DepthGoal, PlanAsked, Reach
from rigsim.study.calibrate.plan.choose import LEAST_SHARED, alike, choose, extended, ordered
from rigsim.study.calibrate.plan.explain import tilts_rad
from rigsim.study.calibrate.plan.held import facing, middle_of, smallest_square_px
from rigsim.study.calibrate.plan.reach import LEAST_SQUARE_PX, ReachedPoses, random_poses
from rigsim.study.calibrate.plan.run import plan_covariance
from rigsim.study.calibrate.plan.terms import DepthTerms, depth_terms
from rigsim.theory.calibration.boards import BoardPoses, rotations, whole
from rigsim.theory.calibration.parameters import RigParameters
from tests.helpers.calibrate.board_rigs import ESTIMATED, RIG

ASKED = PlanAsked(RIG, ESTIMATED, Board(7, 5, 0.03), at_m=(1.0, 2.0, 4.0), flatness_m=1e-4)


def drawn(asked: PlanAsked = ASKED, count: int = 120, alone: int = 30) -> ReachedPoses:
    return random_poses(asked, count, np.random.default_rng(5), alone)


def test_poses_are_within_reach_and_seen() -> None:
    reached = drawn()
    assert reached.both.sum() == 120
    assert len(reached) > 120
    uv = reached.poses.project(RIG, ASKED.board)
    # one camera alone: the other one shows less than the board and half a square around its corners
    (w, h), half = ASKED.board.size_m, ASKED.board.square_m / 2
    rim = reached.poses.points_left(
        np.array([[x, y, 0.0] for x in (-half, w + half) for y in (-half, h + half)])
    )
    around = np.stack([RIG.left.project(rim), RIG.right.project(RIG.right_from_left.apply(rim))], axis=1)
    np.testing.assert_array_equal(whole(RIG, around, 10.0), reached.seen)
    assert whole(RIG, uv, 10.0)[reached.seen].all()
    assert smallest_square_px(uv, ASKED.board)[reached.seen].min() >= LEAST_SQUARE_PX
    distance = np.linalg.norm(reached.poses.points_left(middle_of(ASKED.board)[None])[:, 0], axis=1)
    assert distance.min() >= 0.4
    assert distance.max() <= 1.2
    assert distance.min() < 0.55
    assert distance.max() > 1.1
    # no board shows its back
    assert (reached.poses.R[:, 2, 2] > 0).all()


def test_a_seed_says_which() -> None:
    first, again = drawn(), drawn()
    other = random_poses(ASKED, 120, np.random.default_rng(6), 30)
    np.testing.assert_array_equal(first.poses.t, again.poses.t)
    assert not np.array_equal(first.poses.t[:100], other.poses.t[:100])


@pytest.mark.parametrize("tilt_deg", [0.0, 5.0, 40.0])
def test_no_board_is_tilted_more_than_asked(tilt_deg: float) -> None:
    asked = replace(
        ASKED, rig=StereoRig.rectified(RIG.left, 0.1), reach=Reach(tilt_rad=math.radians(tilt_deg))
    )
    tilts = np.degrees(tilts_rad(asked.rig, drawn(asked).poses))
    assert tilts.max() <= tilt_deg + 1e-5
    assert tilts.max() >= 0.9 * tilt_deg


def test_far_out_a_board_faces_the_camera() -> None:
    """By hand: 80 deg to the right it is turned by 25 of them, about y; straight ahead not at all."""
    angle = math.radians(80)
    middle = np.array([[math.sin(angle), 0.0, math.cos(angle)], [0.0, 0.0, 1.0]])
    poses = facing(ASKED.board, middle, np.tile(np.eye(3), (2, 1, 1)))
    normal = [math.sin(math.radians(25)), 0.0, math.cos(math.radians(25))]
    np.testing.assert_allclose(poses.R[:, :, 2], [normal, [0, 0, 1]], atol=1e-12)
    np.testing.assert_allclose(poses.points_left(middle_of(ASKED.board)[None])[:, 0], middle, atol=1e-12)


def test_rotations_are_rodrigues() -> None:
    turns = np.array([[0.3, -0.2, 0.9], [0.0, 0.0, 0.0], [0.0, np.pi / 2, 0.0]])
    expected = [rigsim.Pose.from_rotvec(turn).R for turn in turns]
    np.testing.assert_allclose(rotations(turns), expected, atol=1e-14)


def test_wide_lenses_are_reached_all_over() -> None:
    wide = Intrinsics(1000, 1000, 280.0, 280.0, 500.0, 500.0, KannalaBrandt())
    rig = StereoRig.rectified(wide, 0.1)
    asked = replace(ASKED, rig=rig, parameters=RigParameters.of((KannalaBrandt, KannalaBrandt)))
    middle = drawn(asked).poses.points_left(middle_of(asked.board)[None])[:, 0]
    assert np.degrees(np.arctan2(np.hypot(*middle.T[:2]), middle[:, 2])).max() > 80


@pytest.mark.parametrize(
    ("board", "reach", "words"),
    [
        (
            Board(20, 20, 0.1),
            Reach(),
            "never fits both views from 400 to 1200 mm: hold it farther off, as at",
        ),
        (
            Board(9, 6, 0.03),
            Reach(20, 30),
            r"squares too small \(0\.62 px at 20000 mm, finders need 6 px\): take squares of 360 mm",
        ),
    ],
)
def test_a_board_that_fits_nowhere_says_what_would(board: Board, reach: Reach, words: str) -> None:
    with pytest.raises(InvalidRange, match=words):
        drawn(replace(ASKED, board=board, reach=reach))


def test_the_way_out_of_a_board_that_fits_nowhere_is_one() -> None:
    asked = replace(ASKED, board=Board(20, 20, 0.1))
    with pytest.raises(InvalidRange) as caught:
        drawn(asked)
    at_mm = float(str(caught.value).split("as at ")[1].split(" mm")[0])
    square_mm = float(str(caught.value).split("squares of ")[1].split(" mm")[0])
    assert drawn(replace(asked, reach=Reach(at_mm / 1e3, at_mm / 1e3 * 1.1))).both.any()
    assert drawn(replace(asked, board=Board(20, 20, square_mm / 1e3))).both.any()


def terms_of(reached: ReachedPoses, asked: PlanAsked = ASKED) -> DepthTerms:
    return depth_terms(asked, reached, 2.0)


def test_sums_give_the_depth_that_the_covariance_gives() -> None:
    """Frame of the boards and unknown warp included; at the axis, the edge and the corner."""
    reached = drawn()
    terms = terms_of(reached)
    for picks in ([0, 3, 5, 8, 90], list(range(20)), [120, 125, *range(15)]):
        found = np.sqrt(terms.variances(terms.boards.chosen(picks).total()))
        held = reached.chosen(np.array(picks))
        rows = depth_stds(plan_covariance(ASKED, held), (2.0,), PixelNoise(0.2))
        np.testing.assert_allclose(found, [row.calibration_m for row in rows], rtol=1e-4)


def test_a_warp_that_is_looked_for_is_known_a_little() -> None:
    parameters = RigParameters.of(ESTIMATED.lenses, fix=("k3",), warped=True)
    reached = drawn()
    found = []
    for flatness_m in (0.0, 1e-4, 1e-9):
        asked = replace(ASKED, parameters=parameters, flatness_m=flatness_m)
        terms, held = terms_of(reached, asked), reached.chosen(np.arange(12))
        std = plan_covariance(asked, held).depth_std([[0.0, 0.0, 2.0]])[0]
        found.append(std)
        sums = terms.boards.chosen(list(range(12))).total()
        assert np.sqrt(terms.axis_noise(sums)) == pytest.approx(std, rel=1e-4)
    flat = plan_covariance(replace(ASKED, flatness_m=0.0), reached.chosen(np.arange(12)))
    assert found[0] > found[1] > found[2]
    assert found[2] == pytest.approx(flat.depth_std([[0.0, 0.0, 2.0]])[0], rel=1e-3)


def test_a_board_that_is_not_flat_costs_more_than_one_that_is() -> None:
    held = drawn().chosen(np.arange(12))
    stds = [
        plan_covariance(replace(ASKED, flatness_m=flatness_m), held).depth_std([[0.0, 0.0, 2.0]])[0]
        for flatness_m in (0.0, 1e-4, 2e-4)
    ]
    # what is added grows with the square
    assert stds[2] ** 2 - stds[0] ** 2 == pytest.approx(4 * (stds[1] ** 2 - stds[0] ** 2))
    assert stds[1] > stds[0]


def test_chosen_boards_are_better_than_random_ones() -> None:
    reached = drawn()
    terms = terms_of(reached)
    picks = choose(terms, reached, alike(reached, ASKED.board), 12)
    rng, both = np.random.default_rng(1), np.flatnonzero(reached.both)
    random = [
        terms.variances(terms.boards.chosen(list(rng.choice(both, 12, replace=False))).total())
        for _ in range(30)
    ]
    chosen = terms.variances(terms.boards.chosen(picks).total())
    assert (np.sqrt(chosen / np.median(random, axis=0)) < 0.8).all()
    assert reached.both[picks].sum() >= LEAST_SHARED
    assert len(set(picks)) == 12


def test_no_exchange_of_one_is_any_better() -> None:
    reached = drawn(count=40, alone=10)
    terms = terms_of(reached)
    free = np.eye(len(reached), dtype=bool)
    picks = choose(terms, reached, free, 6)
    least = terms.loss(terms.boards.chosen(picks).total())
    for place in range(6):
        for other in set(range(len(reached))) - set(picks):
            changed = [*picks[:place], other, *picks[place + 1 :]]
            if reached.both[changed].sum() >= LEAST_SHARED:
                assert terms.loss(terms.boards.chosen(changed).total()) > 0.998 * least


def test_chosen_boards_are_apart_and_best_first() -> None:
    reached = drawn()
    terms, close = terms_of(reached), alike(reached, ASKED.board)
    picks = choose(terms, reached, close, 10)
    assert close[np.ix_(picks, picks)].sum() == 10
    forward = [float(terms.loss(terms.boards.chosen(picks[:k]).total())) for k in range(5, 11)]
    backward = [float(terms.loss(terms.boards.chosen(picks[::-1][:k]).total())) for k in range(5, 11)]
    assert forward == sorted(forward, reverse=True)
    assert all(one < other for one, other in zip(forward[:-1], backward[:-1], strict=True))
    assert sorted(ordered(terms, reached, picks[::-1])) == sorted(picks)


def test_boards_may_come_again_when_there_are_no_others() -> None:
    reached = drawn(count=4, alone=0)
    assert len(extended(terms_of(reached), reached, [], 9)) == 9


def test_two_boards_are_alike_where_their_corners_are() -> None:
    board, poses = (
        ASKED.board,
        BoardPoses.of([[0, 0, 0, 0, 0, 1], [0, 0, 0, 0.1, 0, 1], [0, 0, 0, 0.3, 0, 1.0]]),
    )
    close = alike(ReachedPoses(poses, np.ones((3, 2), dtype=bool)), board)
    assert close.tolist() == [[True, True, False], [True, True, False], [False, False, True]]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"poses": 0}, "0 poses: must be 2 to 200"),
        ({"poses": 1}, "1 poses: must be 2"),
        ({"corner_noise_px": 0.0}, "corner noise 0 px: must be > 0"),
        ({"corner_noise_px": -1.0}, "corner noise -1 px: must be > 0"),
        ({"noise_px": -1.0}, "noise -1 px: must be >= 0"),
        ({"flatness_m": math.nan}, "flatness nan mm"),
        ({"at_m": (0.0,)}, "depth 0 mm: must be > 0"),
        ({"at_m": ()}, "no depth"),
    ],
)
def test_what_cannot_be_asked(change: dict[str, Any], words: str) -> None:
    with pytest.raises(InvalidRange, match=words):
        replace(ASKED, **change)


def test_a_goal_is_more_than_nothing() -> None:
    with pytest.raises(InvalidRange, match="depth error 0 mm: must be > 0"):
        DepthGoal(0.0, 2.0)
    with pytest.raises(InvalidRange, match="tilt 90 deg"):
        Reach(tilt_rad=math.pi / 2)
    with pytest.raises(InvalidRange, match="board range 1200:400 mm"):
        Reach(1.2, 0.4)
