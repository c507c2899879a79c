"""What a calibration, and what pixel noise, do to the depth at some distances."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.theory.calibration.covariance import CalibrationCovariance
from rigsim.theory.uncertainty import predict_depth_std

PLACES = ("axis", "edge", "corner")
"""The left optical axis; half way down the shared part of the picture at its outer end; its outer corner."""
_SAMPLES = 65
_INSET = 0.98


@dataclass(frozen=True, slots=True)
class DepthStd:
    """Standard deviations of the depth of one point."""

    z_m: float
    """Depth, m."""
    place: str
    """One of `PLACES`."""
    calibration_m: float
    """From the calibration alone, against the boards, m."""
    in_camera_m: float
    """The same as the left camera counts it: where its lens's centre lies counts as well."""
    observation_m: float
    """From the pixel noise of a match alone, m."""

    @property
    def joint_m(self) -> float:
        """Of both."""
        return float(np.hypot(self.calibration_m, self.observation_m))


def depth_stds(
    covariance: CalibrationCovariance,
    at_m: Sequence[float],
    noise: PixelNoise | float,
    places: Sequence[str] = PLACES,
) -> tuple[DepthStd, ...]:
    """One row a distance and place, near to far; a place that not both cameras see is left out."""
    rows: list[DepthStd] = []
    for place in places:
        points = np.array([point_at(covariance, z_m, place) for z_m in at_m])
        calibration = covariance.depth_std(points)
        in_camera = covariance.depth_std(points, from_camera=True)
        observation = predict_depth_std(covariance.rig, points, noise)
        rows += [
            DepthStd(z_m, place, *(float(each[k]) for each in (calibration, in_camera, observation)))
            for k, z_m in enumerate(at_m)
            if np.isfinite(points[k]).all()
        ]
    return tuple(sorted(rows, key=lambda row: (row.z_m, PLACES.index(row.place))))


def point_at(covariance: CalibrationCovariance, z_m: float, place: str) -> Array:
    """A point (3,) m of depth `z_m` at one of `PLACES`; NaN where not both cameras see one."""
    if place == "axis":
        return np.array([0.0, 0.0, z_m])
    left = covariance.rig.left
    # out from the middle of the picture, towards its left rim, as long as both cameras see it
    end_v = (left.height - 1) / 2 if place == "edge" else 0.0
    middle = np.array([(left.width - 1) / 2, (left.height - 1) / 2])
    ends = np.array([[0.0, end_v], [left.width - 1.0, end_v]])
    share = np.linspace(0, _INSET, _SAMPLES)[:, None]
    farthest, chosen = -1.0, np.full(3, np.nan)
    for end in ends:
        points = left.normalize(middle + share * (end - middle))
        points = np.column_stack([points * z_m, np.full(len(points), z_m)])
        uv_left, uv_right = covariance.rig.project(points)
        seen = np.flatnonzero(left.contains(uv_left) & covariance.rig.right.contains(uv_right))
        if seen.size and share[seen[-1], 0] > farthest:
            farthest, chosen = float(share[seen[-1], 0]), points[seen[-1]]
    return chosen
