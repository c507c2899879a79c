"""Pictures of a checker board as a rig of pinholes sees it: each pixel the mean of 4 x 4 rays."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image as Pillow

from rigsim.rig.arrays import Array, Image
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from tests.helpers.calibrate.board_pictures import boards_in_view

PHOTO_BOARD = Board(6, 5, 0.03)
PHOTO_RIG = StereoRig(
    Intrinsics.from_focal(320, 240, 280.0),
    Intrinsics.from_focal(320, 240, 285.0, cx=161.0, cy=118.5),
    Pose.from_rotvec([0.0, 0.03, 0.01], [-0.06, 0.001, 0.0]),
)
_RAYS = 4


def photo(camera: Intrinsics, board: Board, camera_from_board: Pose, seed: int) -> Image:
    """One picture (H, W), 8 bit, with 1.5 grey of noise."""
    fine = camera.supersampled(_RAYS)
    v, u = np.mgrid[: fine.height, : fine.width]
    R, t = camera_from_board.R, camera_from_board.t
    pixel_from_board = fine.K @ np.column_stack([R[:, 0], R[:, 1], t])
    board_from_pixel = np.linalg.inv(pixel_from_board)
    a, b, c = (row[0] * u + row[1] * v + row[2] for row in board_from_pixel)
    reach, x, y = c / np.linalg.det(board_from_pixel), a / c / board.square_m, b / c / board.square_m
    grey = np.full(u.shape, 150.0)
    on = (reach > 0) & (x > -1.6) & (x < board.cols + 0.6) & (y > -1.6) & (y < board.rows + 0.6)
    grey[on] = 220.0
    squares = (reach > 0) & (x > -1) & (x < board.cols) & (y > -1) & (y < board.rows)
    dark = (np.floor(x) + np.floor(y)) % 2 == 0
    grey[squares & dark] = 40.0
    mean: Array = grey.reshape(camera.height, _RAYS, camera.width, _RAYS).mean(axis=(1, 3))
    noise = np.random.default_rng(seed).normal(0, 1.5, mean.shape)
    return np.clip(np.rint(mean + noise), 0, 255).astype(np.uint8)


def photograph(folder: Path, count: int, empty: int | None = None) -> None:
    """left00.png, right00.png, ... of `count` poses; the pair called `empty` shows no board."""
    poses = boards_in_view(PHOTO_RIG, PHOTO_BOARD, count, seed=3, range_m=(0.3, 0.6))
    for k in range(count):
        left_from_board = Pose(poses.R[k], poses.t[k])
        away = Pose(left_from_board.R, np.array([50.0, 0.0, 1.0]))
        board = away if k == empty else left_from_board
        for side, name, camera in ((0, "left", PHOTO_RIG.left), (1, "right", PHOTO_RIG.right)):
            pose = board if side == 0 else PHOTO_RIG.right_from_left @ board
            Pillow.fromarray(photo(camera, PHOTO_BOARD, pose, 2 * k + side)).save(
                folder / f"{name}{k:02d}.png"
            )
