"""Boards as a person holds them."""

from __future__ import annotations

import math

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.study.calibrate.plan.asked import PlanAsked, Reach
from rigsim.theory.calibration.boards import BoardPoses, rotations, whole

LEAST_SQUARE_PX = 6.0
"""Shortest side of a square, as it is seen, whose corners finders still find."""
HELD_TIMES = 20
"""How often poses are held again, to see what hands make of them."""
HAND_M, HAND_RAD = 0.03, math.radians(4)
"""How far a hand misses a pose, standard deviation along and about each axis: the sheet for the bench calls a
hand's breadth and 10 deg near enough, which are 2.5 of these."""
_TRIES = (1.0, 1.0, 1.0, 1.0, 0.5, 0.5, 0.25, 0.0)
"""Shares of a miss: whom it takes out of the picture tries again, more carefully."""
_ROLL_RAD = math.radians(15)
_STILL_FLAT_RAD = math.radians(55)
"""A board this far off the axis still stands parallel to the picture; farther out it faces the camera."""


def drawn_poses(asked: PlanAsked, count: int, rng: np.random.Generator) -> BoardPoses:
    """Random poses all over both pictures, at random distances, tilts and a little roll; seen or not."""
    rig, board, reach = asked.rig, asked.board, asked.reach
    middle = np.concatenate(
        [
            _places(rig.left, reach, count - count // 2, rng),
            (_places(rig.right, reach, count // 2, rng) - rig.right_from_left.t) @ rig.right_from_left.R,
        ]
    )
    middle = rng.permutation(middle[np.isfinite(middle).all(axis=1)])
    return facing(board, middle, _turned(len(middle), reach.tilt_rad, rng))


def facing(board: Board, middle: Array, turn: Array) -> BoardPoses:
    """Boards around `middle` (n, 3) m that stand parallel to the left picture, or face the camera where that
    is far out, and are turned by `turn` (n, 3, 3) out of that."""
    rays = middle / np.linalg.norm(middle, axis=1)[:, None]
    off = np.arccos(np.clip(rays[:, 2], -1, 1))
    out = np.hypot(rays[:, 0], rays[:, 1])
    toward = np.maximum(off - _STILL_FLAT_RAD, 0) / np.maximum(out, 1e-12)
    base = rotations(np.column_stack([-rays[:, 1] * toward, rays[:, 0] * toward, 0 * toward]))
    R = base @ turn
    return BoardPoses(R, middle - R @ middle_of(board))


def middle_of(board: Board) -> Array:
    """The middle of a board, flat, in its own frame (3,) m."""
    return np.array([board.size_m[0] / 2, board.size_m[1] / 2, 0.0])


def held_by_hand(asked: PlanAsked, poses: BoardPoses, seen: Mask, rng: np.random.Generator) -> BoardPoses:
    """The poses as somebody holds them who was shown them: a little elsewhere, turned a little about the
    board's middle, but as `seen` (n, 2) as they were. The first ones do not hang on how many follow."""
    misses = rng.standard_normal((len(poses), len(_TRIES), 6)) * np.array([HAND_RAD] * 3 + [HAND_M] * 3)
    middle, arm = poses.points_left(middle_of(asked.board)[None])[:, 0], middle_of(asked.board)
    R, t, open_ = poses.R.copy(), poses.t.copy(), np.ones(len(poses), dtype=bool)
    for which, share in enumerate(_TRIES):
        turn = rotations(share * misses[:, which, :3]) @ poses.R
        tried = BoardPoses(turn, middle + share * misses[:, which, 3:] - turn @ arm)
        fits = open_ & (whole(asked.rig, tried.project(asked.rig, asked.board)) | ~seen).all(axis=1)
        R[fits], t[fits] = tried.R[fits], tried.t[fits]
        open_ &= ~fits
    return BoardPoses(R, t)


def smallest_square_px(uv: Array, board: Board) -> Array:
    """Shortest side (n, 2) px of a square as each camera shows it, of corners (n, 2, m, 2)."""
    grid = uv.reshape(*uv.shape[:2], board.rows, board.cols, 2)
    across = np.linalg.norm(np.diff(grid, axis=3), axis=-1).min(axis=(2, 3))
    down = np.linalg.norm(np.diff(grid, axis=2), axis=-1).min(axis=(2, 3))
    return np.asarray(np.minimum(across, down))


def _places(camera: Intrinsics, reach: Reach, count: int, rng: np.random.Generator) -> Array:
    """Points (count, 3) m of a camera's frame, even over its picture; NaN where it shows nothing."""
    uv = rng.uniform((0, 0), (camera.width - 1, camera.height - 1), (count, 2))
    return np.asarray(camera.ray(uv) * rng.uniform(reach.near_m, reach.far_m, count)[:, None])


def _turned(count: int, tilt_rad: float, rng: np.random.Generator) -> Array:
    """Tilts about any axis in the board's plane after a roll, (count, 3, 3)."""
    roll = np.zeros((count, 3))
    roll[:, 2] = rng.uniform(-_ROLL_RAD, _ROLL_RAD, count)
    about, tilt = rng.uniform(0, 2 * np.pi, count), rng.uniform(0, tilt_rad, count)
    tilts = np.column_stack([tilt * np.cos(about), tilt * np.sin(about), np.zeros(count)])
    return np.asarray(rotations(tilts) @ rotations(roll))
