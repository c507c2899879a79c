"""Curved geoms drawn with as many facets as their size on the image asks for.

MuJoCo draws every sphere, capsule, cylinder and ellipsoid from unit shapes whose number of slices is the
same for all. Here unit shapes of several numbers are compiled beside its own, and each geom of a picture is
pointed at the coarsest that is fine enough: drawn as a mesh, a display list under its own turn and size.
"""

from __future__ import annotations

import math
from typing import Any

import mujoco
import numpy as np

from rigsim.rig.arrays import Array, Ids
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.sim.faces import field

LEVELS: tuple[int, ...] = (16, 32, 64, 128, 256)
"""Numbers of slices, coarsest first."""
FINEST = LEVELS[-1]
"""Slices of what is largest on the image."""
SAG_PX = 0.04
"""Farthest that a facet's edge may lie inside its circle, px on the image, until `FINEST` is reached: what
256 slices leave of a circle 1000 px wide. The middle of a sphere's facet lies twice as far inside."""
CURVED = (
    mujoco.mjtGeom.mjGEOM_SPHERE,
    mujoco.mjtGeom.mjGEOM_CAPSULE,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    mujoco.mjtGeom.mjGEOM_CYLINDER,
)
"""Types of geoms that are drawn with facets."""

# places among MuJoCo's built-in shapes (its render_context.h)
_SPHERE, _TOP, _BOTTOM, _CYLINDER, _OPEN = range(5)
_CAPSULE = mujoco.mjtGeom.mjGEOM_CAPSULE
_WHOLE = {
    mujoco.mjtGeom.mjGEOM_SPHERE: _SPHERE,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID: _SPHERE,
    mujoco.mjtGeom.mjGEOM_CYLINDER: _CYLINDER,
}
_STRAIGHT = (_CYLINDER, _OPEN)
_RINGS = 16  # along what is straight: for the light on it, as many as MuJoCo's own
_UNSEEN = 32  # slices of what is only seen by its shadow
_RGB = mujoco.mjtTextureRole.mjTEXROLE_RGB.value
_ROLES = mujoco.mjtTextureRole.mjNTEXROLE.value
_MESH = mujoco.mjtGeom.mjGEOM_MESH.value
_COPIED = tuple(name for name in dir(mujoco.MjvGeom) if not name.startswith("_"))
_EMPTY = """<mujoco><visual><global offwidth="8" offheight="8"/>
<quality numslices="{}" numstacks="{}" numquads="{}" shadowsize="0" offsamples="0"/></visual></mujoco>"""


def slices(radius_px: Array) -> Array:
    """Slices for circles of a radius on the image, px: the coarsest level whose sag is within `SAG_PX`.

    The chord of one of n slices lies ``r (1 - cos(pi / n))`` inside its circle, about ``r pi^2 / (2 n^2)``.
    """
    need = math.pi * np.sqrt(np.asarray(radius_px) / (2 * SAG_PX))
    return np.asarray(np.array(LEVELS)[np.searchsorted(LEVELS[:-1], need)])


def radii_px(model: Any, data: Any, world_from_camera: Pose, lens: Intrinsics) -> Array:
    """Largest radius of each curved geom's circles as the camera sees them, (ngeom,), px.

    Taken at the geom's nearest point, and stretched as towards a wide picture's corners.
    """
    size = model.geom_size
    round_m = np.where(model.geom_type == mujoco.mjtGeom.mjGEOM_ELLIPSOID, size.max(axis=1), size[:, 0])
    offset_camera = world_from_camera.inverse.apply(data.geom_xpos)
    distance = np.maximum(np.linalg.norm(offset_camera, axis=1), 1e-9)
    off_axis = np.arccos(np.clip(offset_camera[:, 2] / distance, -1, 1))
    about = np.arcsin(np.clip(model.geom_rbound / distance, 0, 1))
    nearest = np.maximum(distance - model.geom_rbound, 1e-3)
    if lens.is_wide:
        wide, scale_px = field(lens)
        radius = round_m * scale_px / nearest
    else:
        x, y = max(lens.cx, lens.width - lens.cx) / lens.fx, max(lens.cy, lens.height - lens.cy) / lens.fy
        wide = math.atan(math.hypot(x, y))
        radius = round_m * max(lens.fx, lens.fy) / nearest / np.cos(np.minimum(off_axis, wide)) ** 2
    most = 2 * SAG_PX * (_UNSEEN / math.pi) ** 2
    in_sight = (off_axis - about < wide) | (about >= math.pi / 2)
    return np.asarray(np.where(in_sight, radius, np.minimum(radius, most)))


class Facets:
    """Unit shapes in the GL context that is current, each compiled when it is first needed; `free` them."""

    def __init__(self, context: Any, quads: int) -> None:
        """Begin with none beside those of `context`, the mujoco.MjrContext that draws boxes of `quads`."""
        self._context = context
        self._quads = quads
        self._textures = np.array(context.mat_texid).reshape(-1, _ROLES)[:, _RGB]
        self._kinds = np.array(context.textureType)
        self._own = context.baseBuiltin
        self._shapes: dict[tuple[int, int], Any] = {}

    def apply(self, scene: Any, counts: Ids) -> None:
        """Point the curved geoms of a mujoco.MjvScene at shapes of `counts` slices, (ngeom of the model,)."""
        others = []
        for i in range(scene.ngeom):
            geom = scene.geoms[i]
            if geom.objtype != mujoco.mjtObj.mjOBJ_GEOM or geom.type not in CURVED:
                continue
            n = int(counts[geom.objid])
            if self._painted(geom) or scene.ngeom + 2 > scene.maxgeom:
                others.append(n)
            elif geom.type == _CAPSULE:
                self._split(scene, geom, n)
            else:
                self._draw_as(geom, n, _WHOLE[geom.type], geom.size)
        # those that no mesh can stand for share one fineness
        self._context.baseBuiltin = self._shape(max(others), _SPHERE) if others else self._own
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._context)

    def free(self) -> None:
        """Give the shapes back."""
        for shape in self._shapes.values():
            shape.free()
        self._shapes = {}
        self._context.baseBuiltin = self._own

    def _shape(self, n: int, shape: int) -> int:
        """The display list of a unit shape of n slices."""
        stacks = _RINGS if shape in _STRAIGHT else n // 2  # a stack spans as great an angle as a slice
        key = (n, min(stacks, n // 2))
        if key not in self._shapes:
            empty = mujoco.MjModel.from_xml_string(_EMPTY.format(*key, self._quads))
            self._shapes[key] = mujoco.MjrContext(empty, mujoco.mjtFontScale.mjFONTSCALE_50.value)
        return int(self._shapes[key].baseBuiltin) + shape

    def _split(self, scene: Any, geom: Any, n: int) -> None:
        """A capsule is a tube and two caps."""
        size, position, R = geom.size.copy(), geom.pos.copy(), geom.mat.copy()
        cap = 0.5 * (size[0] + size[1])
        shift = R[:, 2] * (size[2] - cap)
        for shape, sign in ((_TOP, 1), (_BOTTOM, -1)):
            part = scene.geoms[scene.ngeom]
            _copy(part, geom)
            part.pos[:] = position + sign * shift
            self._draw_as(part, n, shape, (size[0], size[1], cap))
            scene.ngeom += 1
        self._draw_as(geom, n, _OPEN, size)

    def _draw_as(self, geom: Any, n: int, shape: int, size: Any) -> None:
        geom.mat[:] = geom.mat * np.asarray(size)
        geom.type = _MESH
        geom.dataid = self._shape(n, shape) - self._context.baseMesh

    def _painted(self, geom: Any) -> bool:
        """Whether the geom wears a flat texture, which MuJoCo lays over a mesh in another way."""
        texture = self._textures[geom.matid] if geom.matid >= 0 else -1
        return bool(texture >= 0 and self._kinds[texture] == mujoco.mjtTexture.mjTEXTURE_2D)


def _copy(to: Any, geom: Any) -> None:
    """Make one mujoco.MjvGeom like another."""
    for name in _COPIED:
        setattr(to, name, getattr(geom, name))
