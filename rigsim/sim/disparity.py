"""True disparity of every pixel of the left image."""

from __future__ import annotations

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array
from rigsim.sim.frame import View
from rigsim.sim.scenes.scene import Scene
from rigsim.sim.truth import rays


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
    rays_left = np.column_stack([rig.left.normalize(uv_left), np.ones(len(uv_left))])
    points_left = rays_left * left.depth[seen][:, None]
    _, uv_right = rig.project(points_left)
    visible = rig.right.contains(uv_right)
    # the drawn depth is a few micrometres off: step back from the surface by as little
    nearer_left = points_left[visible] * (1 - 1e-5)
    visible[visible] = rays.sees(scene, 1, scene.world_from_camera(0).apply(nearer_left))
    disparity = np.full(left.depth.shape, np.nan)
    disparity[seen] = np.where(visible, uv_left[:, 0] - uv_right[:, 0], np.nan)
    return disparity
