"""Rows of built rigs: how far a point's right row is off its left one, in px.

What `rigsim.theory.rows` says of one rig, for the quantities that are off, and exactly for many rigs at once.
A rig keeps a bound when the root mean square over the image is within it at every distance. The square of it
is a quadratic in one over the distance, convex, so that it is largest at an end of the range.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.batch import PARAMETERS, Rays, RigBatch
from rigsim.study.tolerance.inputs import Causes
from rigsim.theory.rows import row_axes, row_gain, row_sensitivity

_OF_LEFT = ("left_focal_px", "left_cx_px", "left_cy_px")


def row_slopes(rig: StereoRig, points: Array, off: Causes) -> Array:
    """Row misalignment (m, p) px of points (m, 3) m per unit of each of `PARAMETERS` that is off."""
    return _slopes_of(row_sensitivity(rig, points), off)


def first_order_rows(rig: StereoRig, off: Causes, points: Array) -> Array:
    """Row misalignment (m, q) px of each independent number of what is off, by one standard deviation."""
    of_all = row_sensitivity(rig, points)
    found = _slopes_of(of_all, off) @ off.effect.T
    # `Causes` takes the left lens's errors for the right one's, as they are to a depth; to rows they are so
    # only where axes are parallel
    for place, key in enumerate(off.keys):
        if key in _OF_LEFT:
            found[:, place] = of_all[key]
    found = found * off.std
    if off.joint is None:
        return np.asarray(found)
    of_joint = np.einsum("mi,mir->mr", row_gain(rig, points), off.joint.pixel_moves(rig, points))
    return np.hstack([found, of_joint])


def _slopes_of(of_all: Mapping[str, Array], off: Causes) -> Array:
    slopes = np.stack([of_all[name] for name in PARAMETERS], axis=1)
    slopes[:, ~off.effect.any(axis=0)] = 0.0  # a lens without k1 has no effect of it, not even one of 0
    return slopes


def row_errors_px(batch: RigBatch, rays: Rays) -> Array:
    """Right row minus left row (n, m) px of `rays` in the pair that each rig of `batch` rectifies."""
    rig = batch.rig
    across, forward = row_axes(batch.R, batch.t)
    focal_px = (batch.left_fx + batch.left_fy + batch.fx + batch.fy) / 4
    if rig.is_rectified:
        focal_px = focal_px * rig.left.fy / ((rig.left.fx + rig.left.fy) / 2)
    turned = np.einsum("nij,nj->ni", batch.R, across), np.einsum("nij,nj->ni", batch.R, forward)
    return np.asarray(focal_px * (_over(*rays.right, *turned) - _over(*rays.left, across, forward)))


def _over(x: Array, y: Array, across: Array, forward: Array) -> Array:
    up, ahead = (axis[:, 0, None] * x + axis[:, 1, None] * y + axis[:, 2, None] for axis in (across, forward))
    with np.errstate(all="ignore"):
        return np.asarray(up / np.where(ahead > 0, ahead, np.nan))


def rms_px(rows: Array) -> Array:
    """Root mean square (n,) px over the image of rows (n, m); infinite where a point has none."""
    mean = np.einsum("nm,nm->n", rows, rows) / rows.shape[1]
    return np.sqrt(np.where(np.isnan(mean), np.inf, mean))


@dataclass(frozen=True, slots=True, eq=False)
class RowJudge:
    """Holds rigs to a row misalignment at points of several distances."""

    limit_px: float
    """The bound, px."""
    points: Array
    """Points (m, 3) m, distance by distance."""
    cuts: tuple[slice, ...]
    """Which of them are at one distance."""

    def keeps(self, rows: Array) -> Mask:
        """Which rigs (n,) with rows (n, m) px keep the bound at every distance."""
        worst = np.max([rms_px(rows[:, cut]) for cut in self.cuts], axis=0)
        return np.asarray(worst <= self.limit_px)


def make_row_judge(limit_px: float, planes: tuple[Array, ...]) -> RowJudge:
    """A judge at the points (m, 3) m of several distances."""
    ends = np.cumsum([0, *map(len, planes)])
    return RowJudge(
        limit_px,
        np.concatenate(planes),
        tuple(slice(int(start), int(stop)) for start, stop in pairwise(ends)),
    )
