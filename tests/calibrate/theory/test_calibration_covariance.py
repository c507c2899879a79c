"""What a calibration leaves: against mrcal, by laws, and by many calibrations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.covariance import (
    CalibrationCovariance,
    Undetermined,
    covariance_of,
    point_moves,
)
from rigsim.theory.calibration.information import board_information
from rigsim.theory.calibration.parameters import RigParameters
from rigsim.theory.triangulation import triangulate
from tests.helpers.calibrate.board_rigs import BOARD, ESTIMATED, RIG, held

POINTS = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 3.0], [0.3, -0.2, 1.5]])
counts = st.integers(5, 9)
seeds = st.integers(0, 10**6)
few = settings(max_examples=10, deadline=None)


def left(
    poses: BoardPoses,
    *,
    rig: StereoRig = RIG,
    board: Board = BOARD,
    noise_px: float = 0.1,
    parameters: RigParameters = ESTIMATED,
) -> CalibrationCovariance:
    information = board_information(rig, parameters, board, poses)
    return covariance_of(rig, parameters, poses, information, noise_px)


def same(found: Array, expected: Array, rtol: float = 1e-4) -> None:
    np.testing.assert_allclose(found, expected, rtol=rtol)


MRCAL_RIG = StereoRig(
    Intrinsics(1280, 800, 800.0, 800.0, 639.5, 399.5, BrownConrady(-0.1, 0.05, 0.0005, -0.0003)),
    Intrinsics(1280, 800, 802.0, 801.0, 641.0, 398.0, BrownConrady(-0.11, 0.055, -0.0004, 0.0002)),
    Pose.from_rotvec((0, 0, 0), (-0.12, 0, 0)),
)
MRCAL_POSES = (
    (-0.49010345, 0.263317953, 0.078637341, -0.209655494, -0.086303025, 0.776264704),
    (-0.041616753, -0.383941308, -0.04272966, 0.126640568, -0.239894765, 0.512863805),
    (-0.259513559, -0.333791421, 0.120073365, 0.13938995, -0.121267512, 0.705821759),
    (-0.448089466, 0.173427327, 0.154631127, -0.083600296, -0.154616575, 0.572695867),
    (0.28095064, -0.336065825, 0.152397457, 0.164082318, -0.047004417, 0.435715168),
)


def test_depths_are_as_sure_as_mrcal_says() -> None:
    """Its 2.2, `mrcal.triangulate` with the calibration's uncertainty by the mean of the boards' frames."""
    covariance = left(BoardPoses.of(MRCAL_POSES), rig=MRCAL_RIG, board=Board(10, 10, 0.03))
    axis = [[0.0, 0.0, z] for z in (1.0, 2.0, 3.0, 5.0, 10.0)]
    same(covariance.depth_std(axis) * 1e3, np.array([0.41611, 2.04977, 4.84714, 14.07772, 58.57048]), 1e-4)


@few
@given(counts, seeds, st.floats(0.02, 3.0))
def test_twice_the_noise_is_twice_the_std(count: int, seed: int, noise_px: float) -> None:
    poses = held(count, seed)
    same(left(poses, noise_px=2 * noise_px).std, 2 * left(poses, noise_px=noise_px).std, 1e-9)


@few
@given(counts, seeds, st.integers(2, 5))
def test_n_times_the_pictures_is_one_over_root_n(count: int, seed: int, times: int) -> None:
    poses = held(count, seed)
    again = BoardPoses(np.tile(poses.R, (times, 1, 1)), np.tile(poses.t, (times, 1)))
    same(left(again).std, left(poses).std / np.sqrt(times))


@few
@given(counts, seeds, st.floats(0.01, 100.0))
def test_depths_scale_with_the_board(count: int, seed: int, scale: float) -> None:
    """A board, its places, the baseline and the point, all as much larger."""
    poses = held(count, seed)
    large = StereoRig(RIG.left, RIG.right, Pose(RIG.right_from_left.R, scale * RIG.right_from_left.t))
    found = left(
        BoardPoses(poses.R, scale * poses.t), rig=large, board=replace(BOARD, square_m=scale * BOARD.square_m)
    )
    same(found.depth_std(scale * POINTS), scale * left(poses).depth_std(POINTS))
    same(
        found.depth_std(scale * POINTS, from_camera=True),
        scale * left(poses).depth_std(POINTS, from_camera=True),
    )


@few
@given(counts, seeds)
def test_the_order_of_boards_is_of_no_matter(count: int, seed: int) -> None:
    poses = held(count, seed)
    order = np.random.default_rng(seed).permutation(count)
    same(left(poses.chosen(order)).std, left(poses).std, 1e-6)


@few
@given(counts, seeds)
def test_which_camera_is_the_reference_is_of_no_matter_to_points(count: int, seed: int) -> None:
    """Against the boards a point is as sure, whichever camera's frame it is told in."""
    poses, pose = held(count, seed), RIG.right_from_left
    swapped = StereoRig(RIG.right, RIG.left, pose.inverse)
    in_right = BoardPoses(pose.R @ poses.R, poses.t @ pose.R.T + pose.t)
    expected = pose.R @ left(poses).point_covariance(POINTS) @ pose.R.T
    found = left(in_right, rig=swapped).point_covariance(pose.apply(POINTS))
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-4 * np.abs(expected).max())


@few
@given(counts, seeds)
def test_a_boards_own_frame_is_of_no_matter(count: int, seed: int) -> None:
    """Its first corner at the other end, columns and rows backwards: the same corners."""
    poses = held(count, seed)
    turn = np.diag([-1.0, -1.0, 1.0])
    other = BoardPoses(poses.R @ turn, poses.t + poses.R @ np.array([*BOARD.size_m, 0.0]))
    same(left(other).std, left(poses).std)


@few
@given(counts, seeds)
def test_another_board_never_hurts_the_rig(count: int, seed: int) -> None:
    """What it adds is information: no combination of the rig's numbers becomes less sure.

    Of points against the boards that holds only as long as the boards' mean frame does not suffer: one board
    that is badly placed in space moves it.
    """
    poses = held(count + 1, seed)
    before, after = left(poses.chosen(slice(0, count))), left(poses)
    scale = before.std[:-6] + (before.std[:-6] == 0)
    gained = (before.of_rig - after.of_rig) / scale / scale[:, None]
    assert np.linalg.eigvalsh(gained)[0] > -1e-6
    assert (
        after.depth_std(POINTS, from_camera=True) <= before.depth_std(POINTS, from_camera=True) * 1.000001
    ).all()


@few
@given(seeds, st.floats(0.1, 0.9))
def test_a_board_seen_nearer_and_as_much_smaller_tells_the_rig_of_one_camera_the_same(
    seed: int, share: float
) -> None:
    """What one camera sees of a board is a matter of angles alone; a baseline is not among them."""
    poses = held(5, seed)
    nearer = BoardPoses(poses.R, share * poses.t)
    alone = np.tile([True, False], (5, 1))
    small = replace(BOARD, square_m=share * BOARD.square_m)
    far = board_information(RIG, ESTIMATED, BOARD, poses, alone).reduced
    near = board_information(RIG, ESTIMATED, small, nearer, alone).reduced
    np.testing.assert_allclose(near, far, rtol=1e-5, atol=1e-6 * np.abs(far).max())


@few
@given(seeds, st.floats(0.5, 0.95))
def test_boards_seen_nearer_say_more_of_how_the_cameras_stand(seed: int, share: float) -> None:
    """With the lenses known, at the same tilts and in the same directions: every number of the pose is surer.

    That is as far as it goes. With lenses unknown boards far off can be worth more (mrcal's own numbers say
    so: at 1 m, boards at 1 m beat boards at 0.6 m), and far points hang on how far off the boards were.
    """
    parameters = RigParameters.of(ESTIMATED.lenses, fix=("focal", "principal", "lens"))
    poses = held(5, seed)
    to_middle = poses.R @ np.array([*BOARD.size_m, 0.0]) / 2
    nearer = BoardPoses(poses.R, share * (poses.t + to_middle) - to_middle)
    pose = parameters.pose
    assert (
        left(nearer, parameters=parameters).std[pose] < left(poses, parameters=parameters).std[pose]
    ).all()


def test_points_move_as_triangulation_with_a_rig_that_is_a_little_off() -> None:
    uv = RIG.project(POINTS)
    moves = point_moves(RIG, ESTIMATED, POINTS)
    for k, name in enumerate(ESTIMATED.names):
        step = np.zeros(len(ESTIMATED.names))
        step[k] = 1e-3 if name.partition(".")[2] in ("fx", "fy", "cx", "cy") else 1e-6
        more, less = (triangulate(ESTIMATED.moved(RIG, way * step), *uv, "optimal") for way in (1, -1))
        np.testing.assert_allclose(
            moves[..., k], (more - less) / (2 * step[k]), rtol=1e-4, atol=1e-6, err_msg=name
        )


def test_a_shift_of_one_principal_point_by_hand() -> None:
    """f b / d: one more pixel of cx at the left is one pixel less of disparity, Z^2 / (f b) more of depth."""
    plain = Intrinsics.from_focal(640, 480, 500.0)
    rig = StereoRig.rectified(plain, 0.1)
    parameters = RigParameters.of((None, None))
    moves = point_moves(rig, parameters, [[0.0, 0.0, 2.0]])[0, 2]
    by_name = dict(zip(parameters.names, moves, strict=True))
    assert by_name["left.cx"] == pytest.approx(2.0**2 / (500 * 0.1))
    assert by_name["right.cx"] == pytest.approx(-(2.0**2) / (500 * 0.1))
    # the right camera's centre a little farther right: as much more of everything
    assert by_name["tx_m"] == pytest.approx(-2.0 / 0.1)


def test_one_board_between_two_cameras_by_hand() -> None:
    """Only the right camera's place along x is unknown, and the board's pose. Disparities' mean of 9 corners
    tells tx + b dz / Z to Z / f sqrt(2 / 9) px; the board's size in both pictures tells dz to
    Z^2 / f / sqrt(2 sum of squares of the corners' offsets) px; all else is apart by symmetry."""
    f, b, z = 500.0, 0.1, 2.0
    rig = StereoRig.rectified(Intrinsics.from_focal(640, 480, f), b)
    names = ("focal", "principal", "rx_rad", "ry_rad", "rz_rad", "ty_m", "tz_m")
    parameters = RigParameters.of((None, None), fix=names)
    poses = BoardPoses.of([[0.0, 0.0, 0.0, b / 2 - 0.1, -0.1, z]])
    covariance = left(poses, rig=rig, board=Board(3, 3, 0.1), noise_px=0.2, parameters=parameters)
    of_disparity, of_size = z / f * np.sqrt(2 / 9), z**2 / f / np.sqrt(2 * 2 * 6 * 0.1**2)
    expected = 0.2 * np.hypot(of_disparity, b / z * of_size)
    assert covariance.std[covariance.names.index("tx_m")] == pytest.approx(expected, rel=1e-6)


def test_boards_without_tilt_leave_the_focal_length_open() -> None:
    flat = held(12, 3, tilt_rad=0.0)
    lens = BrownConrady(-0.1, 0.05, 0.0005, -0.0003)
    rig = StereoRig(replace(RIG.left, lens=lens), RIG.right, Pose.from_rotvec((0, 0, 0), (-0.12, 0, 0)))
    with pytest.raises(Undetermined) as caught:
        left(flat, rig=rig)
    assert any(name.endswith((".fx", ".fy")) or name == "tx_m" for name in caught.value.names)


def test_what_is_held_is_not_off() -> None:
    parameters = RigParameters.of((BrownConrady, BrownConrady), fix=("aspect", "k2", "k3", "right.p1"))
    covariance = left(held(6), parameters=parameters)
    std = dict(zip(covariance.names, covariance.std, strict=True))
    assert std["left.k2"] == std["right.k3"] == std["right.p1"] == 0
    assert std["left.fy"] == pytest.approx(std["left.fx"] * RIG.left.fy / RIG.left.fx)
    assert std["left.p1"] > 0


def test_what_is_known_beforehand_counts() -> None:
    parameters = RigParameters.of((BrownConrady, BrownConrady), fix=("k3",), warped=True)
    poses = held(8)
    told = board_information(RIG, parameters, BOARD, poses)
    known = np.zeros(len(parameters.names))
    known[parameters.warp] = 1e-5**-2
    free = covariance_of(RIG, parameters, poses, told, 0.1)
    sure = covariance_of(RIG, parameters, poses, told, 0.1, np.diag(known))
    flat = left(poses)
    assert (sure.std[parameters.warp] < 1.0000001e-5).all()
    assert (sure.std <= free.std * 1.000001).all()
    same(sure.depth_std(POINTS), flat.depth_std(POINTS), 0.05)


def test_draws_have_the_covariance() -> None:
    covariance = left(held(6))
    draws = covariance.draws(20_000, np.random.default_rng(2))
    free = covariance.std > 0
    assert not draws[:, ~free].any()
    unit = draws[:, free] / covariance.std[free]
    np.testing.assert_allclose(
        unit.T @ unit / len(unit), covariance.correlation[np.ix_(free, free)], atol=0.04
    )


def test_a_projection_is_surest_where_boards_were() -> None:
    covariance = left(held(20, 3))
    middle, corner = covariance.projection_std(0, RIG.left.ray([[320.0, 240.0], [2.0, 2.0]]) * 0.7)
    assert 0 < middle < 0.1 < corner
