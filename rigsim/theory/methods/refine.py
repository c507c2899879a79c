"""Gauss-Newton on the pixel residuals of any rig, lens distortion included."""

from __future__ import annotations

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.theory.blocks import blocks
from rigsim.theory.matrices import inverse_symmetric

_BLOCK = 4096
_STEPS = 20
_STILL = 1e-13


def refine(rig: StereoRig, points_left: Array, uv_left: Array, uv_right: Array) -> Array:
    """Points (N, 3) m that minimise the squared pixel residuals, from nearby `points_left`.

    NaN where the best point lies behind a camera or at infinity.
    """
    refined = np.array(points_left)
    observed = np.concatenate([uv_left, uv_right], axis=1)
    with np.errstate(all="ignore"):
        for block in blocks(len(refined), _BLOCK):
            _refine_block(rig, refined[block], observed[block])
    return refined


def _refine_block(rig: StereoRig, points: Array, observed: Array) -> None:
    active = np.flatnonzero(np.isfinite(points).all(axis=1))
    for _ in range(_STEPS):
        if not active.size:
            return
        X = points[active]
        residual = observed[active] - np.concatenate(rig.project(X), axis=1)
        # unknowns (x/z, y/z, 1/z): the residuals are almost linear in them, even far away
        z = X[:, 2:]
        J = rig.jacobian(X)
        J[:, :, 2] = -(J @ X[:, :, None])[:, :, 0]
        J *= z[:, None, :]
        transposed = J.transpose(0, 2, 1)
        step = inverse_symmetric(transposed @ J) @ (transposed @ residual[:, :, None])
        dx, dy, dq = step[:, :, 0].T
        z_new = z[:, 0] / (1 + z[:, 0] * dq)
        moved = np.column_stack([(X[:, 0] / z[:, 0] + dx) * z_new, (X[:, 1] / z[:, 0] + dy) * z_new, z_new])
        moved[~(z_new > 0)] = np.nan
        points[active] = moved
        # NaN compares false and so leaves the active set
        active = active[np.abs(moved - X).max(axis=1) > _STILL * np.abs(moved).max(axis=1)]
