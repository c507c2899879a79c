"""A board as a camera shows it: its dark squares and its rim, through the lens."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.rig.stereo import StereoRig
from rigsim.theory.calibration.boards import BoardPoses

_STEPS = 12
"""Points along each side of the rim: a lens bends it."""


@dataclass(frozen=True, slots=True, eq=False)
class BoardShape:
    """One board in one picture."""

    rim: Array
    """Its outline (4 * 12, 2) px, all round."""
    dark: Array
    """Its dark squares (k, 4, 2) px."""


def shape(rig: StereoRig, side: int, board: Board, poses: BoardPoses, which: int) -> BoardShape:
    """What the left (0) or right (1) camera shows of pose `which`; what it does not show is left out."""
    s = board.square_m
    y, x = np.mgrid[-1 : board.rows + 1, -1 : board.cols + 1]
    corners = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3) * s
    uv = _project(rig, side, poses, which, corners).reshape(board.rows + 2, board.cols + 2, 2)
    squares = np.stack([uv[:-1, :-1], uv[:-1, 1:], uv[1:, 1:], uv[1:, :-1]], axis=2)
    row, column = np.mgrid[: board.rows + 1, : board.cols + 1]
    dark = squares[(row + column) % 2 == 0]
    ends = board.outline
    along = np.linspace(0, 1, _STEPS, endpoint=False)[:, None]
    rim = np.concatenate([a + along * (b - a) for a, b in zip(ends, np.roll(ends, -1, axis=0), strict=True)])
    return BoardShape(
        _shown(_project(rig, side, poses, which, rim)), dark[np.isfinite(dark).all(axis=(1, 2))]
    )


def _project(rig: StereoRig, side: int, poses: BoardPoses, which: int, points_board: Array) -> Array:
    points = points_board @ poses.R[which].T + poses.t[which]
    if side == 0:
        return rig.left.project(points)
    return rig.right.project(rig.right_from_left.apply(points))


def _shown(uv: Array) -> Array:
    return uv[np.isfinite(uv).all(axis=1)]
