"""Whether a pair's rows correspond as its rig says."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from rigsim.pixels.patches.refine import CHUNK, Fits
from rigsim.pixels.patches.spline import Indices, RowSpline
from rigsim.pixels.patches.windows import window_offsets
from rigsim.rig.arrays import Array

_REACH_PX = 3


def epipolar_offsets(left: Array, right: RowSpline, uv_left: Indices, fits: Fits, *, radius: int) -> Array:
    """How far below its row each fitted patch really lies in the right image, (N,), px.

    The best of seven rows by correlation, then one Gauss-Newton step along rows and columns. Near 0
    for a rectified pair; NaN where the fit failed, or the patch does not tell (texture that runs
    straight up and down, or an image border). The windows must lie one pixel inside the left image.
    """
    down = RowSpline.through(np.ascontiguousarray(left.T)).derivative().T
    along = RowSpline.through(left).derivative()
    parts = []
    for first in range(0, max(len(uv_left), 1), CHUNK):
        chosen = slice(first, first + CHUNK)
        few = Fits(*(getattr(fits, item.name)[chosen] for item in fields(Fits)))
        parts.append(_offsets(left, (down, along), right, uv_left[chosen], few, radius))
    return np.concatenate(parts)


def _offsets(
    left: Array, slopes: tuple[Array, Array], right: RowSpline, uv_left: Indices, fits: Fits, radius: int
) -> Array:
    height = left.shape[0]
    x, y = window_offsets(radius)
    rows, columns = uv_left[:, 1:] + y, uv_left[:, :1] + x
    template = left[rows, columns]
    template -= template.mean(axis=1, keepdims=True)
    down, along = (slope[rows, columns] for slope in slopes)

    # the fits' disparities belong to another pixel of the window than its middle
    offset = uv_left - fits.uv_left
    shift = -fits.disparity + fits.stretch * offset[:, 0] + fits.shear * offset[:, 1]
    u = (uv_left[:, 0] + shift)[:, None] + (1 + fits.stretch)[:, None] * x + fits.shear[:, None] * y
    best = np.full(len(uv_left), -np.inf)
    step = np.full(len(uv_left), np.nan)
    # a fit on the wrong row has bent its patch to suit: shift, stretch and shear are free once more
    ones = np.ones_like(template)
    J = np.stack([down, along, along * x / radius, along * y / radius, template, ones], axis=1)
    normal = J @ J.transpose(0, 2, 1)
    tells = normal[:, 0, 0] > 1e-3 * normal[:, 1, 1]
    normal += 1e-9 * (1 + np.trace(normal, axis1=1, axis2=2)[:, None, None]) * np.eye(6)
    for k in range(-_REACH_PX, _REACH_PX + 1):
        shifted = rows + k
        on_image = (shifted[:, 0] >= 0) & (shifted[:, -1] < height)
        values = right.sample(np.clip(shifted, 0, height - 1), u)
        values -= values.mean(axis=1, keepdims=True)
        with np.errstate(invalid="ignore", divide="ignore"):
            score = (values * template).sum(axis=1) / np.sqrt((values**2).sum(axis=1))
        theta = np.linalg.solve(normal, J @ (values - template)[..., None])[..., 0]
        better = on_image & (score > best)
        best = np.where(better, score, best)
        gain = np.maximum(1 + theta[:, 4], 0.25)
        step = np.where(better, k - theta[:, 0] / gain, step)
    reliable = tells & (np.abs(step) < _REACH_PX)
    return np.where(reliable, step, np.nan)
