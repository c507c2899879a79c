"""Boards held where both cameras of a rig see them."""

from __future__ import annotations

import numpy as np

from rigsim.rig.board import Board
from rigsim.rig.stereo import StereoRig
from rigsim.theory.calibration.boards import BoardPoses, whole


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
