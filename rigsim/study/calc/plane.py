"""Points at one distance, over the part of the image that both cameras see, and how far rows are apart."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig

_GRID = (65, 49)


@dataclass(frozen=True, slots=True)
class RowsApart:
    """How far below its row in the left image a point's row in the right one lies, px, as they are seen."""

    on_axis_px: float
    """On the left optical axis; NaN where a camera does not show it."""
    least_px: float
    """Over the part of the image that both see, the least; NaN where there is none, or no image size."""
    most_px: float
    """The greatest."""


def shared_plane(rig: StereoRig, depth_m: float, counts: tuple[int, int] = _GRID) -> Array:
    """Points (N, 3) m at a depth, even over the left image to its very edges, that both cameras see."""
    lens = rig.left
    u, v = (
        np.linspace(-0.5, side - 0.5, count)
        for side, count in zip((lens.width, lens.height), counts, strict=True)
    )
    uv = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    points = np.column_stack([lens.normalize(uv) * depth_m, np.full(len(uv), depth_m)])
    points = points[np.isfinite(points).all(axis=1)]
    return np.asarray(points[rig.right.contains(rig.project(points)[1])])


@lru_cache(maxsize=16)
def rows_apart(rig: StereoRig, depth_m: float, *, sized: bool) -> RowsApart:
    """How far rows are apart at a distance, by exact projection; images have an edge where `sized`."""
    (on_axis,) = _rows(rig, np.array([[0.0, 0.0, depth_m]]))
    rows = _rows(rig, _shared_rows(rig, depth_m)) if sized else np.empty(0)
    rows = rows[np.isfinite(rows)]
    least, most = (float(rows.min()), float(rows.max())) if rows.size else (math.nan, math.nan)
    return RowsApart(float(on_axis), least, most)


def _shared_rows(rig: StereoRig, depth_m: float) -> Array:
    """Points of the plane that say how far rows are apart: one row of it where all rows are alike."""
    alike = rig.is_rectified and rig.left.height == rig.right.height
    return shared_plane(rig, depth_m, (_GRID[0], 1) if alike else _GRID)


def _rows(rig: StereoRig, points: Array) -> Array:
    left, right = rig.project(points)
    apart = right[:, 1] - left[:, 1]
    return np.where(np.abs(apart) > 1e-9, apart, 0 * apart)  # less is rounding
