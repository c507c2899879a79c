"""A MuJoCo scene with a rig mounted in it.

MuJoCo's camera axes (x right, y up, z backward) end in this room; poses that leave it use OpenCV's.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from rigsim.errors import InvalidScene
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.sim.axes import CV_FROM_GL, REP103_FROM_RIG, principal_offset
from rigsim.sim.scenes import elements, gate, library
from rigsim.sim.scenes.declared import declared_boards
from rigsim.sim.scenes.made import MadeScene
from rigsim.sim.scenes.textures import apply_textures
from rigsim.sim.truth import around

SIDES: tuple[str, str] = ("left", "right")

NEAR_M = 0.005
"""Where pictures begin, from the camera along its axis."""

_MIN_FAR_M = 100.0
_SHADOW_PX = 2048
_CAMERA = "rigsim_{}"
# rays see geoms alone; whatever else MuJoCo can draw is hidden, so that pictures show the same
_DRAWN = (mujoco.mjtVisFlag.mjVIS_TEXTURE, mujoco.mjtVisFlag.mjVIS_STATIC)


@dataclass(slots=True)
class Scene:
    """A compiled model at its reference pose; `place` moves the two cameras within it."""

    name: str
    """Bundled scene's name, or the file's stem."""
    path: Path
    """The MJCF file; of a scene that was made, no more than its name."""
    mount: str
    """Where the rig sits, as `body:head`, `site:rig` or `camera:front`."""
    model: Any
    """mujoco.MjModel."""
    data: Any
    """mujoco.MjData at the keyframe or reference pose."""
    world_from_rig: Pose
    """The mount: the rig's frame (middle of the baseline, OpenCV axes) in the world's."""
    boards: dict[str, dict[str, float]]
    """Checker boards by geom name: rows, cols (inner corners), square_mm."""
    remarks: tuple[Remark, ...]
    """What of the file is not in the pictures."""
    sky: str
    """Name of a skybox whose texture shows; empty where there is none."""
    rig: StereoRig | None = None
    """The rig that was placed last."""
    around: tuple[int, ...] = ()
    """Geoms left out for the placed rig: solids that a camera sits in, planes that one is behind."""
    placements: int = 0
    """How often a rig was placed."""
    own_groups: Any = None
    """Geom groups, (ngeom,), with nothing left out for a rig."""

    @property
    def camera_ids(self) -> tuple[int, int]:
        """MuJoCo ids of the left and right camera."""
        left, right = (self.model.camera(_CAMERA.format(side)).id for side in SIDES)
        return int(left), int(right)

    @property
    def options(self) -> Any:
        """mujoco.MjvOption that shows geoms of the visible groups and nothing else."""
        options = mujoco.MjvOption()
        options.flags[:] = 0
        for flag in _DRAWN:
            options.flags[flag] = 1
        for group in (options.sitegroup, options.jointgroup, options.tendongroup, options.actuatorgroup):
            group[:] = 0
        return options

    @property
    def geom_groups(self) -> Any:
        """Which geom groups are visible, (6,) uint8: the same for pictures and rays."""
        return np.asarray(self.options.geomgroup, dtype=np.uint8).copy()

    @property
    def mounts(self) -> list[str]:
        """Every place with a name that a rig can sit at, as ``site:rig``."""
        return [f"{kind}:{name}" for kind in ("site", "camera", "body") for name in _names(self.model, kind)]

    def place(self, rig: StereoRig, mount_from_rig: Pose | None = None) -> None:
        """Move the two cameras to `rig`, in place: no recompile.

        Args:
            rig: the rig.
            mount_from_rig: where it sits off its mount, in the rig's own axes; None is on it.
        """
        world_from_rig = self.world_from_rig @ (mount_from_rig or Pose())
        rig_from_left = rig.rig_from_left
        poses = (rig_from_left, rig_from_left @ rig.right_from_left.inverse)
        for side, rig_from_camera in enumerate(poses):
            camera_id = self.camera_ids[side]
            world_from_camera = world_from_rig @ rig_from_camera
            quat = np.empty(4)
            mujoco.mju_mat2Quat(quat, (world_from_camera.R @ CV_FROM_GL).ravel())
            self.model.cam_pos[camera_id] = world_from_camera.t
            self.model.cam_quat[camera_id] = quat
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)
        self.rig = rig
        self.placements += 1
        self._leave_out()

    def _leave_out(self) -> None:
        """Hide what surrounds a camera from pictures and rays, and show what surrounded an earlier rig's."""
        self.model.geom_group[:] = self.own_groups
        visible = around.shown(self.model, self.geom_groups)
        found = []
        for side in (0, 1):
            world_from_camera = self.world_from_camera(side)
            found += [
                around.solids_around(
                    self.model, self.data, world_from_camera.t, world_from_camera.R[:, 2], visible
                ),
                around.planes_behind(self.model, self.data, world_from_camera.t, visible),
            ]
        hidden = np.unique(np.concatenate(found))
        around.hide(self.model, hidden)
        self.around = tuple(int(geom) for geom in hidden)

    def set_lens(self, side: int, lens: Intrinsics) -> None:
        """Give the left (0) or right (1) camera the pinhole that is to be drawn with."""
        camera_id = self.camera_ids[side]
        self.model.cam_resolution[camera_id] = (lens.width, lens.height)
        self.model.cam_sensorsize[camera_id] = (lens.width, lens.height)
        self.model.cam_intrinsic[camera_id] = (lens.fx, lens.fy, *principal_offset(lens))

    def world_from_camera(self, side: int) -> Pose:
        """Pose of the left (0) or right (1) camera, OpenCV axes, as MuJoCo holds it."""
        camera_id = self.camera_ids[side]
        R = self.data.cam_xmat[camera_id].reshape(3, 3) @ CV_FROM_GL
        return Pose(R, self.data.cam_xpos[camera_id].copy())

    @contextmanager
    def turned(self, side: int, camera_from_face: Array | None) -> Iterator[None]:
        """For a while, the left (0) or right (1) camera has the axes (3, 3) of a face of its cube."""
        held = self.data.cam_xmat[self.camera_ids[side]]
        before = held.copy()
        if camera_from_face is not None:
            held[:] = (before.reshape(3, 3) @ CV_FROM_GL @ camera_from_face @ CV_FROM_GL).ravel()
        try:
            yield
        finally:
            held[:] = before

    def lens(self, side: int) -> Intrinsics:
        """Intrinsics of the left (0) or right (1) camera of the placed rig."""
        if self.rig is None:
            raise InvalidScene(f"scene {self.name}: no rig was placed in it")
        return self.rig.left if side == 0 else self.rig.right

    def object_name(self, geom_id: int) -> str:
        """A name a person knows a geom by: its own, else its body's; empty for nothing."""
        if geom_id < 0:
            return ""
        geom = self.model.geom(geom_id)
        return str(geom.name or self.model.body(int(geom.bodyid[0])).name or f"geom {geom_id}")


def load_scene(scene: str | MadeScene, mount: str | None = None) -> Scene:
    """Load a bundled scene by name, any MJCF file by path, or a made one, and mount two cameras in it.

    Args:
        scene: name of a bundled scene, path of an MJCF file, or a scene that was made.
        mount: `body:NAME`, `site:NAME` or `camera:NAME`; by default a site or camera called `rig`,
            else the file's only camera.

    Raises:
        InvalidScene: the file is missing or broken, or the mount is unknown.
    """
    if isinstance(scene, MadeScene):
        path, label = Path(scene.name), scene.name
    else:
        path = library.find(scene)
        gate.check(path)
        label = path.parent.name if path.name == "scene.xml" else path.stem
    with gate.passing(path) as warned:
        spec, model = _compile(
            mujoco.MjSpec.from_string(scene.text)
            if isinstance(scene, MadeScene)
            else mujoco.MjSpec.from_file(str(path))
        )
        boards = declared_boards(spec)
        data = mujoco.MjData(model)
        if model.nkey:
            mujoco.mj_resetDataKeyframe(model, data, 0)
        mujoco.mj_fwdPosition(model, data)
    gate.check_numbers(model, data, path)
    kind, name = _choose_mount(model, mount, path)
    world_from_rig = _world_from_mount(model, data, kind, name)
    remarks = (*elements.warned(label, warned), *elements.left_out(model, label))
    _set_render_limits(model, data, world_from_rig.t)
    around.hide(model, around.never_drawn(model, data))
    return Scene(
        label,
        path,
        f"{kind}:{name}",
        model,
        data,
        world_from_rig,
        boards,
        remarks,
        elements.textured_sky(model),
        own_groups=model.geom_group.copy(),
    )


def _compile(spec: Any) -> tuple[Any, Any]:
    """A file's MjSpec with two cameras, and its MjModel."""
    gate.check_names(spec)
    for side in SIDES:
        spec.worldbody.add_camera(
            name=_CAMERA.format(side),
            resolution=[1, 1],
            sensor_size=[1.0, 1.0],
            focal_pixel=[1.0, 1.0],
        )
    apply_textures(spec)
    return spec, spec.compile()


def _names(model: Any, kind: str) -> list[str]:
    count = {"body": model.nbody, "site": model.nsite, "camera": model.ncam}[kind]
    names = [str(getattr(model, kind)(i).name) for i in range(count)]
    return [name for name in names if name and name not in {_CAMERA.format(side) for side in SIDES}]


def _choose_mount(model: Any, mount: str | None, path: Path) -> tuple[str, str]:
    known = {kind: _names(model, kind) for kind in ("site", "camera", "body")}
    names = [f"{kind}:{name}" for kind in known for name in known[kind]]
    choices = gate.clipped(", ".join(names)) or "nothing has a name"
    if mount is None:
        for kind in ("site", "camera"):
            if "rig" in known[kind]:
                return kind, "rig"
        if len(known["camera"]) == 1:
            return "camera", known["camera"][0]
        raise InvalidScene(f"{path}: no site or camera called rig: choose a --mount among {choices}")
    kind, _, name = mount.partition(":")
    if kind not in known:
        raise InvalidScene(f"mount {mount!r}: write body:NAME, site:NAME or camera:NAME ({choices})")
    if name not in known[kind]:
        raise InvalidScene(f"mount {mount!r}: {path.name} has no such {kind}; choose among {choices}")
    return kind, name


def _world_from_mount(model: Any, data: Any, kind: str, name: str) -> Pose:
    if kind == "camera":
        camera = data.camera(name)
        return Pose(camera.xmat.reshape(3, 3) @ CV_FROM_GL, camera.xpos.copy())
    item = data.body(name) if kind == "body" else data.site(name)
    return Pose(item.xmat.reshape(3, 3) @ REP103_FROM_RIG, item.xpos.copy())


def _set_render_limits(model: Any, data: Any, mount_world: Array) -> None:
    """Clip planes and shadows that keep the picture true, whatever the file says."""
    old_extent = float(model.stat.extent)
    reach = float(
        (np.linalg.norm(data.geom_xpos - mount_world, axis=1) + _radius(model)).max(initial=_MIN_FAR_M)
    )
    model.stat.extent = 1.0
    model.vis.map.znear = NEAR_M
    model.vis.map.zfar = 2 * reach
    # these three are multiples of the extent: keep their lengths in metres
    model.vis.map.fogstart *= old_extent
    model.vis.map.fogend *= old_extent
    model.vis.map.shadowclip *= old_extent
    model.vis.quality.shadowsize = min(model.vis.quality.shadowsize, _SHADOW_PX)


def _radius(model: Any) -> Array:
    """Bounding radius of each geom, m; a finite plane's half diagonal, 0 for an infinite one."""
    plane = np.linalg.norm(model.geom_size[:, :2], axis=1)
    return np.asarray(np.where(model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE, plane, model.geom_rbound))
