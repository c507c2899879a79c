"""Points that both cameras see, with the ellipsoids of their predicted errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rigsim.rig.arrays import Array, Light
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.scene.plan import RigGrid
from rigsim.theory.ellipsoids import ellipsoids
from rigsim.theory.frusta import shared_view
from rigsim.theory.uncertainty import predict_covariance

_WALLS = 5
_ACROSS, _DOWN = 5, 3
_COLUMNS, _ROWS = 10, 8


@dataclass(frozen=True, slots=True, eq=False)
class Cloud:
    """Points with their predicted uncertainty."""

    points_left: Array
    """Points (N, 3) m of the left camera's frame, all seen by both cameras."""
    uv_left: Array
    """Where the left image shows them (N, 2), px."""
    uv_right: Array
    """Where the right one does."""
    std_mm: Array
    """Standard deviations of X, Y and Z (N, 3), mm."""
    half_axes_m: Array
    """Half axes (N, 3) m of their error ellipsoids, of one standard deviation."""
    turns: Array
    """Rotations (N, 3, 3): columns are the axes' directions in the left camera's frame."""


def cloud(rig: StereoRig, noise: PixelNoise, points_left: npt.ArrayLike) -> Cloud:
    """Those of some points (N, 3) m that both cameras see, with their errors."""
    points = np.asarray(points_left, dtype=np.float64).reshape(-1, 3)
    uv_left, uv_right = rig.project(points)
    seen = rig.left.contains(uv_left) & rig.right.contains(uv_right)
    points, uv_left, uv_right = points[seen], uv_left[seen], uv_right[seen]
    covariance = predict_covariance(rig, points, noise)
    half_axes, turns = ellipsoids(covariance)
    std_mm = 1e3 * np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    return Cloud(points, uv_left, uv_right, std_mm, half_axes, turns)


def walls(rig: StereoRig, near_m: float, far_m: float) -> Array:
    """Points (N, 3) m on walls from `near_m` to `far_m`, within what both cameras see of each."""
    found = []
    across, down = (np.linspace(0.06, 0.94, count) for count in (_ACROSS, _DOWN))
    for z in np.geomspace(near_m, far_m, _WALLS):
        shared = shared_view(rig, 1 / float(z))
        if not shared.share:
            continue
        low, high = shared.corners_uv.min(axis=0), shared.corners_uv.max(axis=0)
        u, v = np.meshgrid(low[0] + across * (high[0] - low[0]), low[1] + down * (high[1] - low[1]))
        xy = rig.left.normalize(np.column_stack([u.ravel(), v.ravel()]))
        found.append(np.column_stack([xy * z, np.full(len(xy), z)]))
    return np.concatenate(found) if found else np.empty((0, 3))


def points_of_depth(rig: StereoRig, depth_m: Light) -> Array:
    """Points (N, 3) m spread over a left picture whose depths (H, W) m are known, of whatever size it is."""
    height, width = depth_m.shape
    size = (width, height)
    drawn = rig
    if (rig.left.width, rig.left.height) != size:
        drawn = next(iter(RigGrid(base=rig, resolutions_px=(size,))))
    columns = np.linspace(0.05, 0.95, _COLUMNS) * (width - 1)
    rows = np.linspace(0.06, 0.94, _ROWS) * (height - 1)
    u, v = (grid.ravel().round().astype(int) for grid in np.meshgrid(columns, rows))
    depth = depth_m[v, u].astype(np.float64)
    points = np.column_stack([drawn.left.normalize(np.column_stack([u, v])) * depth[:, None], depth])
    return np.asarray(points[np.isfinite(points).all(axis=1)])
