"""A board that is not as flat as its calibration takes it to be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.covariance import CalibrationCovariance, about_camera
from rigsim.theory.calibration.information import BoardInformation
from rigsim.theory.calibration.parameters import WARP, RigParameters


def with_warps(parameters: RigParameters) -> RigParameters:
    """The same parameters and the board's two warps, the last ones."""
    if parameters.warped:
        return parameters
    names, free = (*parameters.names, *WARP), np.append(parameters.free, [False, False])
    return replace(parameters, names=names, free=free, warped=True)


def without_warps(information: BoardInformation) -> BoardInformation:
    """What boards tell of everything but the warps, which are the last two parameters."""
    root = None if information.root is None else information.root[:, :, :-2]
    return BoardInformation(information.rig[:, :-2, :-2], information.cross[:, :-2], information.pose, root)


def warp_moves(covariance: CalibrationCovariance, poses: BoardPoses, warping: BoardInformation) -> Array:
    """How far the estimates, `FRAME` among them, go astray per metre of each warp, (p + 6, 2).

    Least squares that takes the board for flat, with weights that do not count. A warped board's own frame
    is the plane of its four outer corners.

    Args:
        covariance: Of noise of 1 px.
        poses: The boards.
        warping: What they tell with the two warps as the last parameters.
    """
    toward = warping.reduced[:, :-2, -2:].sum(axis=0)
    of_rig = covariance.of_rig @ toward
    gain = warping.gain
    of_poses = gain[:, :, :-2] @ of_rig - gain[:, :, -2:]
    return np.concatenate([of_rig, (about_camera(poses) @ of_poses).mean(axis=0)])
