"""Calibration by least squares: the rig, and every board's pose, that explain the corners best.

Levenberg and Marquardt's steps on the analytic Jacobian of `slopes`; the boards' poses are eliminated from
every step (Schur complement), so its cost grows with the number of boards alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.rig.stereo import StereoRig
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.information import BoardInformation, slopes
from rigsim.theory.calibration.parameters import RigParameters

_MOST_STEPS = 60
_MOST_DAMPING = 1e10
_FIRST_DAMPING = 1e-6
_STILL = 1e-9
"""Change of the sum of squares, as a share of it, below which steps end."""
_STILL_PX = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Adjusted:
    """What explains the corners best."""

    rig: StereoRig
    """The rig."""
    poses: BoardPoses
    """Where the boards were."""
    board: Board
    """The board, with the warp that was found if it was looked for."""
    residuals: Array
    """Observed minus explained pixels (n, 2, m, 2); NaN where nothing was observed."""
    information: BoardInformation
    """What the boards tell, at the solution."""
    settled: bool
    """Whether steps had become negligible."""

    @property
    def rms_px(self) -> float:
        """Root mean square of one coordinate's residual."""
        return float(np.sqrt(np.nanmean(self.residuals**2)))


def adjust(
    rig: StereoRig,
    parameters: RigParameters,
    board: Board,
    poses: BoardPoses,
    observed: Array,
    weights: Array | None = None,
) -> Adjusted:
    """The rig, poses and, if they are `parameters`, the board's warps that minimise the squared residuals.

    Args:
        rig: Where to start, in the lens models of `parameters`.
        parameters: What is looked for, and what is held.
        board: The board; its corners are exact.
        poses: Where to start, n of them.
        observed: Pixels (n, 2, m, 2) of each board's corners in the left and the right image; NaN where a
            camera did not see one.
        weights: What each corner's residuals (n, 2, m) are multiplied by, 1 over its noise as a multiple of
            the others'; by default 1.
    """
    basis = parameters.basis(rig)
    state = _State.at(rig, parameters, board, poses, observed, weights)
    damping, settled = _FIRST_DAMPING, False
    for _ in range(_MOST_STEPS):
        step, pose_steps = state.step(basis, damping)
        try:
            moved = parameters.moved(state.rig, step)
            warped = parameters.warped_board(state.board, step)
            trial = _State.at(moved, parameters, warped, state.poses.moved(pose_steps), observed, weights)
            better = trial.cost <= state.cost
        except InvalidRig:
            better = False
        if not better:
            damping *= 10
            if damping > _MOST_DAMPING:
                break
            continue
        settled = state.cost - trial.cost <= _STILL * state.cost + _STILL_PX**2 * observed.size
        state, damping = trial, max(damping / 10, 1e-15)
        if settled:
            break
    return Adjusted(state.rig, state.poses, state.board, state.residuals, state.information, settled)


@dataclass(frozen=True, slots=True, eq=False)
class _State:
    rig: StereoRig
    board: Board
    poses: BoardPoses
    residuals: Array
    information: BoardInformation
    toward_rig: Array
    toward_poses: Array
    cost: float

    @classmethod
    def at(
        cls,
        rig: StereoRig,
        parameters: RigParameters,
        board: Board,
        poses: BoardPoses,
        observed: Array,
        weights: Array | None,
    ) -> _State:
        residuals = observed - poses.project(rig, board)
        J, J_pose = slopes(rig, parameters, board, poses)
        # a corner that is not explained at all must cost something: it counts as unseen only if it was
        lost = np.isfinite(observed) & ~np.isfinite(residuals)
        known = np.isfinite(residuals)
        r = np.where(known, residuals, 0.0)
        J[~known], J_pose[~known] = 0.0, 0.0
        if weights is not None:
            r, J, J_pose = (
                r * weights[..., None],
                J * weights[..., None, None],
                J_pose * weights[..., None, None],
            )
        n, p = len(poses), len(parameters.names)
        flat, flat_pose, r_flat = J.reshape(n, -1, p), J_pose.reshape(n, -1, 6), r.reshape(n, -1, 1)
        transposed, transposed_pose = flat.transpose(0, 2, 1), flat_pose.transpose(0, 2, 1)
        information = BoardInformation(transposed @ flat, transposed @ flat_pose, transposed_pose @ flat_pose)
        cost = float(np.sum(r * r)) if not lost.any() else np.inf
        return cls(
            *(rig, board, poses, np.where(np.isfinite(observed), residuals, np.nan), information),
            (transposed @ r_flat)[:, :, 0],
            (transposed_pose @ r_flat)[:, :, 0],
            cost,
        )

    def step(self, basis: Array, damping: float) -> tuple[Array, Array]:
        """Steps of the rig (p,) and of the poses (n, 6)."""
        told = self.information
        damped = told.pose + damping * np.einsum("nii->ni", told.pose)[:, :, None] * np.eye(6)
        information = replace(told, pose=damped)
        gain = information.gain
        toward = self.toward_rig + np.einsum("npi,ni->np", gain.transpose(0, 2, 1), self.toward_poses)
        free = basis.T @ information.reduced.sum(axis=0) @ basis
        scale = 1 / np.sqrt(np.maximum(np.diagonal(basis.T @ told.rig.sum(axis=0) @ basis), 1e-300))
        unit = free * scale[:, None] * scale + damping * np.eye(len(scale))
        values, vectors = np.linalg.eigh(unit)
        # what the corners leave open stays where it is
        inverse = np.where(values > 1e-14, 1 / np.maximum(values, 1e-14), 0.0)
        right = vectors.T @ (scale * (basis.T @ toward.sum(axis=0)))
        step = basis @ (scale * (vectors @ (inverse * right)))
        own = np.einsum("nij,nj->ni", information.pose_covariance, self.toward_poses)
        return step, own + gain @ step
