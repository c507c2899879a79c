"""One session of recalibration: what the compensator gets to look at."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array
from rigsim.rig.lens.distortion import are_brown
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.batch import PARAMETERS
from rigsim.study.tolerance.recalibration.compensator import Compensator
from rigsim.study.tolerance.sensitivities import Causes, Tolerances, scattered_points

MOST_FEATURES = 1000
"""More would take memory and tell nothing new: take more pictures instead."""
_ROW_SAMPLES = 201


@dataclass(frozen=True, slots=True)
class Recalibration:
    """What the compensator has to work with: by default a quick session with a tape measure.

    Lengths are known, three across the image, near to far, and one along the depth, as of a board that is
    held obliquely too: they tell the baseline and the focal length that both cameras share.

    Every picture adds: feature noise is taken as independent from picture to picture, and the lenses as
    having no errors but those of the tolerances. A real session has both, so this is its best case.
    """

    features: int = 60
    """Points of unknown place, over the image and the depth range."""
    pictures: int = 10
    """Pictures over which each of them is averaged."""
    noise_px: float = 0.25
    """Standard deviation of one pixel coordinate in one picture."""
    length_std_mm: float = 0.5
    """Standard deviation of each known length."""
    known: tuple[tuple[str, float], ...] = ()
    """Some of `PARAMETERS` that were calibrated before, and the standard deviations that this left."""

    def __post_init__(self) -> None:
        for name, value, least in (
            ("features", self.features, 8),
            ("pictures", self.pictures, 1),
            ("noise", self.noise_px, 0),
        ):
            if not (math.isfinite(value) and value >= least):
                raise InvalidRange(f"recalibration {name} {value:g}: must be >= {least}")
        if self.features > MOST_FEATURES:
            raise InvalidRange(f"recalibration features {self.features}: must be <= {MOST_FEATURES}")
        if not (math.isfinite(self.length_std_mm) and self.length_std_mm > 0):
            raise InvalidRange(f"known length's std {self.length_std_mm:g} mm: must be > 0")

    @property
    def averaged_px(self) -> float:
        """Standard deviation of one pixel coordinate of a feature over all pictures."""
        return self.noise_px / math.sqrt(self.pictures)


@dataclass(frozen=True, slots=True, eq=False)
class Build:
    """What is built, and how it is used."""

    rig: StereoRig
    """The assumed rig."""
    tolerances: Tolerances
    """What a built one may be off by."""
    noise_px: float = 0.0
    """Standard deviation of one pixel coordinate when rigs measure, px."""
    recalibration: Recalibration | None = None
    """What each rig is recalibrated on; None leaves it out."""


def make_compensator(
    rig: StereoRig,
    off: Causes,
    recalibration: Recalibration,
    range_m: tuple[float, float],
    *,
    informed: bool = False,
) -> Compensator:
    """The calibration of one rig: features over the range, and known lengths.

    It knows nothing beforehand, as `wide_std` says, or, when `informed`, the tolerances that rigs are built
    to: those who recalibrate seldom do, and a simulation that knows what it drew from flatters itself.
    """
    near_m, far_m = range_m
    before = ~off.after_calibration
    std = np.sqrt(((off.effect * off.std[:, None])[before] ** 2).sum(axis=0))
    if not informed:
        std = np.where(std > 0, np.maximum(wide_std(rig), std), 0.0)
    for name, left in recalibration.known:
        std[PARAMETERS.index(name)] = left
    rows = [_shared_row(rig, near_m + share * (far_m - near_m)) for share in (0.25, 0.5, 0.75)]
    marks = [row[place * len(row) // 4] for row in rows for place in (1, 3)]
    marks += [rows[place][len(rows[place]) // 2] for place in (0, 2)]
    return Compensator(
        rig,
        scattered_points(rig, near_m, far_m, recalibration.features),
        np.array(marks),
        std,
        recalibration.averaged_px,
        recalibration.length_std_mm / 1e3,
    )


def _shared_row(rig: StereoRig, depth_m: float) -> Array:
    """Points (n, 3) m at one depth in the middle row of the left image, as far as the right camera sees them.

    Raises:
        InvalidRange: there are fewer than 4.
    """
    row = np.column_stack(
        [np.linspace(0, rig.left.width - 1, _ROW_SAMPLES), np.full(_ROW_SAMPLES, (rig.left.height - 1) / 2)]
    )
    points = np.column_stack([rig.left.normalize(row) * depth_m, np.full(_ROW_SAMPLES, depth_m)])
    points = points[rig.right.contains(rig.project(points)[1])]
    if len(points) < 4:
        raise InvalidRange(
            f"depth {depth_m * 1e3:g} mm: too little is in both images to lay a known length there;"
            " take a larger distance or leave the recalibration out"
        )
    return points


def wide_std(rig: StereoRig) -> Array:
    """What is known of any pair of cameras beforehand, as standard deviations (12,) of `PARAMETERS`.

    By eye: 10 deg of any angle, half the baseline of any shift, 30 % of focal lengths, a tenth of the image
    for principal points, 0.5 for k1 of lenses that have one. Hundreds of times what a calibration leaves.
    """
    k1 = 0.5 if are_brown(rig.left.lens, rig.right.lens) else 0.0
    angle, shift, width = math.radians(10), rig.baseline_m / 2, rig.right.width / 10
    wide = {
        "yaw_rad": angle,
        "pitch_rad": angle,
        "roll_rad": angle,
        "baseline_m": shift,
        "axial_m": shift,
        "vertical_m": shift,
        "right_focal_px": 0.3 * rig.right.fx,
        "both_focal_px": 0.3 * rig.left.fx,
        "right_cx_px": width,
        "right_cy_px": width,
        "right_k1": k1,
        "both_k1": k1,
    }
    return np.array([wide[name] for name in PARAMETERS])
