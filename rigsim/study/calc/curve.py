"""Depth error and overlap over distances, as curves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.theory.frusta import shared_shares
from rigsim.theory.uncertainty import depth_bounds, predict_depth_std

POINTS = 81
"""Distances of the depth error's curve."""
OVERLAP_POINTS = 33
"""Distances of the overlap's curve, which is slower."""
_OF_LENSES = 9  # a plane seen through a lens that distorts is cut into thousands of pieces


@dataclass(frozen=True, slots=True, eq=False)
class DepthCurve:
    """The depth error on the left optical axis over distances; NaN where not both cameras see it."""

    z_m: Array
    """Distances (N,), m."""
    std_mm: Array
    """Standard deviation of the depth (N,), mm."""
    too_near_mm: Array
    """How much nearer it is found when the disparity is off by one standard deviation (N,), mm."""
    too_far_mm: Array
    """How much farther, (N,) mm; infinite without bound."""


@dataclass(frozen=True, slots=True, eq=False)
class OverlapCurve:
    """What both cameras see over distances."""

    z_m: Array
    """Distances (N,), m."""
    share: Array
    """Share of the left image that the right one shows too (N,), 0 to 1."""


def depth_curve(
    rig: StereoRig, noise: PixelNoise, near_m: float, far_m: float, *, bounds: bool = True
) -> DepthCurve:
    """The depth error from `near_m` to `far_m`; `bounds` take longer unless the rig is rectified."""
    z = np.geomspace(near_m, far_m, POINTS)
    points = np.zeros((POINTS, 3))
    points[:, 2] = z
    left, right = rig.project(points)
    seen = rig.left.contains(left) & rig.right.contains(right)
    near = far = np.full(POINTS, np.nan)
    if bounds:
        near, far = depth_bounds(rig, points, noise.disparity_std_px)
    std = predict_depth_std(rig, points, noise)
    return DepthCurve(z, *(np.where(seen, 1e3 * item, np.nan) for item in (std, z - near, far - z)))


def overlap_curve(rig: StereoRig, near_m: float, far_m: float) -> OverlapCurve:
    """The share of the left image that both see, from `near_m` to `far_m`."""
    exact = rig.left.lens is None and rig.right.lens is None
    z = np.geomspace(near_m, far_m, OVERLAP_POINTS if exact else _OF_LENSES)
    return OverlapCurve(z, shared_shares(rig, 1 / z))
