"""How far a rig reaches: where a depth still stands out of its own noise."""

from __future__ import annotations

import math

import numpy as np

from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.theory.uncertainty import LEAST_DEPTH_SIGMAS, depth_in_sigmas

_SIDE = 9
_STEPS = 20
_CLOSE = 1e-9


def reach_m(rig: StereoRig, noise: PixelNoise) -> float:
    """Farthest depth, m, at which some ray of the left image still has ``Z / sigma_Z`` of 4.

    ``f B / (4 sigma_d)`` when rectified; infinite without noise, 0 where no ray has a depth. Rays are taken
    on a grid of the left image, and followed whether the right image holds them or not.
    """
    u, v = np.meshgrid(
        np.linspace(-0.5, rig.left.width - 0.5, _SIDE), np.linspace(-0.5, rig.left.height - 0.5, _SIDE)
    )
    rays = np.column_stack([rig.left.normalize(np.column_stack([u.ravel(), v.ravel()])), np.ones(u.size)])
    depth_m = np.full(len(rays), 100 * rig.baseline_m)
    for _ in range(_STEPS):
        # Z / sigma_Z falls as 1 / Z far away, so that one step is nearly exact
        with np.errstate(invalid="ignore"):
            found_m = depth_m * depth_in_sigmas(rig, rays * depth_m[:, None], noise) / LEAST_DEPTH_SIGMAS
        if np.isinf(found_m).any():
            return math.inf
        settled = np.nan_to_num(np.abs(found_m - depth_m)) <= _CLOSE * np.nan_to_num(found_m)
        depth_m = found_m
        if settled.all():
            break
    known = depth_m[np.isfinite(depth_m)]
    return float(known.max()) if len(known) else 0.0
