"""How much of its picture a rig's left camera shares with the right one, whatever the two lenses."""

from __future__ import annotations

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.planar import PlanarLens
from rigsim.rig.stereo import StereoRig
from rigsim.theory.limits import overlap_at_depth

DEPTHS_M = (0.5, 1.0, 2.0, 5.0, 10.0)
"""Where a rig's overlap is told."""
_CELLS = (160, 120)
_FEW_CELLS = (48, 36)
_BASELINES = (20.0, 100.0, 10.0, 5.0, 2.0, 1.0, 0.5, 1e3, 1e6)


def overlap_shares(rig: StereoRig, depths_m: Array) -> Array:
    """Share (N,) of the left picture's pixels whose point at the left camera's Z (N,) m the right one shows.

    Exact cuts where both lenses are flat, as of `rigsim.theory.limits.overlap_at_depth`; rays through the
    middles of 160 x 120 cells where one may look past 90 degrees. There is no such point of a ray that does.
    """
    if _is_flat(rig.left) and _is_flat(rig.right):
        return np.asarray(overlap_at_depth(rig, depths_m).fraction)
    return _shares_by_rays(rig, depths_m, *_CELLS)


def never_meet(rig: StereoRig) -> bool:
    """Whether no distance at all, told in baselines, has a point that both cameras show."""
    for times in _BASELINES:
        depths_m = np.array([rig.baseline_m * times])
        if rig.left.lens is None and rig.right.lens is None:
            share = overlap_at_depth(rig, depths_m).fraction[0]
        else:
            share = _shares_by_rays(rig, depths_m, *_FEW_CELLS)[0]
        if share > 0:
            return False
    return True


def grid(camera: Intrinsics, columns: int, rows: int) -> Array:
    """Middles (N, 2) px of equal cells that the picture is cut into."""
    u = (np.arange(columns) + 0.5) / columns * camera.width - 0.5
    v = (np.arange(rows) + 0.5) / rows * camera.height - 0.5
    return np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)


def _is_flat(camera: Intrinsics) -> bool:
    return camera.lens is None or isinstance(camera.lens, PlanarLens)


def _shares_by_rays(rig: StereoRig, depths_m: Array, columns: int, rows: int) -> Array:
    """The same by rays through the middles of cells."""
    rays = rig.left.ray(grid(rig.left, columns, rows))
    with np.errstate(divide="ignore", invalid="ignore"):
        at_one = np.where(rays[:, 2:] > 0, rays / rays[:, 2:], np.nan)
    in_right = (rig.right_from_left.apply(at_one * depth_m) for depth_m in depths_m)
    return np.array([rig.right.contains(rig.right.project(points)).mean() for points in in_right])
