"""Pixels of many rigs whose parameters are off together: `RigParameters.moved`, as arrays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.study.tolerance.batch import RigBatch, rotations
from rigsim.study.tolerance.joint.cause import JointDraw

_LINEAR = (BrownConrady, KannalaBrandt)
"""Models whose image coordinates are a sum over the coefficients: their slopes are exact."""


def project_joint(batch: RigBatch, off: JointDraw, points_left: Array) -> Array:
    """Pixels (4, n, m), as `RigBatch.project`, of rigs that are off by what `batch` has, and by `off`."""
    parameters, changes = off.parameters, off.changes
    pixels = np.empty((4, len(changes), len(points_left)))
    turn, shift = changes[:, parameters.pose][:, :3], changes[:, parameters.pose][:, 3:]
    R, t = rotations(turn) @ batch.R, batch.t + shift
    points_right = points_left @ R.transpose(0, 2, 1) + t[:, None]
    focal = ((batch.left_fx, batch.left_fy), (batch.fx, batch.fy))
    middle = ((batch.rig.left.cx, batch.rig.left.cy), (batch.cx, batch.cy))
    for side, points in ((0, points_left[None]), (1, points_right)):
        own = changes[:, parameters.columns(side)]
        lens = parameters.lens(batch.rig, side)
        image = _images(lens, own[:, 4:], batch.more_k1[side], points)
        for axis in (0, 1):
            size, place = focal[side][axis] + own[:, axis, None], middle[side][axis] + own[:, 2 + axis, None]
            pixels[2 * side + axis] = size * image[..., axis] + place
    return pixels


def _images(lens: Lens | None, changes: Array, more_k1: Array, points: Array) -> Array:
    """Image coordinates (n, m, 2) of points (1 or n, m, 3) m through lenses off by `changes` (n, c)."""
    with np.errstate(all="ignore"):
        ahead = np.where(points[..., 2:] > 0, points, np.nan)
        if lens is None and not more_k1.any():
            return np.asarray(ahead[..., :2] / ahead[..., 2:])
        model = BrownConrady() if lens is None else lens
        names = list(model.names())
        if lens is None:
            changes = np.zeros((len(more_k1), len(names)))
        if more_k1.any():
            changes = changes.copy()
            changes[:, names.index("k1")] += more_k1[:, 0]
        if isinstance(model, _LINEAR):
            return np.asarray(
                model.project(ahead) + np.einsum("nmkc,nc->nmk", *_paired(model.slopes(ahead), changes))
            )
        return np.stack(
            [
                _exact(model, names, change, points_seen)
                for change, points_seen in zip(changes, _each(ahead, len(changes)), strict=True)
            ]
        )


def _paired(slopes: Array, changes: Array) -> tuple[Array, Array]:
    return np.broadcast_to(slopes, (len(changes), *slopes.shape[1:])), changes


def _each(points: Array, count: int) -> Array:
    return np.broadcast_to(points, (count, *points.shape[1:]))


def _exact(lens: Lens, names: list[str], change: Array, points: Array) -> Array:
    """Image coordinates (m, 2) through the lens off by `change` (c,); NaN where there is no such lens."""
    off = {name: getattr(lens, name) + float(more) for name, more in zip(names, change, strict=True)}
    try:
        return replace(lens, **off).project(points)
    except InvalidRig:
        return np.full((len(points), 2), np.nan)
