"""Where boards are held, and which cameras see them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array, Mask, frozen
from rigsim.rig.board import Board
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

Chosen: TypeAlias = "npt.NDArray[np.intp] | Mask | slice"


@dataclass(frozen=True, slots=True, eq=False)
class BoardPoses:
    """Boards' poses, left_from_board: ``x_left = R x_board + t``."""

    R: Array
    """Rotations (n, 3, 3)."""
    t: Array
    """Where each board's first corner is, (n, 3) m in the left camera's frame."""

    @classmethod
    def of(cls, left_from_board: npt.ArrayLike) -> BoardPoses:
        """Poses of rotation vectors (rad) and translations (m), (n, 6).

        Raises:
            InvalidRange: they are not six finite numbers each.
        """
        try:
            numbers = frozen(left_from_board)
        except (TypeError, ValueError):
            raise InvalidRange(
                "board poses: must be numbers, six a board: rx, ry, rz (rad), tx, ty, tz (m)"
            ) from None
        if numbers.size == 0:
            numbers = numbers.reshape(0, 6)
        if numbers.ndim != 2 or numbers.shape[1] != 6:
            raise InvalidRange(
                f"board poses of shape {numbers.shape}: must be (n, 6): rx, ry, rz (rad), tx, ty, tz (m)"
            )
        if not np.isfinite(numbers).all():
            raise InvalidRange("board poses: every number must be finite")
        return cls(rotations(numbers[:, :3]), numbers[:, 3:])

    def __len__(self) -> int:
        return len(self.t)

    @property
    def rows(self) -> Array:
        """Rotation vectors and translations (n, 6), as of `of`."""
        return np.array([[*Pose(R, t).rotvec_rad, *t] for R, t in zip(self.R, self.t, strict=True)]).reshape(
            -1, 6
        )

    def chosen(self, which: Chosen) -> BoardPoses:
        """Some of them."""
        return BoardPoses(self.R[which], self.t[which])

    def joined(self, other: BoardPoses) -> BoardPoses:
        """These, then those."""
        return BoardPoses(np.concatenate([self.R, other.R]), np.concatenate([self.t, other.t]))

    def points_left(self, points_board: Array) -> Array:
        """Points (m, 3) of the board's frame, (n, m, 3) m in the left camera's."""
        return np.asarray(points_board @ self.R.transpose(0, 2, 1) + self.t[:, None])

    def moved(self, change: Array) -> BoardPoses:
        """Poses turned by ``exp([w]x) R`` and shifted, `change` (n, 6): w rad, shift m."""
        return BoardPoses(rotations(change[:, :3]) @ self.R, self.t + change[:, 3:])

    def project(self, rig: StereoRig, board: Board) -> Array:
        """Pixels (n, 2, m, 2) of every board's m corners in the left and the right image; NaN where a
        camera shows nothing."""
        points = self.points_left(board.points)
        return np.stack(
            [rig.left.project(points), rig.right.project(rig.right_from_left.apply(points))], axis=1
        )


def rotations(rotvecs: Array) -> Array:
    """Rodrigues' formula: rotations (n, 3, 3) of rotation vectors (n, 3), rad."""
    angle = np.linalg.norm(rotvecs, axis=1)[:, None, None]
    k = -minus_skew(rotvecs)
    # np.sinc keeps both factors finite and exact at angle 0
    return np.asarray(
        np.eye(3) + np.sinc(angle / np.pi) * k + 0.5 * np.sinc(angle / (2 * np.pi)) ** 2 * (k @ k)
    )


def whole(rig: StereoRig, uv: Array, margin_px: float = 0.0) -> Mask:
    """Which cameras (n, 2) show all corners (n, 2, m, 2) of a board, `margin_px` off their image's rim."""
    seen = []
    for side, camera in enumerate((rig.left, rig.right)):
        u, v = uv[:, side, :, 0], uv[:, side, :, 1]
        inside = (u >= margin_px) & (u <= camera.width - 1 - margin_px)
        inside &= (v >= margin_px) & (v <= camera.height - 1 - margin_px)
        seen.append(inside.all(axis=1))
    return np.stack(seen, axis=1)


def minus_skew(arms: Array) -> Array:
    """``-[a]x`` (..., 3, 3): the derivative of ``exp([w]x) a`` in w at 0."""
    turn = np.zeros((*arms.shape, 3))
    x, y, z = arms[..., 0], arms[..., 1], arms[..., 2]
    turn[..., 0, 1], turn[..., 0, 2] = z, -y
    turn[..., 1, 0], turn[..., 1, 2] = -z, x
    turn[..., 2, 0], turn[..., 2, 1] = y, -x
    return turn


def rigid_moves(arms: Array) -> Array:
    """Derivative (..., 3, 6) of ``exp([w]x) a + t`` in (w, t) at 0."""
    return np.concatenate([minus_skew(arms), np.broadcast_to(np.eye(3), (*arms.shape, 3))], axis=-1)
