"""Ground-truth points, and how they are spread over depth: no renderer is needed here."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from rigsim.rig.arrays import Array, Ids, Mask
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.lens import ahead

Counts: TypeAlias = npt.NDArray[np.int64]
# Renard's R10: ten steps a decade, the numbers people use
_R10 = (1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.3, 8.0)


# Roberts' R2: the plane's counterpart of the golden ratio
_PLASTIC = np.array([0.7548776662466927, 0.5698402909980532])


@dataclass(frozen=True, slots=True, eq=False)
class Coverage:
    """What rays spread evenly over the left image meet; one row a ray that meets something in the range."""

    n_rays: int
    """Rays cast: those that meet nothing, or something out of the range, are among them."""
    beyond: int
    """Rays that meet the scene beyond the far limit."""
    depth_m: Array
    """Depth of what the ray meets, (M,), m."""
    visible_right: Mask
    """Whether the right camera sees it too, (M,)."""
    in_right_image: Mask
    """Whether it is within the right camera's field of view, hidden or not, (M,)."""


@dataclass(frozen=True, slots=True, eq=False)
class GroundTruth:
    """Points with exact coordinates; one row a point."""

    points_left: Array
    """In the left camera's frame, (N, 3), m."""
    visible_left: Mask
    """Within the left image and not hidden from the left camera, (N,)."""
    visible_right: Mask
    """Within the right image and not hidden from the right camera, (N,)."""
    in_right_image: Mask
    """Within the right camera's field of view, hidden or not, (N,)."""
    geom_ids: Ids
    """MuJoCo geom the point lies on, (N,)."""
    coverage: Coverage
    """Evenly spread over the left image, where the points are balanced over depth."""

    @property
    def visible(self) -> Mask:
        """Seen by both cameras, (N,)."""
        return self.visible_left & self.visible_right


def directions(camera: Intrinsics, uv: Array) -> Array:
    """Rays (N, 3) of pixels (N, 2) in the camera's frame: z is 1, or their length where a lens knows rays
    90 degrees and more off the axis; NaN where it shows nothing."""
    return camera.ray(uv) if camera.is_wide else ahead(camera.normalize(uv))


def at_depth(camera: Intrinsics, uv: Array, depth_m: Array) -> Array:
    """Points (N, 3) m in the camera's frame of pixels (N, 2) and their depths along the axis (N,)."""
    rays = directions(camera, uv)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(rays * (depth_m / rays[:, 2])[:, None])


def away(camera: Intrinsics, points: Array) -> Array:
    """How far points (N, 3) are from the camera, (N,), m: their depth; their range where a lens looks past 90
    degrees, and depth says little."""
    return np.asarray(np.linalg.norm(points, axis=1) if camera.is_wide else points[:, 2])


def depth_edges_m(near_m: float, far_m: float) -> Array:
    """Edges of the depth bins that hold [near, far], (n + 1,) m: steps of Renard's R10 series.

    They depend on the depths alone, so that rows of different runs can be compared.
    """
    first, last = math.floor(math.log10(near_m)), math.ceil(math.log10(far_m))
    series = np.array([round(step * 10.0**decade, 9) for decade in range(first, last + 1) for step in _R10])
    start = max(int(np.searchsorted(series, near_m, side="right")) - 1, 0)
    stop = max(int(np.searchsorted(series, far_m, side="left")), start + 1)
    return series[start : stop + 1]


def depth_bins(depth_m: Array, edges_m: Array) -> Ids:
    """Bin (N,) of each depth; what lies outside the edges counts to the first or the last bin."""
    return np.searchsorted(edges_m[1:-1], depth_m, side="right").astype(np.int32)


def image_weights(bins: Ids, bins_of_rays: Ids, n_bins: int) -> Array:
    """Weights (N,) with sum 1 that turn an average over points into one over the pixels of the image.

    Within a bin the points are spread over the image as the scene is; from bin to bin they are not.

    Args:
        bins: depth bin of each point, (N,).
        bins_of_rays: the same for rays spread evenly over the image.
        n_bins: number of bins.
    """
    points, rays = (np.bincount(each, minlength=n_bins) for each in (bins, bins_of_rays))
    # a bin that no ray meets covers less than one ray's share
    weights = np.maximum(rays, 0.5)[bins] / points[bins]
    return np.asarray(weights / weights.sum())


def spread_over(width: int, height: int, n: int) -> Array:
    """Pixel positions (n, 2) that cover an image evenly, always the same ones.

    Martin Roberts' R2 sequence: no rows or columns that could beat with those of the scene.
    """
    steps = 0.5 + np.arange(1, n + 1)[:, None] * _PLASTIC
    return np.asarray(steps % 1.0 * (width, height) - 0.5)


def balanced(depth_m: Array, n_points: int) -> Ids:
    """Indices of at most `n_points` depths, as evenly spread over the depth bins as they allow.

    Within a bin the first come are kept: random ones, when the depths come in random order.
    """
    if len(depth_m) <= n_points:
        return np.arange(len(depth_m), dtype=np.int32)
    edges = depth_edges_m(float(depth_m.min()), float(depth_m.max()))
    bins = np.searchsorted(edges[1:-1], depth_m, side="right")
    counts = np.bincount(bins, minlength=len(edges) - 1)
    quota = _fill_evenly(counts, n_points)
    order = np.argsort(bins, kind="stable")
    rank = np.empty(len(depth_m), dtype=np.int64)
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    rank[order] = np.arange(len(depth_m)) - np.repeat(starts, counts)
    return np.flatnonzero(rank < quota[bins]).astype(np.int32)


def _fill_evenly(counts: Counts, total: int) -> Counts:
    """How many to take from each bin so that the sum is `total` and the largest share is smallest."""
    quota = np.zeros_like(counts)
    open_bins = counts > 0
    left = total
    while left > 0 and open_bins.any():
        share = max(left // int(open_bins.sum()), 1)
        take = np.minimum(counts - quota, share) * open_bins
        if take.sum() > left:  # fewer left than bins: the first ones get one each
            take[np.cumsum(take) > left] = 0
        quota += take
        left -= int(take.sum())
        open_bins = quota < counts
    return quota
