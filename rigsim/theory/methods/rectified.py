"""Closed-form triangulation of a rectified pair.

With rows in correspondence the maximum-likelihood point needs no iteration: disparity and u_left are
met exactly, and v is the mean of both images'.
"""

from __future__ import annotations

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.theory.blocks import blocks

_BLOCK = 49152  # inputs and output of a block: 2.7 MB


def triangulate_rectified(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """Points (N, 3) m in the left camera's frame of pixels (N, 2); `rig` must be rectified.

    ``Z = fx b / (u_left - u_right + doffs)``; NaN where the disparity is not positive. The columns of the
    result are contiguous: that is a quarter faster than rows.
    """
    sub, mul, add = np.subtract, np.multiply, np.add
    left, doffs, fx_b = rig.left, rig.doffs_px, rig.left.fx * rig.baseline_m
    points = np.empty((3, len(uv_left)))
    with np.errstate(all="ignore"):
        for block in blocks(len(uv_left), _BLOCK):
            (u_left, v_left), (u_right, v_right) = uv_left[block].T, uv_right[block].T
            x, y, z = out = points[:, block]
            sub(u_left, u_right, out=z)
            if doffs:
                add(z, doffs, out=z)
            np.divide(fx_b, z, out=z)
            sub(u_left, left.cx, out=x)
            mul(x, 1 / left.fx, out=x)
            mul(x, z, out=x)
            add(v_left, v_right, out=y)
            sub(y, 2 * left.cy, out=y)
            mul(y, 0.5 / left.fy, out=y)
            mul(y, z, out=y)
            # one look at the whole block: a NaN or an infinity anywhere makes it fail
            if not (z.min() > 0 and np.isfinite(y.sum())):
                out[:, ~((z > 0) & np.isfinite(out).all(axis=0))] = np.nan
    return points.T
