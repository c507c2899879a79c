"""Boards held where both cameras of a rig see them, and calibrations of them that are made many times."""

from __future__ import annotations

import numpy as np

from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.witness.bench import CalibrationBench
from rigsim.theory.calibration.boards import BoardPoses, whole
from rigsim.theory.calibration.parameters import RigParameters

RIG = StereoRig(
    Intrinsics(640, 480, 520.0, 521.0, 322.0, 236.0),
    Intrinsics(640, 480, 523.0, 522.0, 317.0, 243.0),
    Pose.from_rotvec([0.004, 0.02, -0.006], [-0.09, 0.001, 0.002]),
)
"""Two pinholes of unlike numbers."""


def boards_in_view(
    rig: StereoRig, board: Board, count: int, seed: int = 0, range_m: tuple[float, float] = (0.35, 0.9)
) -> BoardPoses:
    """`count` random poses, tilted by some 25 degrees, whole in both pictures with 5 px to the rim."""
    rng = np.random.default_rng(seed)
    middle = np.array([*board.size_m, 0.0]) / 2
    rows: list[list[float]] = []
    while len(rows) < count:
        turn = rng.normal(0, 0.4, 3)
        z = rng.uniform(*range_m)
        at = np.array([rng.uniform(-0.7, 0.7) * z, rng.uniform(-0.5, 0.5) * z, z])
        pose = BoardPoses.of([[*turn, 0, 0, 0]])
        pose = BoardPoses.of([[*turn, *(at - pose.R[0] @ middle)]])
        uv = pose.project(rig, board)
        if np.isfinite(uv).all() and whole(rig, uv, 5.0).all():
            rows.append(list(pose.rows[0]))
    return BoardPoses.of(rows)


def small_bench(noise_px: float = 0.1, boards: int = 10, seed: int = 3) -> CalibrationBench:
    """Pinholes without distortion from boards of 7x5 corners that both see."""
    board = Board(7, 5, 0.03)
    poses = boards_in_view(RIG, board, boards, seed, (0.3, 0.6))
    return CalibrationBench(
        RIG,
        RigParameters.of((None, None)),
        board,
        poses,
        np.ones((boards, 2), dtype=bool),
        noise_px,
        (0.5, 1.0, 2.0),
    )
