"""Which geoms cameras do not look at: solids they sit in, planes they are behind, and second copies."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from rigsim.rig.arrays import Array, Ids, Mask

_BACK_M = 1e-6  # a camera set flush into a face is inside when it looks out, and outside when it looks in
_SAME = 7  # decimals in which copies agree
# an odd set of directions all round, none along an axis, an edge or a diagonal of the usual shapes
_TURNS = np.random.default_rng(5).normal(size=(24, 3))
_MOST = 0.9  # of the rays from inside a solid that must leave through its back; meshes may have holes
_FAINT = 1e-3  # alpha that rays see
_HIDDEN_GROUP = mujoco.mjNGROUP - 1


def shown(model: Any, groups: Array) -> Mask:
    """Which geoms pictures and rays show, (ngeom,): of a visible group, and not wholly transparent."""
    material = model.geom_matid
    alpha = np.where(material >= 0, _last(model.mat_rgba, material), model.geom_rgba[:, 3])
    # MuJoCo lets a geom's own colour stand in for its material's where it is not the default grey
    own = ~np.all(model.geom_rgba == np.array([0.5, 0.5, 0.5, 1]), axis=1)
    alpha = np.where(own, model.geom_rgba[:, 3], alpha)
    visible: Mask = (groups[np.clip(model.geom_group, 0, len(groups) - 1)] > 0) & (alpha > 0)
    return visible


def hide(model: Any, geoms: Ids) -> None:
    """Put geoms where neither pictures nor rays look: a group that is never visible."""
    model.geom_group[geoms] = _HIDDEN_GROUP


def never_drawn(model: Any, data: Any) -> Ids:
    """Geoms that no rig sees: wholly transparent ones, and copies that lie on another geom.

    Rays look at a material's alpha, pictures at the geom's own where it is given: both get to see what is
    drawn.
    """
    visible = shown(model, mujoco.MjvOption().geomgroup)
    used = np.unique(model.geom_matid[visible & (model.geom_matid >= 0)])
    model.mat_rgba[used, 3] = np.maximum(model.mat_rgba[used, 3], _FAINT)
    second = copies(model, data, visible)
    return np.unique(np.concatenate([second, np.flatnonzero(~visible).astype(np.int32)]))


def copies(model: Any, data: Any, among: Mask) -> Ids:
    """Geoms that lie exactly on another one of the same shape, as a collision geom on its visual twin.

    Of such a set the one to look at stays: one that does not collide, as MuJoCo's visual geoms; else
    the most opaque; else the first.
    """
    at = np.flatnonzero(among)
    place = np.hstack([data.geom_xpos[at], data.geom_xmat[at], model.geom_size[at]])
    kind = np.column_stack([model.geom_type[at], model.geom_dataid[at]])
    sets: dict[bytes, list[int]] = {}
    for geom, key in zip(at, np.hstack([np.round(place, _SAME) + 0.0, kind]), strict=True):
        sets.setdefault(key.tobytes(), []).append(int(geom))
    collides = (model.geom_contype | model.geom_conaffinity) > 0
    second: list[int] = []
    for members in sets.values():
        members.sort(key=lambda geom: (bool(collides[geom]), -float(model.geom_rgba[geom, 3]), geom))
        second += members[1:]
    return np.array(second, dtype=np.int32)


def planes_behind(model: Any, data: Any, camera_world: Array, among: Mask) -> Ids:
    """Planes whose back is towards the camera; rays go through them, and pictures must too."""
    height = np.einsum("ni,ni->n", camera_world - data.geom_xpos, data.geom_xmat[:, 2::3])
    behind = among & (model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE) & (height < 0)
    return np.flatnonzero(behind).astype(np.int32)


def solids_around(model: Any, data: Any, camera_world: Array, forward_world: Array, among: Mask) -> Ids:
    """Solids that the camera sits in: rays of every direction leave through the back of their surface."""
    start = np.ascontiguousarray(camera_world - _BACK_M * forward_world)
    near = np.linalg.norm(data.geom_xpos - start, axis=1) <= model.geom_rbound
    candidates = np.flatnonzero(among & near & (model.geom_type != mujoco.mjtGeom.mjGEOM_PLANE))
    inside = [geom for geom in candidates if _leaves(model, data, int(geom), start)]
    return np.array(inside, dtype=np.int32)


def _leaves(model: Any, data: Any, geom: int, start: Array) -> bool:
    backs, normal = 0, np.zeros(3)
    for direction in _TURNS:
        distance = _ray(model, data, geom, start, direction, normal)
        backs += distance >= 0 and float(normal @ direction) > 0
    return backs >= _MOST * len(_TURNS)


def _ray(model: Any, data: Any, geom: int, start: Array, direction: Array, normal: Array) -> float:
    kind = model.geom_type[geom]
    if kind == mujoco.mjtGeom.mjGEOM_MESH:
        return float(mujoco.mj_rayMesh(model, data, geom, start, direction, normal))
    if kind == mujoco.mjtGeom.mjGEOM_HFIELD:
        return float(mujoco.mj_rayHfield(model, data, geom, start, direction, normal))
    if kind == mujoco.mjtGeom.mjGEOM_SDF:
        return -1.0
    place = (data.geom_xpos[geom], data.geom_xmat[geom], model.geom_size[geom])
    return float(mujoco.mju_rayGeom(*place, start, direction, int(kind), normal))


def _last(rgba: Array, index: Ids) -> Array:
    """Alpha of each material; 1 where there is none."""
    if len(rgba) == 0:
        return np.ones(len(index))
    return np.where(index >= 0, rgba[np.clip(index, 0, None), 3], 1.0)
