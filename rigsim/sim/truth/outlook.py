"""What a placed rig has before it, by a few rays: what is odd is remarked, a camera in a surface refused."""

from __future__ import annotations

import numpy as np

from rigsim.errors import NothingSeen
from rigsim.rig.arrays import Array, Ids
from rigsim.rig.remark import Remark
from rigsim.sim.scenes.scene import NEAR_M, SIDES, Scene
from rigsim.sim.truth import rays
from rigsim.sim.truth.points import away, depth_edges_m, directions

_COLUMNS, _ROWS = 41, 31
_CLOSE_M = 0.02  # nearer than stereo cameras focus and match
_CLOSE_SHARE = 0.01  # of a picture
_MOSTLY = 0.75
_ENOUGH = 40  # of 1271 rays, to tell a share by


def look_around(scene: Scene) -> list[Remark]:
    """Remarks on the placed rig's view.

    Raises:
        NothingSeen: a camera lies in a surface, so that its picture would be empty.
    """
    remarks = _surrounded(scene)
    views = [rays.hits_at(scene, side, _grid(scene, side)) for side in (0, 1)]
    for side, (points, geom) in enumerate(views):
        _check_free(scene, side, away(scene.lens(side), points), geom)
    for side, (points, geom) in enumerate(views):
        remarks += _close(scene, side, away(scene.lens(side), points), geom)
    remarks += _sky(scene, [geom for _, geom in views])
    remarks += _hidden(scene, views[0][0])
    return remarks


def _grid(scene: Scene, side: int) -> Array:
    """Pixels (N, 2) over the whole picture, its edges included."""
    lens = scene.lens(side)
    u, v = np.meshgrid(
        np.linspace(-0.5, lens.width - 0.5, _COLUMNS), np.linspace(-0.5, lens.height - 0.5, _ROWS)
    )
    return np.column_stack([u.ravel(), v.ravel()])


def _surrounded(scene: Scene) -> list[Remark]:
    if not scene.around:
        return []
    names = list(dict.fromkeys(f"{scene.object_name(geom)}" for geom in scene.around))
    listed = ", ".join(names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")
    text = (
        f"at {scene.mount} a camera sits in or behind {listed}: left out of both pictures and of the truth "
        "for such a rig; move the mount if that is not meant"
    )
    return [_remark(scene, "inside_geom", text)]


def _remark(scene: Scene, code: str, text: str) -> Remark:
    return Remark(code, f"scene {scene.name}: {text}")


def _check_free(scene: Scene, side: int, depth: Array, geom: Ids) -> None:
    if not (depth < NEAR_M).any():
        return
    nearest = int(np.nanargmin(depth))
    name, gap_mm = scene.object_name(int(geom[nearest])), round(max(float(depth[nearest]), 0.0) * 1e3, 2)
    where = f"lies in the surface of {name}" if gap_mm == 0 else f"is {gap_mm:g} mm from {name}"
    raise NothingSeen(
        f"scene {scene.name}: the {SIDES[side]} camera at {scene.mount} {where}, where nothing can be seen: "
        f"must be >= {NEAR_M * 1e3:g} mm; move the mount, or take another --baseline"
    )


def _close(scene: Scene, side: int, depth: Array, geom: Ids) -> list[Remark]:
    near = depth < _CLOSE_M
    if near.mean() < _CLOSE_SHARE:
        return []
    nearest = int(np.nanargmin(depth))
    name = scene.object_name(int(geom[nearest]))
    text = (
        f"{name} is {depth[nearest] * 1e3:.2g} mm before the {SIDES[side]} camera at {scene.mount}; "
        f"{near.mean():.0%} of its picture is nearer than {_CLOSE_M * 1e3:g} mm: move the mount if that is "
        "not meant"
    )
    return [_remark(scene, "near_surface", text)]


def _sky(scene: Scene, geoms: list[Ids]) -> list[Remark]:
    shown = [np.isfinite(directions(scene.lens(side), _grid(scene, side))[:, 2]) for side in (0, 1)]
    share = max(float(((geom < 0) & seen).mean()) for geom, seen in zip(geoms, shown, strict=True))
    if not scene.sky or share == 0:
        return []
    text = (
        f"the skybox {scene.sky} fills {share:.0%} of a picture: it is at infinity and has no depth, so "
        "what is found on it is not counted"
    )
    return [_remark(scene, "skybox", text)]


def _hidden(scene: Scene, points_left: Array) -> list[Remark]:
    """A bin of depth of which the right camera sees next to nothing, as behind a grid."""
    rig = scene.rig
    assert rig is not None
    points_left = points_left[np.isfinite(points_left[:, 2])]
    depth = away(rig.left, points_left)
    both = rig.right.contains(rig.project(points_left)[1])
    if not both.any():
        return []
    depth = depth[both]
    hidden = ~rays.sees(scene, 1, scene.world_from_camera(0).apply(points_left[both]))
    edges = depth_edges_m(float(depth.min()), float(depth.max()))
    bins = np.searchsorted(edges[1:-1], depth, side="right")
    counts, shares = np.bincount(bins), np.bincount(bins, hidden) / np.maximum(np.bincount(bins), 1)
    worst = int(np.argmax(np.where(counts >= _ENOUGH, shares, 0)))
    if counts[worst] < _ENOUGH or shares[worst] < _MOSTLY:
        return []
    text = (
        f"of what the left camera sees between {edges[worst]:g} and {edges[worst + 1]:g} m, "
        f"{shares[worst]:.0%} is hidden from the right camera by something nearer: few points there "
        "are seen by both"
    )
    return [_remark(scene, "mostly_hidden", text)]
