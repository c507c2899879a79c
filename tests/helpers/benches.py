"""Small calibrations that are made many times."""

from __future__ import annotations

import numpy as np

from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.witness.bench import CalibrationBench
from rigsim.theory.calibration.parameters import RigParameters
from tests.helpers.board_pictures import boards_in_view

RIG = StereoRig(
    Intrinsics(640, 480, 520.0, 521.0, 322.0, 236.0),
    Intrinsics(640, 480, 523.0, 522.0, 317.0, 243.0),
    Pose.from_rotvec([0.004, 0.02, -0.006], [-0.09, 0.001, 0.002]),
)
"""Two pinholes of unlike numbers."""


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
