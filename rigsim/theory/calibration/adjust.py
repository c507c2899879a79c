"""Calibration by least squares: the rig, and every board's pose, that explain the corners best.

Levenberg and Marquardt's steps on the analytic Jacobian of `slopes`; the boards' poses are eliminated from
every step (Schur complement), so its cost grows with the number of boards alone.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.board import Board
from rigsim.rig.stereo import StereoRig
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.information import BoardInformation, board_information, slopes
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
    parameters: RigParameters
    """What was looked for."""
    settled: bool
    """Whether steps had become negligible."""
    weights: Array | None = None
    """What each corner's residuals (n, 2, m) were multiplied by; None is 1."""

    @property
    def rms_px(self) -> float:
        """Root mean square of one coordinate's residual."""
        return float(np.sqrt(np.nanmean(self.residuals**2)))

    @property
    def information(self) -> BoardInformation:
        """What the boards tell, at the solution."""
        seen = np.isfinite(self.residuals[..., 0])
        return board_information(
            self.rig, self.parameters, self.board, self.poses, seen, weights=self.weights
        )


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
        weights: What each corner's residuals (n, 2, m) are multiplied by: 1 over its noise as a multiple of
            the others'. By default 1.
    """
    state, settled = _settled(_State.at(rig, parameters, board, poses, observed, weights))
    return Adjusted(state.rig, state.poses, state.board, state.residuals, parameters, settled, weights)


def _settled(state: _State) -> tuple[_State, bool]:
    """The state that steps end at, and whether they had become negligible."""
    parameters, basis = state.parameters, state.parameters.basis(state.rig)
    damping, enough = _FIRST_DAMPING, _STILL_PX**2 * state.residuals.size
    for _ in range(_MOST_STEPS):
        step, pose_steps = state.slopes.step(basis, damping, state.weighted)
        try:
            trial = _State.at(
                parameters.moved(state.rig, step),
                parameters,
                parameters.warped_board(state.board, step),
                state.poses.moved(pose_steps),
                state.observed,
                state.weights,
            )
            better = trial.cost <= state.cost
        except InvalidRig:
            better = False
        if not better:
            damping *= 10
            if damping > _MOST_DAMPING:
                break
            continue
        still = state.cost - trial.cost <= _STILL * state.cost + enough
        state, damping = trial, max(damping / 10, 1e-15)
        if still:
            return state, True
    return state, False


@dataclass(frozen=True, slots=True, eq=False)
class _State:
    rig: StereoRig
    parameters: RigParameters
    board: Board
    poses: BoardPoses
    observed: Array
    weights: Array | None
    residuals: Array
    cost: float
    _slopes: list[_Slopes]

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
        # a corner that is not explained at all must cost something: it counts as unseen only if it was
        lost = np.isfinite(observed) & ~np.isfinite(residuals)
        cost = np.inf if lost.any() else float(np.nansum(_weighted(residuals, weights) ** 2))
        return cls(rig, parameters, board, poses, observed, weights, residuals, cost, [])

    @property
    def weighted(self) -> Array:
        """The residuals as they count."""
        return _weighted(self.residuals, self.weights)

    @property
    def slopes(self) -> _Slopes:
        """Made when they are asked for: the last state's are not."""
        if not self._slopes:
            known = np.isfinite(self.residuals)
            counted = known if self.weights is None else known * self.weights[..., None]
            self._slopes.append(_Slopes.at(self.rig, self.parameters, self.board, self.poses, counted))
        return self._slopes[0]


def _weighted(residuals: Array, weights: Array | None) -> Array:
    return residuals if weights is None else residuals * weights[..., None]


@dataclass(frozen=True, slots=True, eq=False)
class _Slopes:
    rig: Array
    """By the rig's parameters, transposed: (n, p, 4 m)."""
    poses: Array
    """By the poses, transposed: (n, 6, 4 m)."""
    information: BoardInformation

    @classmethod
    def at(
        cls,
        rig: StereoRig,
        parameters: RigParameters,
        board: Board,
        poses: BoardPoses,
        counted: Array | Mask,
    ) -> _Slopes:
        J, J_pose = slopes(rig, parameters, board, poses)
        unknown = counted == 0
        J[unknown], J_pose[unknown] = 0.0, 0.0
        if counted.dtype != bool:
            J, J_pose = J * counted[..., None], J_pose * counted[..., None]
        n, p = len(poses), len(parameters.names)
        flat, flat_pose = J.reshape(n, -1, p), J_pose.reshape(n, -1, 6)
        by_rig, by_pose = flat.transpose(0, 2, 1), flat_pose.transpose(0, 2, 1)
        return cls(by_rig, by_pose, BoardInformation(by_rig @ flat, by_rig @ flat_pose, by_pose @ flat_pose))

    def step(self, basis: Array, damping: float, residuals: Array) -> tuple[Array, Array]:
        """Steps of the rig (p,) and of the poses (n, 6) that residuals (n, 2, m, 2) ask for."""
        told = self.information
        r = np.nan_to_num(residuals).reshape(len(residuals), -1, 1)
        toward_rig, toward_poses = (self.rig @ r)[:, :, 0], (self.poses @ r)[:, :, 0]
        damped = told.pose + damping * np.einsum("nii->ni", told.pose)[:, :, None] * np.eye(6)
        information = replace(told, pose=damped)
        gain = information.gain
        toward = toward_rig + np.einsum("npi,ni->np", gain.transpose(0, 2, 1), toward_poses)
        free = basis.T @ information.reduced.sum(axis=0) @ basis
        scale = 1 / np.sqrt(np.maximum(np.diagonal(basis.T @ told.rig.sum(axis=0) @ basis), 1e-300))
        unit = free * scale[:, None] * scale + damping * np.eye(len(scale))
        values, vectors = np.linalg.eigh(unit)
        # what the corners leave open stays where it is
        inverse = np.where(values > 1e-14, 1 / np.maximum(values, 1e-14), 0.0)
        right = vectors.T @ (scale * (basis.T @ toward.sum(axis=0)))
        step = basis @ (scale * (vectors @ (inverse * right)))
        own = np.einsum("nij,nj->ni", information.pose_covariance, toward_poses)
        return step, own + gain @ step
