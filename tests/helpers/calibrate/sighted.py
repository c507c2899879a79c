"""Corners of boards as a rig sees them, with noise, and what is wrong with some of them."""

from __future__ import annotations

import numpy as np

from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.pictures.look import Looked, Seen
from rigsim.study.calibrate.pictures.pairs import PicturePair
from rigsim.study.calibrate.pictures.sightings import Sightings
from tests.helpers.calibrate.board_pictures import boards_in_view

BOARD = Board(9, 6, 0.03)
RIG = StereoRig(
    Intrinsics(1280, 960, 1000.0, 1001.0, 645.0, 470.0, BrownConrady(-0.2, 0.05, 1e-3, -5e-4)),
    Intrinsics(1280, 960, 1010.0, 1012.0, 630.0, 485.0, BrownConrady(-0.21, 0.06, 5e-4, 5e-4)),
    Pose.from_rotvec([0.01, 0.05, -0.02], [-0.12, 0.002, 0.003]),
)


def sightings(
    count: int = 10, noise_px: float = 0.1, seed: int = 0, board: Board = BOARD, seen: Board | None = None
) -> Sightings:
    """`count` boards in view of `RIG`, whose corners have noise; `seen` is the board as it really is."""
    poses = boards_in_view(RIG, board, count, seed=7)
    exact = poses.project(RIG, board if seen is None else seen)
    noise = np.random.default_rng(seed).standard_normal(exact.shape)
    names = tuple(f"{k:02d}" for k in range(count))
    return Sightings.of(board, names, exact + noise_px * noise, ((1280, 960), (1280, 960)))


def looked(found: Sightings) -> Looked:
    """As pictures would have shown them."""
    pairs = tuple(PicturePair(f"left{name}.png", f"right{name}.png") for name in found.names)
    words: tuple[Seen, Seen] = ("not_found", "found")
    seen = [(words[int(left)], words[int(right)]) for left, right in found.cameras]
    return Looked(found, pairs, tuple(seen))
