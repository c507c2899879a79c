"""What board pictures tell of a rig: the Fisher information of its bundle adjustment.

Residuals are corners' pixels, each with white noise of one standard deviation. Every board's pose is unknown
too, and is eliminated (Schur complement): what remains is the information on the rig alone, a sum over boards
(Triggs et al., "Bundle adjustment - a modern synthesis", 1999, section 6).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.board import Board
from rigsim.rig.stereo import StereoRig
from rigsim.theory.blocks import blocks
from rigsim.theory.calibration.boards import BoardPoses, Chosen, minus_skew
from rigsim.theory.calibration.parameters import RigParameters

_NUMBERS = 4_000_000
"""Numbers of a Jacobian that are held at once."""
_RIDGE = 1e-13
"""Of a board's own information: holds up a pose that its corners leave open."""


@dataclass(frozen=True, slots=True, eq=False)
class BoardInformation:
    """What each of n boards tells, for noise of 1 px: of p rig parameters, and of its own 6."""

    rig: Array
    """``J^T J`` of the rig's parameters (n, p, p)."""
    cross: Array
    """``J^T J`` of the rig's parameters with the board's pose (n, p, 6)."""
    pose: Array
    """``J^T J`` of the board's pose (n, 6, 6)."""
    root: Array | None = None
    """``r`` (n, k, p) with ``reduced = r^T r``, from the Jacobian itself: squares lose half of the digits,
    and a rational lens has parameters that need them. None where only squares are known."""

    @property
    def gain(self) -> Array:
        """How a board's pose follows the rig's parameters, ``-pose^-1 cross^T`` (n, 6, p)."""
        return -self._solved(self.cross.transpose(0, 2, 1))

    @property
    def reduced(self) -> Array:
        """What each board tells of the rig when its pose is unknown, (n, p, p)."""
        if self.root is not None:
            return np.asarray(self.root.transpose(0, 2, 1) @ self.root)
        told = self.rig + self.cross @ self.gain
        return np.asarray((told + told.transpose(0, 2, 1)) / 2)

    @property
    def pose_covariance(self) -> Array:
        """Covariance (n, 6, 6) of each board's pose if the rig were known."""
        return self._solved(np.broadcast_to(np.eye(6), self.pose.shape))

    def chosen(self, which: Chosen) -> BoardInformation:
        """That of some boards."""
        root = None if self.root is None else self.root[which]
        return BoardInformation(self.rig[which], self.cross[which], self.pose[which], root)

    def _solved(self, right: Array) -> Array:
        scale = 1 / np.sqrt(np.maximum(np.einsum("nii->ni", self.pose), 1e-300))
        unit = self.pose * scale[:, :, None] * scale[:, None, :] + _RIDGE * np.eye(6)
        return np.asarray(scale[:, :, None] * np.linalg.solve(unit, scale[:, :, None] * right))


def slopes(rig: StereoRig, parameters: RigParameters, board: Board, poses: BoardPoses) -> tuple[Array, Array]:
    """Derivative of all corners' pixels with respect to the rig (n, 2, m, 2, p) and the pose (n, 2, m, 2, 6).

    Axes are board, camera, corner, (u, v). A pose moves as in `BoardPoses.moved`. NaN where a camera shows
    nothing.
    """
    p = len(parameters.names)
    arms = np.einsum("nij,mj->nmi", poses.R, board.points)
    points = arms + poses.t[:, None]
    turned_left = minus_skew(arms)
    n, m = points.shape[:2]
    J = np.zeros((n, 2, m, 2, p))
    J_pose = np.empty((n, 2, m, 2, 6))
    R = rig.right_from_left.R
    turned = points @ R.T
    points_right = turned + rig.right_from_left.t
    for side, camera, seen in ((0, rig.left, points), (1, rig.right, points_right)):
        J[:, side, :, :, parameters.columns(side)] = parameters.camera_slopes(rig, side, seen)
        by_point = camera.jacobian(seen)
        if side == 1:
            turn, shift = parameters.pose.start, parameters.pose.start + 3
            J[:, 1, :, :, turn:shift] = by_point @ minus_skew(turned)
            J[:, 1, :, :, shift : shift + 3] = by_point
            by_point = by_point @ R
        J_pose[:, side, :, :, :3] = by_point @ turned_left
        J_pose[:, side, :, :, 3:] = by_point
        if parameters.warped:
            along_z = np.einsum("nmkj,nj->nmk", by_point, poses.R[:, :, 2])
            J[:, side, :, :, parameters.warp] = along_z[..., None] * board.warp_shape[:, None, :]
    return J, J_pose


def board_information(
    rig: StereoRig,
    parameters: RigParameters,
    board: Board,
    poses: BoardPoses,
    seen: Mask | None = None,
    *,
    rooted: bool = True,
    weights: Array | None = None,
) -> BoardInformation:
    """What each board tells of a rig's parameters.

    Args:
        rig: The rig.
        parameters: What is estimated.
        board: The board.
        poses: Where it is held, n times.
        seen: Which cameras (n, 2), or corners of them (n, 2, m), count; by default all that are shown.
        rooted: Whether `BoardInformation.root` is found as well, which takes ten times as long.
        weights: 1 over each corner's noise (n, 2, m) as a multiple of the others'; by default 1.
    """
    n, m, p = len(poses), board.rows * board.cols, len(parameters.names)
    roots: list[Array] = []
    told = BoardInformation(np.zeros((n, p, p)), np.zeros((n, p, 6)), np.zeros((n, 6, 6)))
    for part in blocks(n, max(_NUMBERS // (4 * m * p), 1)):
        J, J_pose = slopes(rig, parameters, board, poses.chosen(part))
        shown = np.isfinite(J_pose[..., 0, 0])
        if seen is not None:
            shown &= seen[part] if seen.ndim == 3 else seen[part][:, :, None]
        J[~shown], J_pose[~shown] = 0.0, 0.0
        if weights is not None:
            J, J_pose = (each * weights[part][..., None, None] for each in (J, J_pose))
        J, J_pose = J.reshape(len(J), -1, p), J_pose.reshape(len(J), -1, 6)
        transposed = J.transpose(0, 2, 1)
        told.rig[part], told.cross[part] = transposed @ J, transposed @ J_pose
        told.pose[part] = J_pose.transpose(0, 2, 1) @ J_pose
        if rooted:
            # the triangle's lower right: what is left of the rig's columns beside the pose's
            roots.append(np.asarray(np.linalg.qr(np.concatenate([J_pose, J], axis=2), mode="r"))[:, 6:, 6:])
    return replace(told, root=np.concatenate(roots)) if roots else told
