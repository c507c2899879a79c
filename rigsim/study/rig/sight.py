"""How much of its picture a rig's left camera shares with the right one, whatever the two lenses."""

from __future__ import annotations

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from rigsim.theory.limits import overlap_at_depth

DEPTHS_M = (0.5, 1.0, 2.0, 5.0, 10.0)
"""Where a rig's overlap is told."""
_CELLS = (48, 36)
_NEAR_TO_FAR = (0.5, 1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0, 1e3, 1e6)
_LIKELY = (20.0, 100.0, 10.0, 5.0, 2.0, 1.0, 0.5, 1e3, 1e6)
"""The same, those at which most rigs meet first."""


def never_meet(rig: StereoRig) -> bool:
    """Whether no distance at all has a point that both cameras show."""
    return meeting_depth_m(rig, _LIKELY) is None


def meeting_depth_m(rig: StereoRig, baselines: tuple[float, ...] = _NEAR_TO_FAR) -> float | None:
    """The first of some distances, told in baselines, m, at which both cameras show a point; None where none
    does. Along the rays of a few pixels, where a lens distorts."""
    depths_m = (rig.baseline_m * times for times in baselines)
    if rig.left.lens is None and rig.right.lens is None:
        return next((depth_m for depth_m in depths_m if overlap_at_depth(rig, depth_m).fraction > 0), None)
    rays = rig.left.ray(grid(rig.left, *_CELLS))
    for depth_m in depths_m:
        in_right = rig.right_from_left.apply(rays * depth_m)
        if rig.right.contains(rig.right.project(in_right)).any():
            return depth_m
    return None


def overlap_shares(rig: StereoRig) -> tuple[float, ...]:
    """Share of the left picture's pixels whose point at each of `DEPTHS_M` the right one shows."""
    return tuple(float(share) for share in overlap_at_depth(rig, DEPTHS_M).fraction)


def grid(camera: Intrinsics, columns: int, rows: int) -> Array:
    """Middles (N, 2) px of equal cells that the picture is cut into."""
    u = (np.arange(columns) + 0.5) / columns * camera.width - 0.5
    v = (np.arange(rows) + 0.5) / rows * camera.height - 0.5
    return np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
