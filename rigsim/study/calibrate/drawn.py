"""Trials that are each triangulated with another calibration of the rig: what they are predicted to err."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.agreement.views import turned, view_jacobian
from rigsim.theory.calibration.covariance import CalibrationCovariance


def calibrations(
    covariance: CalibrationCovariance, rig: StereoRig, count: int, rng: np.random.Generator
) -> tuple[StereoRig, ...]:
    """As many calibrations of `rig`: each off by a draw of the covariance.

    Raises:
        InvalidRange: some draw is no rig.
    """
    changes = covariance.draws(count, rng)[:, :-6]
    try:
        return tuple(covariance.parameters.moved(rig, change) for change in changes)
    except InvalidRig as error:
        raise InvalidRange(f"a calibration drawn from the covariance is no rig: {error}") from None


def calibrated_views(
    covariance: CalibrationCovariance, rig: StereoRig, points_left: Array, axes: Array | None
) -> tuple[Array, Array]:
    """What a calibration of `rig` adds, counted from the left camera, for points (N, 3) m.

    Returns:
        Covariance (N, 3, 3) of the error of ``(1/Z, X/Z, Y/Z)`` in `axes` (`rigsim.study.agreement.views`),
        and that of the point's own, m^2.
    """
    own = replace(covariance, rig=rig).point_covariance(points_left, from_camera=True)
    J = view_jacobian(points_left) if axes is None else view_jacobian(turned(points_left, axes)) @ axes
    return np.asarray(J @ own @ J.transpose(0, 2, 1)), own
