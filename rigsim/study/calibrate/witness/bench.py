"""What is calibrated over and over, and how far off each calibration's depths are."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.board import Board
from rigsim.rig.pose import Pose, rotvec_from_rotation
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.plan.result import CalibrationPlan
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.covariance import CalibrationCovariance, covariance_of
from rigsim.theory.calibration.flatness import warp_moves, with_warps, without_warps
from rigsim.theory.calibration.information import board_information
from rigsim.theory.calibration.parameters import RigParameters
from rigsim.theory.triangulation import triangulate


@dataclass(frozen=True, slots=True, eq=False)
class CalibrationBench:
    """One planned calibration, as it is made many times."""

    rig: StereoRig
    """The rig, in the lens models of `parameters`: where calibrations start."""
    parameters: RigParameters
    """What is looked for."""
    board: Board
    """The board as whoever calibrates takes it."""
    poses: BoardPoses
    """Where it is held, n times."""
    seen: Mask
    """Which cameras see it whole, (n, 2)."""
    corner_noise_px: float
    """Standard deviation of one coordinate of a corner, px."""
    at_m: tuple[float, ...]
    """Depths on the left optical axis that are told, m."""
    flatness_m: float = 0.0
    """Standard deviation of the board's two warps, m: each calibration has a board of its own, unless
    `true_board` says which."""
    true_rig: StereoRig | None = None
    """What the cameras really are, where a model cannot say it; None is `rig`."""
    true_board: Board | None = None
    """What the board really is; None is `board`."""

    @classmethod
    def of(
        cls, plan: CalibrationPlan, true_rig: StereoRig | None = None, true_board: Board | None = None
    ) -> CalibrationBench:
        """That of a plan; the depth that its poses are chosen for is told too."""
        asked = plan.asked
        chosen_m = asked.chosen_for_m
        told = any(math.isclose(z_m, chosen_m) for z_m in asked.at_m)
        at_m = asked.at_m if told else tuple(sorted((*asked.at_m, chosen_m)))
        return cls(
            asked.rig,
            asked.parameters,
            asked.board,
            plan.poses,
            plan.seen,
            asked.corner_noise_px,
            at_m,
            asked.flatness_m,
            true_rig,
            true_board,
        )

    def chosen(self, which: Mask) -> CalibrationBench:
        """The same with some of its boards, `which` (n,)."""
        return replace(self, poses=self.poses.chosen(which), seen=self.seen[which])

    @property
    def truth(self) -> StereoRig:
        """The rig that the pictures are of."""
        return self.rig if self.true_rig is None else self.true_rig

    @property
    def held(self) -> Board:
        """The board that is in them."""
        return self.board if self.true_board is None else self.true_board

    @property
    def in_model(self) -> bool:
        """Whether the calibration's model can say what is true, or the covariance how far it cannot."""
        return self.true_rig is None and (self.true_board is None or self.parameters.warped)

    @property
    def points(self) -> Array:
        """The points (k, 3) m in the left camera's frame whose depths are told."""
        return np.array([(0.0, 0.0, z_m) for z_m in self.at_m])

    @property
    def exact(self) -> Array:
        """Pixels (n, 2, m, 2) of the corners; NaN where a camera is not to see a board."""
        uv = self.poses.project(self.truth, self.held)
        return np.where(self.seen[:, :, None, None], uv, np.nan)

    @property
    def warps(self) -> bool:
        """Whether each calibration's board has a warp of its own."""
        return self.flatness_m > 0 and self.true_board is None

    def drawn(self, rng: np.random.Generator) -> CalibrationBench:
        """With a board that is as flat as `flatness_m` says."""
        if not self.warps:
            return self
        by_x, by_y = self.board.warp_m + self.flatness_m * rng.standard_normal(2)
        return replace(self, true_board=replace(self.board, warp_m=(float(by_x), float(by_y))))

    def covariance(self, noise_px: float) -> CalibrationCovariance:
        """What the covariance predicts for corners of this noise, px.

        Raises:
            Undetermined: the boards leave a parameter open.
        """
        rig, parameters, poses = self.rig, self.parameters, self.poses
        astray = self.warps and not parameters.warped
        wider = with_warps(parameters) if astray else parameters
        warping = board_information(rig, wider, self.board, poses, self.seen)
        if not astray:
            return covariance_of(rig, parameters, poses, warping, noise_px)
        per_px = covariance_of(rig, parameters, poses, without_warps(warping), 1.0)
        moves = self.flatness_m * warp_moves(per_px, poses, warping)
        return replace(per_px, matrix=noise_px**2 * per_px.matrix + moves @ moves.T)

    def errors(self, found: StereoRig, poses: BoardPoses, board: Board | None = None) -> CalibrationErrors:
        """How far off one calibration is, that took boards to be at `poses`, and found them to be `board`."""
        motion = boards_motion(poses, self.poses)
        parameters = np.full(len(self.parameters.names) + 6, np.nan)
        if self.in_model:
            change = change_of(self.parameters, self.rig, found)
            if self.parameters.warped and board is not None:
                change[self.parameters.warp] = np.subtract(board.warp_m, self.held.warp_m)
            parameters = np.array([*change, *motion.rotvec_rad, *motion.t])
        return CalibrationErrors(depth_errors(found, motion, self.truth, self.points), parameters)


@dataclass(frozen=True, slots=True, eq=False)
class CalibrationErrors:
    """Errors of one calibration, or of several, a row each."""

    depth_m: Array
    """Of the depth of each of the bench's points, against the boards, m."""
    parameters: Array
    """Of the rig's parameters and of the boards' frame, as `CalibrationCovariance.names`; NaN where the
    model cannot say what is true."""


def boards_motion(found: BoardPoses, true: BoardPoses) -> Pose:
    """The boards' mean motion, found_from_true, in the left camera's frame.

    Each board's own is a rotation ``R_found R_true^T`` and a shift; rotations are averaged as matrices
    (the nearest rotation to their mean), shifts as vectors. To first order it is what `covariance_of`
    calls the frame.
    """
    turns = found.R @ true.R.transpose(0, 2, 1)
    shifts = found.t - np.einsum("nij,nj->ni", turns, true.t)
    U, _, V = np.linalg.svd(turns.mean(axis=0))
    U[:, 2] *= np.linalg.det(U @ V)
    return Pose(U @ V, shifts.mean(axis=0))


def depth_errors(found: StereoRig, motion: Pose, true: StereoRig, points_left: Array) -> Array:
    """Errors (k,) m of the depth of points (k, 3) that `found` triangulates from the pixels in which `true`
    shows them, when the boards it was calibrated by are laid onto the true ones."""
    triangulated = triangulate(found, *true.project(points_left))
    return np.asarray(motion.inverse.apply(triangulated)[:, 2] - points_left[:, 2])


def change_of(parameters: RigParameters, rig: StereoRig, found: StereoRig) -> Array:
    """By how much each parameter (p,) of `found` is larger: ``parameters.moved(rig, change)`` is `found`.

    The board's warps, which are no numbers of a rig, are 0.
    """
    was, now = (
        [*_camera_numbers(parameters, one, 0), *_camera_numbers(parameters, one, 1)] for one in (rig, found)
    )
    turn = rotvec_from_rotation(found.right_from_left.R @ rig.right_from_left.R.T)
    change = np.zeros(len(parameters.names))
    change[: len(now)] = np.subtract(now, was)
    change[parameters.pose] = *turn, *(found.right_from_left.t - rig.right_from_left.t)
    return change


def _camera_numbers(parameters: RigParameters, rig: StereoRig, side: int) -> list[float]:
    """Of the left (0) or right (1) camera, as `RigParameters.columns`."""
    camera, model, lens = (rig.left, rig.right)[side], parameters.lenses[side], parameters.lens(rig, side)
    own = [] if model is None else [float(getattr(lens, name)) for name in model.names()]
    return [camera.fx, camera.fy, camera.cx, camera.cy, *own]
