"""A rig from the corners in pictures: OpenCV first, then least squares with its covariance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigsim.pixels.calibration.stereo import FoundRig, calibrate_stereo
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.pictures.sightings import Sightings
from rigsim.theory.calibration.adjust import Adjusted, adjust
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.covariance import CalibrationCovariance, covariance_of
from rigsim.theory.calibration.information import BoardInformation, board_information
from rigsim.theory.calibration.parameters import RigParameters


@dataclass(frozen=True, slots=True, eq=False)
class PicturesFit:
    """What explains the corners of n pairs best."""

    sightings: Sightings
    """The corners."""
    parameters: RigParameters
    """What was looked for."""
    adjusted: Adjusted
    """The rig, the boards' poses and the residuals."""
    noise_px: float
    """Standard deviation of one coordinate of a corner of weight 1 that the residuals show, px."""

    @property
    def information(self) -> BoardInformation:
        """What the boards tell, in the form that is found fast."""
        found = self.adjusted
        return board_information(
            *(found.rig, self.parameters, found.board, found.poses, self.sightings.found),
            rooted=False,
            weights=self.sightings.weights,
        )

    @property
    def covariance(self) -> CalibrationCovariance:
        """What is left, at that noise.

        Raises:
            Undetermined: the boards leave parameters open.
        """
        found = self.adjusted
        return covariance_of(found.rig, self.parameters, found.poses, found.information, self.noise_px)

    @property
    def rms_px(self) -> float:
        """Root mean square distance of a corner from where it should be, px, as OpenCV counts it."""
        return distance_rms(self.adjusted.residuals)

    @property
    def picture_rms_px(self) -> Array:
        """The same of each pair, (n,)."""
        return np.array([distance_rms(each) for each in self.adjusted.residuals])


def fit_rig(
    sightings: Sightings, parameters: RigParameters, fix: Sequence[str] = ()
) -> tuple[PicturesFit, FoundRig]:
    """Calibrate by OpenCV, then adjust all corners together, also of boards that one camera alone saw.

    Args:
        sightings: The corners, in one order.
        parameters: What is looked for.
        fix: The words that hold the rest; OpenCV holds both cameras for one.

    Raises:
        InvalidRange: OpenCV cannot hold this.
        MeasurementFailed: OpenCV finds no rig.
    """
    start = calibrate_stereo(
        *(sightings.board, sightings.observed, sightings.sizes, parameters.lenses), both_sides(fix)
    )
    return adjusted_from(sightings, parameters, start.rig, BoardPoses.of(start.left_from_board)), start


def adjusted_from(
    sightings: Sightings, parameters: RigParameters, rig: StereoRig, poses: BoardPoses
) -> PicturesFit:
    """Least squares from a start."""
    board, observed, weights = sightings.board, sightings.observed, sightings.weights
    found = adjust(rig, parameters, board, poses, observed, weights)
    free = parameters.basis(rig).shape[1] + 6 * len(sightings)
    return PicturesFit(sightings, parameters, found, noise_of(found.residuals, weights, free))


def both_sides(fix: Sequence[str]) -> tuple[str, ...]:
    """The words, of both cameras where one is named: what is held starts from the same."""
    return tuple(dict.fromkeys(word.rpartition(".")[2] for word in fix))


def distance_rms(residuals: Array) -> float:
    """Root mean square distance (px) of residuals (..., 2); NaN where there are none."""
    squares = np.sum(residuals**2, axis=-1)
    known = squares[np.isfinite(squares)]
    return float(np.sqrt(known.mean())) if known.size else float("nan")


def noise_of(residuals: Array, weights: Array, free: int) -> float:
    """Standard deviation of one coordinate of weight 1, px: the weighted residuals' (..., 2) root mean square
    with `free` numbers found from them taken off; NaN where no more are left."""
    weighted = residuals * weights[..., None]
    known = np.isfinite(weighted)
    spare = int(known.sum()) - free
    return float(np.sqrt(np.sum(weighted[known] ** 2) / spare)) if spare > 0 else float("nan")
