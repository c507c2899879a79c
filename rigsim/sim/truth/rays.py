"""Rays cast into the scene: exact depth and visibility, and a plain picture without any GL."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from rigsim.rig.arrays import Array, Ids, Light, Mask
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.sim.scenes.scene import Scene
from rigsim.sim.supersampling import box_average
from rigsim.sim.truth.points import directions

_BLOCK = 1 << 18
_SURFACE = 1 - 1e-6
_SKY = np.array([0.67, 0.76, 0.88])
_AMBIENT = 0.35


def cast(scene: Scene, origin_world: Array, directions_world: Array) -> tuple[Array, Ids, Array]:
    """Nearest hit of each ray.

    Args:
        scene: the scene.
        origin_world: common start, (3,), m.
        directions_world: (N, 3), any length; NaN is a miss.

    Returns:
        Distance in units of the direction's length (N,), NaN for a miss; geom id (N,), -1 for a
        miss; outward normal (N, 3), world.
    """
    n = len(directions_world)
    blind: Mask = np.asarray(np.isnan(directions_world).any(axis=1))
    if blind.any():  # what MuJoCo makes of NaN is its own affair
        directions_world = np.where(blind[:, None], 1.0, directions_world)
    distance, normal = np.empty(n), np.empty((n, 3))
    geom = np.empty(n, dtype=np.int32)
    groups = scene.geom_groups
    origin = np.ascontiguousarray(origin_world, dtype=np.float64)
    for start in range(0, n, _BLOCK):
        part = slice(start, min(start + _BLOCK, n))
        count = part.stop - part.start
        block_normal = np.empty(3 * count)
        mujoco.mj_multiRay(
            scene.model,
            scene.data,
            origin,
            np.ascontiguousarray(directions_world[part], dtype=np.float64).ravel(),
            groups,
            True,
            -1,
            geom[part],
            distance[part],
            block_normal,
            count,
            mujoco.mjMAXVAL,
        )
        normal[part] = block_normal.reshape(-1, 3)
    geom[blind] = -1
    distance[geom < 0] = np.nan
    return distance, geom, normal


def depth_at(scene: Scene, side: int, uv: Array, lens: Intrinsics | None = None) -> tuple[Array, Ids]:
    """Depth (N,) m and geom id (N,) at pixel positions (N, 2) of the left (0) or right (1) camera; through
    `lens` where it is not the placed rig's own."""
    points, geom = hits_at(scene, side, uv, lens)
    return points[:, 2], geom


def hits_at(scene: Scene, side: int, uv: Array, lens: Intrinsics | None = None) -> tuple[Array, Ids]:
    """Points (N, 3) m in the camera's frame, NaN for nothing, and geom ids (N,); as `depth_at`."""
    world_from_camera = scene.world_from_camera(side)
    rays_camera = directions(lens or scene.lens(side), uv)
    distance, geom, _ = cast(scene, world_from_camera.t, rays_camera @ world_from_camera.R.T)
    return rays_camera * distance[:, None], geom


def sees(scene: Scene, side: int, points_world: Array) -> Mask:
    """Whether nothing stands between the camera and each point (N, 3); field of view not considered."""
    origin = scene.world_from_camera(side).t
    distance, _, _ = cast(scene, origin, points_world - origin)
    return ~(distance < _SURFACE)


class RayRenderer:
    """Pictures by rays: exact depth and segmentation, plain shading, no GL."""

    name = "rays"
    backs = True
    bends = True

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._colors = _geom_colors(scene.model)

    def light(
        self, side: int, lens: Intrinsics, supersample: int, camera_from_face: Array | None = None
    ) -> Light:
        """Linear light (H, W, 3) that falls on the left (0) or right (1) camera through `lens`; black where a
        lens shows nothing."""
        fine = lens.supersampled(supersample)
        world_from_camera = self._scene.world_from_camera(side)
        if camera_from_face is not None:
            world_from_camera = Pose(world_from_camera.R @ camera_from_face, world_from_camera.t)
        light = np.zeros((lens.height, lens.width, 3), dtype=np.float32)
        rows = max(1, _BLOCK // fine.width // supersample) * supersample
        for top in range(0, fine.height, rows):
            band = slice(top, min(top + rows, fine.height))
            rays_camera = _pixel_rays(fine, band)
            _, geom, normal = cast(self._scene, world_from_camera.t, rays_camera @ world_from_camera.R.T)
            color = self._shade(rays_camera, geom, normal, world_from_camera)
            light[top // supersample : band.stop // supersample] = box_average(
                color.reshape(-1, fine.width, 3), supersample
            )
        return light

    def depth_and_segmentation(self, side: int, lens: Intrinsics | None = None) -> tuple[Array, Ids]:
        """Depth (H, W) m and geom id (H, W) at the pixel centres of the placed rig's camera, or of `lens`."""
        return depth_picture(self._scene, side, lens)

    def close(self) -> None:
        """Nothing to give back."""

    def _shade(self, rays_camera: Array, geom: Ids, normal_world: Array, world_from_camera: Pose) -> Array:
        """A lamp at the camera: brightness falls with the angle of incidence."""
        normal_camera = normal_world @ world_from_camera.R
        length = np.linalg.norm(rays_camera, axis=1)
        facing = np.abs(np.einsum("ij,ij->i", normal_camera, rays_camera)) / length
        color = self._colors[geom] * (_AMBIENT + (1 - _AMBIENT) * facing)[:, None]
        color[geom < 0] = _SKY
        color[np.isnan(rays_camera[:, 2])] = 0.0
        return np.asarray(np.clip(color, 0.0, 1.0))


def depth_picture(scene: Scene, side: int, lens: Intrinsics | None = None) -> tuple[Array, Ids]:
    """Depth (H, W) m, NaN for nothing, and geom id (H, W) at the pixel centres, by rays; through `lens` where
    it is not the placed rig's own."""
    lens, world_from_camera = lens or scene.lens(side), scene.world_from_camera(side)
    rays_camera = _pixel_rays(lens, slice(0, lens.height))
    distance, geom, _ = cast(scene, world_from_camera.t, rays_camera @ world_from_camera.R.T)
    shape = (lens.height, lens.width)
    return (distance * rays_camera[:, 2]).reshape(shape), geom.reshape(shape)


def _pixel_rays(lens: Intrinsics, rows: slice) -> Array:
    v, u = np.mgrid[rows, : lens.width]
    uv = np.column_stack([u.ravel(), v.ravel()]).astype(np.float64)
    return directions(lens, uv)


def _geom_colors(model: Any) -> Array:
    """Mean colour of each geom, (ngeom, 3), 0 to 1: material and texture averaged."""
    rgb = np.array(model.geom_rgba[:, :3], dtype=np.float64)
    for i, material in enumerate(model.geom_matid):
        if material < 0:
            continue
        rgb[i] = model.mat_rgba[material, :3]
        texture = int(model.mat_texid[material].max())
        if texture >= 0:
            channels = int(model.tex_nchannel[texture])
            start = int(model.tex_adr[texture])
            size = int(model.tex_height[texture]) * int(model.tex_width[texture]) * channels
            texels = model.tex_data[start : start + size].reshape(-1, channels)
            mean = texels[:, : min(channels, 3)].mean(axis=0) / 255
            rgb[i] *= mean if channels >= 3 else mean[0]
    return rgb
