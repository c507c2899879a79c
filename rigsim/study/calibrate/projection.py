"""How sure a calibration leaves where each camera shows a point, over its picture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.theory.calibration.covariance import CalibrationCovariance

FAR_M = 1e6
"""As good as infinitely far away, m."""
_ACROSS = 41


@dataclass(frozen=True, slots=True, eq=False)
class ProjectionMap:
    """The std of a point's projection over one picture."""

    u_px: Array
    """Columns (n,), px."""
    v_px: Array
    """Rows (m,), px."""
    std_px: Array
    """Standard deviation in the worst direction (m, n), px; NaN where the lens shows nothing."""


def projection_map(covariance: CalibrationCovariance, side: int, distance_m: float) -> ProjectionMap:
    """Over the left (0) or right (1) picture, of points `distance_m` from that camera that stand fixed among
    the boards."""
    camera = (covariance.rig.left, covariance.rig.right)[side]
    u, v = np.linspace(0, camera.width - 1, _ACROSS), np.linspace(0, camera.height - 1, _ACROSS)
    rays = camera.ray(np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2))
    values = np.full(len(rays), np.nan)
    known = np.isfinite(rays).all(axis=1)
    values[known] = covariance.projection_std(side, rays[known] * distance_m)
    return ProjectionMap(u, v, values.reshape(_ACROSS, _ACROSS))
