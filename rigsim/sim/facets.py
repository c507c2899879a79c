"""Curved geoms drawn with as many facets as their size on the image asks for.

MuJoCo draws every sphere, capsule, cylinder and ellipsoid from unit shapes whose number of slices is the same for
all. Here coarser unit shapes are compiled beside its own, and each geom of a picture is pointed at the coarsest
that is fine enough, by drawing it as a mesh: a display list under the geom's own turn and size.
"""

from __future__ import annotations

import math
from typing import Any

import mujoco
import numpy as np

from rigsim.rig.arrays import Array, Ids
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose

FINEST = 256
"""Slices of what is largest on the image."""
LEVELS: tuple[int, ...] = (16, 32, 64, 128)
"""Coarser numbers of slices."""
SAG_PX = 0.04
"""Farthest that a facet may lie inside its surface, px on the image, until `FINEST` is reached: what 256 slices
leave of a sphere 1000 px wide."""
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
_ROLES = mujoco.mjtTextureRole.mjNTEXROLE.value
_MESH = mujoco.mjtGeom.mjGEOM_MESH.value
_COPIED = tuple(name for name in dir(mujoco.MjvGeom) if not name.startswith("_"))
_EMPTY = """<mujoco><visual><global offwidth="8" offheight="8"/>
<quality numslices="{0}" numstacks="{0}" numquads="{1}" shadowsize="0" offsamples="0"/></visual></mujoco>"""


def slices(radius_px: Array) -> Array:
    """Slices for circles of a radius on the image, px: the coarsest level whose sag is within `SAG_PX`.

    The chord of one of n slices lies ``r (1 - cos(pi / n))`` inside its circle, about ``r pi^2 / (2 n^2)``.
    """
    need = math.pi * np.sqrt(np.asarray(radius_px) / (2 * SAG_PX))
    return np.asarray(np.array([*LEVELS, FINEST])[np.searchsorted(LEVELS, need)])


def radii_px(model: Any, data: Any, world_from_camera: Pose, lens: Intrinsics) -> Array:
    """Largest radius of each curved geom's circles as the camera sees them, (ngeom,), px.

    Taken at the geom's nearest point, and stretched as towards a wide picture's corners.
    """
    size = model.geom_size
    round_m = np.where(model.geom_type == mujoco.mjtGeom.mjGEOM_ELLIPSOID, size.max(axis=1), size[:, 0])
    offset_camera = world_from_camera.inverse.apply(data.geom_xpos)
    distance = np.linalg.norm(offset_camera, axis=1)
    corner = math.hypot(
        max(lens.cx, lens.width - lens.cx) / lens.fx, max(lens.cy, lens.height - lens.cy) / lens.fy
    )
    slant = np.clip(offset_camera[:, 2] / np.maximum(distance, 1e-9), 1 / math.hypot(1, corner), 1.0)
    nearest = np.maximum(distance - model.geom_rbound, 1e-3)
    return np.asarray(round_m * max(lens.fx, lens.fy) / nearest / slant**2)


class Facets:
    """Coarse unit shapes in the GL context that is current when this is made; `free` them."""

    def __init__(self, context: Any, quads: int) -> None:
        """Compile the shapes beside those of `context`, the mujoco.MjrContext that draws boxes of `quads`."""
        self._context = context
        self._textures = np.array(context.mat_texid).reshape(-1, _ROLES)[
            :, mujoco.mjtTextureRole.mjTEXROLE_RGB
        ]
        self._kinds = np.array(context.textureType)
        self._own = context.baseBuiltin
        self._coarse = {}
        for n in LEVELS:
            empty = mujoco.MjModel.from_xml_string(_EMPTY.format(n, quads))
            self._coarse[n] = mujoco.MjrContext(empty, mujoco.mjtFontScale.mjFONTSCALE_50.value)

    def apply(self, scene: Any, counts: Ids) -> None:
        """Point the curved geoms of a mujoco.MjvScene at unit shapes with `counts` slices, (ngeom of the model,)."""
        others = [1]
        for i in range(scene.ngeom):
            geom = scene.geoms[i]
            if geom.objtype != mujoco.mjtObj.mjOBJ_GEOM or geom.type not in CURVED:
                continue
            n = int(counts[geom.objid])
            if n == FINEST or self._painted(geom) or scene.ngeom + 2 > scene.maxgeom:
                others.append(n)
            elif geom.type == _CAPSULE:
                self._split(scene, geom, n)
            else:
                self._draw_as(geom, n, _WHOLE[geom.type], geom.size)
        # those that no mesh can stand for share one fineness
        n = max(others)
        self._context.baseBuiltin = self._coarse[n].baseBuiltin if n in self._coarse else self._own

    def free(self) -> None:
        """Give the shapes back."""
        for coarse in self._coarse.values():
            coarse.free()
        self._coarse = {}
        self._context.baseBuiltin = self._own

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
        geom.dataid = self._coarse[n].baseBuiltin + shape - self._context.baseMesh

    def _painted(self, geom: Any) -> bool:
        """Whether the geom wears a flat texture, which MuJoCo lays over a mesh in another way."""
        texture = self._textures[geom.matid] if geom.matid >= 0 else -1
        return bool(texture >= 0 and self._kinds[texture] == mujoco.mjtTexture.mjTEXTURE_2D)


def _copy(to: Any, geom: Any) -> None:
    """Make one mujoco.MjvGeom like another."""
    for name in _COPIED:
        setattr(to, name, getattr(geom, name))
