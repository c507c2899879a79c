"""Least squares with weights, and with boards that one camera alone saw, against mrcal 2.2."""

from __future__ import annotations

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory.calibration.adjust import adjust
from rigsim.theory.calibration.boards import BoardPoses, whole
from rigsim.theory.calibration.covariance import covariance_of
from rigsim.theory.calibration.information import board_information
from rigsim.theory.calibration.parameters import RigParameters

LENSES = (BrownConrady(-0.2, 0.05, 0.0005, -0.0003, 0.01), BrownConrady(-0.18, 0.04, -0.0005, 0.0003, 0.01))
LEFT = Intrinsics(1280, 800, 900, 905, 650, 390, LENSES[0])
RIGHT = Intrinsics(1280, 800, 910, 906, 630, 410, LENSES[1])
RIG = StereoRig(LEFT, RIGHT, Pose.from_rotvec([0.02, -0.1, 0.03], [-0.25, 0.01, 0.02]))
BOARD = Board(9, 6, 0.04)
# mrcal.optimize, LENSMODEL_OPENCV5, no regularization: fx, fy, cx, cy, k1, k2, p1, p2, k3
MRCAL_LEFT = (901.0991488, 905.64145708, 653.89777682, 387.40133411)
MRCAL_LEFT_LENS = (-0.20387967, 0.0619171, 0.00088768, 0.00017122, 0.01010035)
MRCAL_RIGHT = (911.74505374, 907.17035676, 633.24430961, 409.03651137)
MRCAL_RIGHT_LENS = (-0.18666958, 0.0606891, 0.00009825, 0.00073399, -0.00740452)
MRCAL_BASELINE_MM = 250.67989666
MRCAL_DEPTH_STD_MM = (0.32790528, 2.93111772, 25.01097606)  # at 1, 2, 5 m; corner noise 0.2 px


def seen_boards() -> tuple[BoardPoses, Array, Array]:
    """18 boards, 6 of them seen by one camera alone: corners (18, 2, 54, 2), to 0.001 px, and weights."""
    rng = np.random.default_rng(3)
    rows: list[Array] = []
    observed = np.full((18, 2, 54, 2), np.nan)
    weights = np.ones((18, 2, 54))
    while len(rows) < 18:
        turn = [*rng.uniform(-0.6, 0.6, 2), rng.uniform(-0.3, 0.3)]
        row = np.array([*turn, rng.uniform(-0.5, 0.3), rng.uniform(-0.5, 0.3), rng.uniform(0.6, 1.4)])
        uv = BoardPoses.of([row]).project(RIG, BOARD)
        seen = whole(RIG, uv, 5.0)[0]
        if not seen.any():
            continue
        for side in np.flatnonzero(seen):
            weight = 0.5 ** rng.integers(0, 3, (6, 9)).ravel()
            noise = 0.2 * rng.standard_normal((54, 2)) / weight[:, None]
            observed[len(rows), side] = np.round(uv[0, side] + noise, 3)
            weights[len(rows), side] = weight
        rows.append(row)
    return BoardPoses.of(np.array(rows)), observed, weights


def test_weighted_corners_and_lone_boards_give_the_rig_that_mrcal_finds() -> None:
    poses, observed, weights = seen_boards()
    assert (np.isfinite(observed[:, :, 0, 0]).sum(axis=1) == 1).sum() == 6
    parameters = RigParameters.of((BrownConrady, BrownConrady))
    found = adjust(RIG, parameters, BOARD, poses, observed, weights)
    for camera, pinhole, lens in (
        (found.rig.left, MRCAL_LEFT, MRCAL_LEFT_LENS),
        (found.rig.right, MRCAL_RIGHT, MRCAL_RIGHT_LENS),
    ):
        assert isinstance(camera.lens, BrownConrady)
        np.testing.assert_allclose((camera.fx, camera.fy, camera.cx, camera.cy), pinhole, atol=2e-3)
        np.testing.assert_allclose(camera.lens.coefficients, lens, atol=2e-4)
    assert abs(found.rig.baseline_m * 1e3 - MRCAL_BASELINE_MM) < 1e-3
    told = board_information(
        found.rig, parameters, BOARD, found.poses, np.isfinite(observed[..., 0]), weights=weights
    )
    covariance = covariance_of(found.rig, parameters, found.poses, told, 0.2)
    std_mm = covariance.depth_std([[0, 0, 1.0], [0, 0, 2.0], [0, 0, 5.0]]) * 1e3
    np.testing.assert_allclose(std_mm, MRCAL_DEPTH_STD_MM, rtol=2e-3)
