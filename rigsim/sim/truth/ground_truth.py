"""Ground truth: points on the surfaces that the left camera sees."""

from __future__ import annotations

import math

import numpy as np

from rigsim.errors import InvalidScene, NothingSeen
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.stereo import StereoRig
from rigsim.sim.scenes.scene import Scene
from rigsim.sim.truth import rays
from rigsim.sim.truth.points import Coverage, GroundTruth, away, balanced, spread_over

_OVERSAMPLING = 8
_MIN_CANDIDATES = 1 << 14
_COVERAGE_RAYS = 1 << 14


def sample_truth(
    scene: Scene,
    n_points: int,
    rng: np.random.Generator,
    range_m: tuple[float, float] | None = None,
    far_limit_m: float = math.inf,
) -> GroundTruth:
    """Points on what the left camera of the placed rig sees, balanced over depth.

    Rays through random sub-pixel positions of the left image hit the analytic surfaces; of the hits,
    as equal a number as there are is kept from each bin of `depth_edges_m`. Other rays, evenly spread,
    say how much of the image the depths cover.

    Args:
        scene: scene with a rig placed in it.
        n_points: how many points to keep; fewer where the scene has too few.
        rng: source of the pixel positions.
        range_m: nearest and farthest depth to keep, m.
        far_limit_m: farthest depth to keep, m; idle when all that is seen lies beyond it.

    Raises:
        NothingSeen: the left camera sees nothing (within the range).
    """
    rig = scene.rig
    if rig is None:
        raise InvalidScene(f"scene {scene.name}: no rig was placed in it")
    n_candidates = max(_OVERSAMPLING * n_points, _MIN_CANDIDATES)
    corner = np.array([-0.5, -0.5])
    uv = corner + rng.random((n_candidates, 2)) * (rig.left.width, rig.left.height)
    points_left, geom = rays.hits_at(scene, 0, uv)
    depth = away(rig.left, points_left)
    kept = np.isfinite(depth)
    if not kept.any():
        raise NothingSeen(f"scene {scene.name}: the left camera at {scene.mount} sees nothing")
    if range_m is None:
        range_m = (0.0, far_limit_m if np.nanmin(depth) <= far_limit_m else math.inf)
    seen = f"{np.nanmin(depth):.3g} to {np.nanmax(depth):.3g} m"
    kept &= (depth >= range_m[0]) & (depth <= range_m[1])
    if not kept.any():
        raise NothingSeen(
            f"scene {scene.name}: nothing between {range_m[0]:g} and {range_m[1]:g} m; "
            f"the left camera sees {seen}"
        )
    uv, points_left, geom = uv[kept], points_left[kept], geom[kept]
    chosen = balanced(depth[kept], n_points)
    uv, points_left, geom = uv[chosen], points_left[chosen], geom[chosen]
    in_right_image, visible_right = _seen_right(scene, rig, points_left)
    return GroundTruth(
        points_left=points_left,
        visible_left=rig.left.contains(uv)
        & rays.sees(scene, 0, scene.world_from_camera(0).apply(points_left)),
        visible_right=visible_right,
        in_right_image=in_right_image,
        geom_ids=geom,
        coverage=_coverage(scene, rig, range_m),
    )


def _coverage(scene: Scene, rig: StereoRig, range_m: tuple[float, float]) -> Coverage:
    uv = spread_over(rig.left.width, rig.left.height, _COVERAGE_RAYS)
    points_left, _ = rays.hits_at(scene, 0, uv)
    depth = away(rig.left, points_left)
    inside = (depth >= range_m[0]) & (depth <= range_m[1])
    in_right_image, visible_right = _seen_right(scene, rig, points_left[inside])
    return Coverage(
        n_rays=len(uv),
        beyond=int((depth > range_m[1]).sum()),
        depth_m=depth[inside],
        visible_right=visible_right,
        in_right_image=in_right_image,
    )


def _seen_right(scene: Scene, rig: StereoRig, points_left: Array) -> tuple[Mask, Mask]:
    """Whether the right image holds points (N, 3), and shows them."""
    _, uv_right = rig.project(points_left)
    held = rig.right.contains(uv_right)
    shown = held.copy()
    shown[held] = rays.sees(scene, 1, scene.world_from_camera(0).apply(points_left[held]))
    return held, shown


def points_at(scene: Scene, uv_left: Array) -> tuple[Array, Mask]:
    """What the left camera sees at pixels (N, 2), and whether the right camera sees it too.

    Returns:
        Points (N, 3) m in the left camera's frame, NaN where there is nothing; and (N,).
    """
    rig = scene.rig
    if rig is None:
        raise InvalidScene(f"scene {scene.name}: no rig was placed in it")
    points_left, _ = rays.hits_at(scene, 0, uv_left)
    return points_left, _seen_right(scene, rig, points_left)[1]
