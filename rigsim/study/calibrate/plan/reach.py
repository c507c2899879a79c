"""Poses that somebody can hold a board in, and that cameras see whole."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.board import Board
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.plan.asked import PlanAsked
from rigsim.study.calibrate.plan.held import LEAST_SQUARE_PX as LEAST_SQUARE_PX
from rigsim.study.calibrate.plan.held import drawn_poses, middle_of, smallest_square_px
from rigsim.study.calibrate.plan.unreachable import out_of_reach
from rigsim.theory.calibration.boards import BoardPoses, Chosen, whole

_MOST_OBLIQUE_RAD = math.radians(65)
"""Most between a board's normal and the line of sight, unless the tilt that was asked for is more."""
_BATCH = 4096
_MOST_BATCHES = 8
_ENOUGH_BATCHES = 3
"""After so many a few poses will do, and none is a sign that there are none."""


@dataclass(frozen=True, slots=True, eq=False)
class ReachedPoses:
    """Poses, and which cameras see each whole."""

    poses: BoardPoses
    """n of them."""
    seen: Mask
    """The left and the right camera, (n, 2)."""

    def __len__(self) -> int:
        return len(self.poses)

    @property
    def both(self) -> Mask:
        """Which both cameras see, (n,)."""
        return np.asarray(self.seen.all(axis=1))

    def chosen(self, which: Chosen) -> ReachedPoses:
        """Some of them."""
        return ReachedPoses(self.poses.chosen(which), self.seen[which])

    def joined(self, other: ReachedPoses) -> ReachedPoses:
        """These, then those."""
        return ReachedPoses(self.poses.joined(other.poses), np.concatenate([self.seen, other.seen]))


def random_poses(asked: PlanAsked, count: int, rng: np.random.Generator, alone: int = 0) -> ReachedPoses:
    """`count` random poses that both cameras see whole, and up to `alone` that one camera alone does.

    Fewer if they are hard to find.

    Raises:
        InvalidRange: there is none that both cameras see whole.
    """
    shared, single = _none(), _none()
    for batch in range(_MOST_BATCHES):
        found = reachable(asked, drawn_poses(asked, _BATCH, rng))
        shared = shared.joined(found.chosen(found.both))
        single = single.joined(found.chosen(~found.both))
        if len(shared) >= count or (
            batch + 1 >= _ENOUGH_BATCHES and (not len(shared) or len(shared) >= count / 5)
        ):
            break
    if not len(shared):
        raise out_of_reach(asked, lambda changed, poses: bool(reachable(changed, poses).both.any()))
    return shared.chosen(slice(0, count)).joined(single.chosen(slice(0, alone)))


def reachable(asked: PlanAsked, poses: BoardPoses) -> ReachedPoses:
    """Those poses that a camera sees whole, large and straight enough for a finder, within the reach."""
    rig, board, reach = asked.rig, asked.board, asked.reach
    middle = poses.points_left(middle_of(board)[None])[:, 0]
    distance = np.linalg.norm(middle, axis=1)
    near = (distance >= reach.near_m * (1 - 1e-9)) & (distance <= reach.far_m * (1 + 1e-9))
    poses, middle = poses.chosen(near), middle[near]
    # its rim first: most poses fail there already
    seen = whole(rig, _project(rig, poses, _rim(board)), reach.margin_px)
    seen &= _straight(rig, poses, middle, max(_MOST_OBLIQUE_RAD, reach.tilt_rad))
    some = np.asarray(seen.any(axis=1))
    poses, seen = poses.chosen(some), seen[some]
    uv = poses.project(rig, board)
    seen &= whole(rig, uv, reach.margin_px) & (smallest_square_px(uv, board) >= LEAST_SQUARE_PX)
    some = np.asarray(seen.any(axis=1))
    return ReachedPoses(poses.chosen(some), seen[some])


def _none() -> ReachedPoses:
    return ReachedPoses(BoardPoses.of(np.zeros((0, 6))), np.zeros((0, 2), dtype=bool))


def _rim(board: Board) -> Array:
    """Points (k, 3) m all round, half a square outside the corners: finders need what is around a corner."""
    grid = replace(board, warp_m=(0.0, 0.0)).points.reshape(board.rows, board.cols, 3)
    (w, h), half = board.size_m, board.square_m / 2
    rim = np.concatenate([grid[0], grid[-1], grid[1:-1, 0], grid[1:-1, -1]])
    outwards = np.array([(w + 2 * half) / w, (h + 2 * half) / h, 1.0])
    middle = np.array([w / 2, h / 2, 0.0])
    return np.asarray(middle + (rim - middle) * outwards)


def _project(rig: StereoRig, poses: BoardPoses, points_board: Array) -> Array:
    points = poses.points_left(points_board)
    return np.stack([rig.left.project(points), rig.right.project(rig.right_from_left.apply(points))], axis=1)


def _straight(rig: StereoRig, poses: BoardPoses, middle: Array, most_rad: float) -> Mask:
    """Whether each camera sees the board's front at no more than `most_rad` to its normal, (n, 2)."""
    seen = []
    for centre in (np.zeros(3), rig.right_from_left.inverse.t):
        sight = middle - centre
        along = np.einsum("ni,ni->n", sight, poses.R[:, :, 2])
        seen.append(along >= np.cos(most_rad) * np.linalg.norm(sight, axis=1))
    return np.stack(seen, axis=1)
