"""How far a calibrated rig may be off: its parameters' covariance, and what it does to depths and pixels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRange
from rigsim.rig import given
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.theory.calibration.boards import BoardPoses, minus_skew, rigid_moves
from rigsim.theory.calibration.information import BoardInformation
from rigsim.theory.calibration.parameters import POSE, RigParameters
from rigsim.theory.uncertainty import pixel_gain

_LEAST_VALUE = 1e-12
"""Singular value of the Jacobian, every parameter in its own measure, over the largest: below, rounding."""


FRAME = tuple(f"frame.{name}" for name in POSE)
"""Motion of the boards in the left camera's frame, as their calibration has it: a turn about the left
camera's centre, rad, and a shift, m."""


@dataclass(frozen=True, slots=True, eq=False)
class CalibrationCovariance:
    """What a calibration leaves: the joint covariance of a rig's parameters, and of where it stands.

    A calibrated rig differs from the true one in its p parameters, which the left camera's frame is the gauge
    of, and that frame itself lies a little elsewhere among the boards: six more, `FRAME`. A depth that counts
    from the left camera does not ask for them; one that counts from the things themselves, as the boards
    were, does, and is surer: where the left lens's centre lies is of no matter to it.
    """

    rig: StereoRig
    """The rig as calibrated."""
    parameters: RigParameters
    """What the first p rows are."""
    matrix: Array
    """Covariance (p + 6, p + 6); 0 where a parameter is held. Units are in the `names`."""

    @property
    def names(self) -> tuple[str, ...]:
        """What the rows are."""
        return (*self.parameters.names, *FRAME)

    @property
    def of_rig(self) -> Array:
        """Covariance (p, p) of the rig's parameters."""
        return self.matrix[:-6, :-6]

    @property
    def std(self) -> Array:
        """Standard deviation of each of them, (p + 6,)."""
        return np.asarray(np.sqrt(np.maximum(np.diagonal(self.matrix), 0.0)))

    @property
    def correlation(self) -> Array:
        """Correlations (p + 6, p + 6); 0 with what is held."""
        std = self.std
        scale = np.divide(1.0, std, out=np.zeros_like(std), where=std > 0)
        unit = self.matrix * scale[:, None] * scale
        return np.asarray((unit + unit.T) / 2)

    def draws(self, count: int, rng: np.random.Generator) -> Array:
        """Errors (count, p + 6) of as many calibrations: normal, with this covariance."""
        values, vectors = np.linalg.eigh(self.correlation)
        factor = vectors * np.sqrt(np.maximum(values, 0.0))
        return np.asarray((rng.standard_normal((count, len(values))) @ factor.T) * self.std)

    def point_moves(self, points_left: npt.ArrayLike, *, from_camera: bool = False) -> Array:
        """Move (N, 3, p + 6) m of triangulated points (N, 3) per unit by which each is too large.

        Against the boards, or `from_camera`: as its own left camera sees it.
        """
        points = given.points(points_left)
        moves = np.zeros((len(points), 3, len(self.names)))
        moves[:, :, :-6] = point_moves(self.rig, self.parameters, points)
        if not from_camera:
            moves[:, :, -6:] = -rigid_moves(points)
        return moves

    def point_covariance(self, points_left: npt.ArrayLike, *, from_camera: bool = False) -> Array:
        """Covariance (N, 3, 3) m^2 of what `optimal` makes of points (N, 3), from the calibration alone."""
        moves = self.point_moves(points_left, from_camera=from_camera)
        return np.asarray(moves @ self.matrix @ moves.transpose(0, 2, 1))

    def depth_std(self, points_left: npt.ArrayLike, *, from_camera: bool = False) -> Array:
        """Standard deviation (N,) m of the depth from the calibration alone."""
        moves = self.point_moves(points_left, from_camera=from_camera)[:, 2]
        return np.asarray(np.sqrt(np.maximum(np.einsum("np,pq,nq->n", moves, self.matrix, moves), 0.0)))

    def projection_covariance(self, side: int, points_camera: npt.ArrayLike) -> Array:
        """Covariance (N, 2, 2) px^2 of where the left (0) or right (1) camera shows a point (N, 3) m.

        The point stands fixed among the boards: what a turn of the camera and its principal point share does
        not count (mrcal's uncertainty of projection by the mean of the boards' frames).
        """
        points, rig, parameters = given.points(points_camera), self.rig, self.parameters
        J = (rig.left, rig.right)[side].jacobian(points)
        moves = np.zeros((len(points), 2, len(self.names)))
        moves[:, :, parameters.columns(side)] = parameters.camera_slopes(rig, side, points)
        points_left = points
        if side == 1:
            turned = points - rig.right_from_left.t
            points_left = turned @ rig.right_from_left.R
            moves[:, :, parameters.pose] = J @ rigid_moves(turned)
            J = J @ rig.right_from_left.R
        moves[:, :, -6:] = J @ rigid_moves(points_left)
        return np.asarray(moves @ self.matrix @ moves.transpose(0, 2, 1))

    def projection_std(self, side: int, points_camera: npt.ArrayLike) -> Array:
        """Standard deviation (N,) px behind `projection_covariance`, in its worst direction."""
        covariance = self.projection_covariance(side, points_camera)
        return np.asarray(np.sqrt(np.maximum(np.linalg.eigvalsh(covariance)[:, -1], 0.0)))


def covariance_of(
    rig: StereoRig,
    parameters: RigParameters,
    poses: BoardPoses,
    information: BoardInformation,
    noise_px: float,
    known: Array | None = None,
) -> CalibrationCovariance:
    """What n boards leave whose corners have noise of `noise_px`, px per coordinate.

    `known` is the information (p, p), one over the units squared, that was there beforehand.

    Raises:
        Undetermined: the boards leave some of the parameters open.
    """
    left = rig_covariance(rig, parameters, information, noise_px, known)
    about = about_camera(poses)
    follows = (about @ information.gain).mean(axis=0)
    own = noise_px**2 * (about @ information.pose_covariance @ about.transpose(0, 2, 1)).sum(axis=0)
    across = follows @ left
    frame = across @ follows.T + own / len(poses) ** 2
    return CalibrationCovariance(rig, parameters, np.block([[left, across.T], [across, frame]]))


def about_camera(poses: BoardPoses) -> Array:
    """Boards' motions (w, dt) about their first corners as motions about the left camera, (n, 6, 6)."""
    about = np.zeros((len(poses), 6, 6))
    about[:, :3, :3] = about[:, 3:, 3:] = np.eye(3)
    # a turn w about t is a turn about the camera and a shift by t x w
    about[:, 3:, :3] = -minus_skew(poses.t)
    return about


class Undetermined(InvalidRange):
    """The boards leave parameters open; `names` are those, the most concerned first."""

    def __init__(self, names: tuple[str, ...]) -> None:
        super().__init__(f"the boards leave open: {', '.join(names)}")
        self.names = names


def rig_covariance(
    rig: StereoRig,
    parameters: RigParameters,
    information: BoardInformation,
    noise_px: float,
    known: Array | None = None,
) -> Array:
    """Covariance (p, p) of a rig's parameters; 0 where one is held. `known` is as of `covariance_of`.

    Raises:
        Undetermined: a combination of parameters is left open.
    """
    basis = parameters.basis(rig)
    if basis.shape[1] == 0:
        return np.zeros((len(parameters.names),) * 2)
    root = _root(information)
    if known is not None:
        root = np.concatenate([root, noise_px * _square_root(known)])
    root = root @ basis
    scale = np.sqrt((root * root).sum(axis=0))
    names = parameters.free_names(rig)
    if (scale == 0).any():
        raise Undetermined(tuple(name for name, size in zip(names, scale, strict=True) if size == 0))
    _, values, rows = np.linalg.svd(root / scale, full_matrices=False)
    if len(values) < len(names) or values[-1] <= _LEAST_VALUE * values[0]:
        share = np.abs(rows[-1])
        order = np.argsort(share)[::-1]
        raise Undetermined(tuple(names[k] for k in order if share[k] > 0.3 * share.max()))
    factor = basis @ (rows.T / values / scale[:, None])
    return np.asarray(noise_px**2 * factor @ factor.T)


def _root(information: BoardInformation) -> Array:
    """``r`` (k, p) with ``sum of reduced = r^T r``."""
    if information.root is not None:
        stacked = information.root.reshape(-1, information.root.shape[2])
        return np.asarray(np.linalg.qr(stacked, mode="r"))
    return _square_root(information.reduced.sum(axis=0))


def _square_root(matrix: Array) -> Array:
    """``r`` (p, p) with ``matrix = r^T r``."""
    values, vectors = np.linalg.eigh(matrix)
    return np.asarray(np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T)


def point_moves(rig: StereoRig, parameters: RigParameters, points_left: npt.ArrayLike) -> Array:
    """Move (N, 3, p) m of points that `optimal` triangulates per unit of each parameter of the assumed rig.

    To first order: the pixels stay, so the point moves by ``-(J^T J)^-1 J^T`` of what its pixels would.
    """
    points = given.points(points_left)
    return np.asarray(-pixel_gain(rig, points) @ pixel_slopes(rig, parameters, points))


def pixel_slopes(rig: StereoRig, parameters: RigParameters, points: Array) -> Array:
    """Move (N, 4, p) px of (u_left, v_left, u_right, v_right) of points (N, 3) m per unit of each
    parameter."""
    pixels = np.zeros((len(points), 4, len(parameters.names)))
    turned = points @ rig.right_from_left.R.T
    points_right = turned + rig.right_from_left.t
    pixels[:, :2, parameters.columns(0)] = parameters.camera_slopes(rig, 0, points)
    pixels[:, 2:, parameters.columns(1)] = parameters.camera_slopes(rig, 1, points_right)
    pixels[:, 2:, parameters.pose] = rig.right.jacobian(points_right) @ rigid_moves(turned)
    return pixels
