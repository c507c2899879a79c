"""Gauss-Newton on the pixel residuals of any rig, lens distortion included."""

from __future__ import annotations

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.theory.blocks import blocks
from rigsim.theory.matrices import across, inverse_symmetric

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
        # unknowns: across the ray, and 1 / distance; the residuals are almost linear in them, even far away
        distance = np.linalg.norm(X, axis=1)[:, None]
        frame = np.concatenate([across(X / distance), -X[:, None]], axis=1).transpose(0, 2, 1)
        J = (rig.jacobian(X) @ frame) * distance[:, None]
        transposed = J.transpose(0, 2, 1)
        step = (inverse_symmetric(transposed @ J) @ (transposed @ residual[:, :, None]))[:, :, 0]
        aside = (frame[:, :, :2] @ step[:, :2, None])[:, :, 0]
        growth = 1 / (1 + distance * step[:, 2:])
        moved = (X + distance * aside) * growth
        moved[~((growth[:, 0] > 0) & rig.left.faces(moved))] = np.nan
        points[active] = moved
        # NaN compares false and so leaves the active set
        active = active[np.abs(moved - X).max(axis=1) > _STILL * np.abs(moved).max(axis=1)]
