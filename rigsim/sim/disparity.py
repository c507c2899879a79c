"""True disparity of every pixel of the left image, and what both cameras see."""

from __future__ import annotations

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.sim.frame import View
from rigsim.sim.lens import ray_grid
from rigsim.sim.scenes.scene import Scene
from rigsim.sim.truth import rays
from rigsim.sim.truth.points import at_depth

_HIDDEN = 1e-3  # of its depth, by which what hides a point is nearer


def true_disparity(scene: Scene, left: View) -> Array:
    """``u_left - u_right`` at the left image's pixel centres, (H, W), px.

    NaN where nothing is seen, and where the right camera does not see the point: out of its image,
    or hidden by something nearer.
    """
    rig = scene.rig
    if rig is None:
        raise InvalidRig("no rig was placed in the scene")
    seen = np.isfinite(left.depth)
    v, u = np.nonzero(seen)
    uv_left = np.column_stack([u, v]).astype(np.float64)
    points_left = at_depth(rig.left, uv_left, left.depth[seen])
    _, uv_right = rig.project(points_left)
    visible = rig.right.contains(uv_right)
    # the drawn depth is a few micrometres off: step back from the surface by as little
    nearer_left = points_left[visible] * (1 - 1e-5)
    visible[visible] = rays.sees(scene, 1, scene.world_from_camera(0).apply(nearer_left))
    disparity = np.full(left.depth.shape, np.nan)
    disparity[seen] = np.where(visible, uv_left[:, 0] - uv_right[:, 0], np.nan)
    return disparity


def drawn_points(rig: StereoRig, depth_left: Array) -> Array:
    """What each left pixel shows, (H, W, 3) m in the left camera's frame; NaN for nothing."""
    rays = ray_grid(rig.left)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(rays * (depth_left / rays[..., 2])[..., None])


def drawn_disparity(rig: StereoRig, points_left: Array, depth_right: Array) -> Array:
    """As `true_disparity`, (H, W) px, by the right camera's drawn depth (H, W) instead of by rays.

    A point is hidden where all four right pixels about it show something nearer: along the edge of what hides
    it, that is up to a pixel less than is hidden.

    Args:
        rig: the rig whose depths were drawn.
        points_left: what each left pixel shows, (H, W, 3), as `drawn_points` gives it.
        depth_right: of the right camera, (H, W), m; NaN for nothing.
    """
    right, shape = rig.right, points_left.shape[:-1]
    points_right = rig.right_from_left.apply(points_left.reshape(-1, 3))
    uv = right.project(points_right)
    at = np.flatnonzero(right.contains(uv))
    first = np.floor(uv[at]).astype(np.int32)
    far = np.where(np.isnan(depth_right), np.inf, depth_right).ravel()
    columns = [np.clip(first[:, 0] + step, 0, right.width - 1) for step in (0, 1)]
    rows = [np.clip(first[:, 1] + step, 0, right.height - 1) * right.width for step in (0, 1)]
    farthest = np.zeros(len(at))
    for row in rows:
        for column in columns:
            np.maximum(farthest, far[row + column], out=farthest)
    at = at[points_right[at, 2] * (1 - _HIDDEN) <= farthest]
    disparity = np.full(points_left.size // 3, np.nan)
    disparity[at] = at % shape[1] - uv[at, 0]
    return disparity.reshape(shape)
