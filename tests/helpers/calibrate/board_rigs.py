"""A stereo rig with lenses that bend, boards held in front of it, and what a calibration estimates of it."""

from __future__ import annotations

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.parameters import RigParameters

BOARD = Board(7, 5, 0.04)
LEFT = Intrinsics(640, 480, 420.0, 424.0, 322.0, 236.0, BrownConrady(-0.1, 0.05, 0.0005, -0.0003, 0.01))
RIGHT = Intrinsics(640, 480, 416.0, 419.0, 315.0, 243.0, BrownConrady(-0.11, 0.055, -0.0004, 0.0002, 0.0))
RIG = StereoRig(LEFT, RIGHT, Pose.from_rotvec((0.01, -0.04, 0.02), (-0.12, 0.004, -0.01)))
ESTIMATED = RigParameters.of((BrownConrady, BrownConrady), fix=("k3",))


def held(count: int, seed: int = 0, *, board: Board = BOARD, tilt_rad: float = 0.6) -> BoardPoses:
    """Boards at random places before `RIG`, some of whose corners a camera may not show."""
    rng = np.random.default_rng(seed)
    turns = rng.uniform(-tilt_rad, tilt_rad, (count, 3))
    middle = rng.uniform((-0.15, -0.12, 0.5), (0.2, 0.12, 0.9), (count, 3))
    poses = BoardPoses.of(np.column_stack([turns, middle]))
    offset = poses.R @ np.array([*board.size_m, 0.0]) / 2
    return BoardPoses(poses.R, poses.t - offset)


def with_noise(poses: BoardPoses, rig: StereoRig, board: Board, noise_px: float, seed: int) -> Array:
    """What the cameras see of the boards, (n, 2, m, 2) px."""
    exact = poses.project(rig, board)
    return exact + np.random.default_rng(seed).normal(0.0, noise_px, exact.shape)
