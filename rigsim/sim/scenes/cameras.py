"""The cameras that an MJCF scene has of its own, as MuJoCo compiles them, with OpenCV's axes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from rigsim.errors import InvalidRig
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.sim.axes import CV_FROM_GL
from rigsim.sim.scenes import gate


@dataclass(frozen=True, slots=True)
class SceneCamera:
    """A camera of a scene, at the scene's first keyframe or its reference pose."""

    name: str
    """Its name; empty where it has none."""
    world_from_camera: Pose
    """Its place, OpenCV axes, m."""
    body: int
    """Cameras with the same number do not move against each other."""
    size_px: tuple[int, int] | None
    """Its ``resolution``, px; None where it has none."""
    perspective: bool
    """Whether it is no orthographic one."""
    fovy_rad: float | None
    """Vertical field of view, rad; None where focal lengths are given."""
    focal: tuple[float, float]
    """Focal lengths, in widths and heights of the picture."""
    offset: tuple[float, float]
    """From the principal point to the picture's middle, in its widths and heights."""

    def intrinsics(self, width: int, height: int) -> Intrinsics:
        """The pinhole that it is in a picture of this size; the middle is ``(width - 1) / 2``.

        Raises:
            InvalidRig: it is orthographic, or has no field of view.
        """
        if not self.perspective:
            raise InvalidRig(f"camera {self.name} is orthographic: must be a perspective one")
        if self.fovy_rad is not None:
            if not 0 < self.fovy_rad < math.pi:
                raise InvalidRig(f"fovy of camera {self.name}: must be > 0 and < 180 deg")
            fx = fy = height / 2 / math.tan(self.fovy_rad / 2)
        else:
            fx, fy = self.focal[0] * width, self.focal[1] * height
        cx, cy = (width - 1) / 2 - self.offset[0] * width, (height - 1) / 2 - self.offset[1] * height
        return Intrinsics(width, height, fx, fy, cx, cy)


@dataclass(frozen=True, slots=True)
class SceneCameras:
    """What a scene says of cameras."""

    cameras: tuple[SceneCamera, ...]
    """Its cameras, in the file's order."""
    offscreen_px: tuple[int, int]
    """``offwidth`` and ``offheight`` of its ``visual/global``: 640 and 480 unless it says otherwise."""


def read_scene_cameras(path: Path) -> SceneCameras:
    """The cameras in the MJCF file at `path`, its includes and defaults taken in.

    Raises:
        InvalidScene: the file is broken, or asks for too much.
    """
    gate.check(path)
    with gate.passing(path):
        model = mujoco.MjSpec.from_file(str(path)).compile()
        data = mujoco.MjData(model)
        if model.nkey:
            mujoco.mj_resetDataKeyframe(model, data, 0)
        mujoco.mj_fwdPosition(model, data)
    gate.check_numbers(model, data, path)
    size = model.vis.global_
    return SceneCameras(scene_cameras(model, data), (int(size.offwidth), int(size.offheight)))


def scene_cameras(model: Any, data: Any) -> tuple[SceneCamera, ...]:
    """The cameras of a compiled model whose places `data` holds."""
    return tuple(_camera(model, data, i) for i in range(model.ncam))


def _camera(model: Any, data: Any, i: int) -> SceneCamera:
    sensor = np.asarray(model.cam_sensorsize[i], dtype=np.float64)
    resolution = (int(model.cam_resolution[i][0]), int(model.cam_resolution[i][1]))
    by_sensor = bool((sensor > 0).all())
    fx, fy, x, y = (float(value) for value in model.cam_intrinsic[i])
    own = np.array([fx, fy, x, y]) / np.tile(sensor, 2) if by_sensor else np.zeros(4)
    return SceneCamera(
        str(model.camera(i).name),
        Pose(data.cam_xmat[i].reshape(3, 3) @ CV_FROM_GL, data.cam_xpos[i].copy()),
        int(model.body_weldid[model.cam_bodyid[i]]),
        resolution if min(resolution) > 1 else None,
        int(model.cam_projection[i]) == int(mujoco.mjtProjection.mjPROJ_PERSPECTIVE),
        None if by_sensor else math.radians(float(model.cam_fovy[i])),
        (float(own[0]), float(own[1])),
        (float(own[2]), float(own[3])),
    )
