"""What both cameras have in view, by the true frusta: any two lenses, any pose.

A scene plane stands at depth Z along the left camera's optical axis. It is cut up in the left image: whole
where both lenses are pinholes, for then a ray's image in the other camera is linear in homogeneous
coordinates and the cuts are exact; into small triangles where a lens distorts.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.lens import ahead
from rigsim.rig.stereo import StereoRig

_CELLS = (64, 48)
_SPLITS = 5
"""How often a triangle is quartered at whose corners a lens shows something, and at others nothing."""
_PER_SIDE = 64
_PULLS = 60


@dataclass(frozen=True, slots=True)
class Shared:
    """The part of the left image whose scene points, at one depth, the right image shows too."""

    share: float
    """Its area over the image's, 0 to 1."""
    corners_uv: Array
    """Corners (K, 2) px of the pieces it is made of; their bounding box is its own."""


def shared_view(rig: StereoRig, inverse_depth: float) -> Shared:
    """What both images show of the plane at Z = 1 / `inverse_depth` (1/m); at infinity when 0."""
    if rig.left.lens is None and rig.right.lens is None:
        return next(_shared_by_pinholes(rig, np.array([inverse_depth])))
    kept: list[Array] = []
    area = 0.0
    for uv, seen in _pieces(rig, inverse_depth):
        edges = _right_edges(rig.right, seen)
        inside = np.all(edges >= 0, axis=(1, 2))
        kept.append(uv[inside].reshape(-1, 2))
        area += float(_areas(uv[inside]).sum())
        # a piece that lies beyond one edge as a whole shows nothing; what is left is cut
        cut = ~inside & ~np.any(np.all(edges < 0, axis=1), axis=1)
        for piece, heights in zip(uv[cut], edges[cut], strict=True):
            part = _clip(np.hstack([piece, heights]))
            if len(part):
                kept.append(part)
                area += float(_areas(part[None])[0])
    corners = np.concatenate(kept) if kept else np.empty((0, 2))
    share = area / (rig.left.width * rig.left.height)
    return Shared(min(share, 1.0), corners) if share > 0 else Shared(0.0, np.empty((0, 2)))


def shared_shares(rig: StereoRig, inverse_depths: Array) -> Array:
    """The shares (N,) of the left image that the right one shows too, at 1 / `inverse_depths` (N,) 1/m."""
    if rig.left.lens is None and rig.right.lens is None:
        return np.array([shared.share for shared in _shared_by_pinholes(rig, inverse_depths)])
    return np.array([shared_view(rig, float(inverse)).share for inverse in inverse_depths])


def _shared_by_pinholes(rig: StereoRig, inverse_depths: Array) -> Iterator[Shared]:
    """The left image is one piece, and one cut of it is exact."""
    camera = rig.left
    u, v = (-0.5, camera.width - 0.5), (-0.5, camera.height - 0.5)
    corners = np.array([(u[0], v[0]), (u[1], v[0]), (u[1], v[1]), (u[0], v[1])])
    image = float(camera.width * camera.height)
    for edges in _right_edges(rig.right, _seen_right(rig, corners, inverse_depths[:, None, None])):
        part = corners if bool((edges >= 0).all()) else _clip(np.hstack([corners, edges]))
        share = _area(part.tolist()) / image
        yield Shared(min(share, 1.0), part) if share > 0 else Shared(0.0, np.empty((0, 2)))


def outline(camera: Intrinsics) -> Array:
    """Rays (K, 3) around the border of what the camera shows: the image's corners for a pinhole.

    With z = 1, but unit rays of a lens that looks past 90 degrees.

    Where the lens shows nothing at the image's border, the outline is drawn in towards the principal point
    until it does.
    """
    u, v = (-0.5, camera.width - 0.5), (-0.5, camera.height - 0.5)
    corners = np.array([(u[0], v[0]), (u[1], v[0]), (u[1], v[1]), (u[0], v[1])])
    if camera.lens is not None:
        along = np.linspace(0, 1, _PER_SIDE, endpoint=False)[:, None]
        ends = np.roll(corners, -1, axis=0)
        corners = np.concatenate([a + along * (b - a) for a, b in zip(corners, ends, strict=True)])
    rays = _rays(camera, corners)
    lost = np.any(np.isnan(rays), axis=1)
    if lost.any():
        last = last_rays(camera, corners[lost])
        rays[lost] = last if camera.is_wide else last / last[:, 2:]
    return rays


def last_rays(camera: Intrinsics, uv: Array) -> Array:
    """The outermost unit rays (N, 3) that the lens shows towards pixels (N, 2), which may show nothing.

    By where it sees: an inverse takes long where there is none.
    """
    turn = np.arctan2((uv[:, 1] - camera.cy) / camera.fy, (uv[:, 0] - camera.cx) / camera.fx)
    low, high = np.zeros(len(uv)), np.full(len(uv), math.pi)
    for _ in range(_PULLS):
        middle = (low + high) / 2
        shown = np.isfinite(camera.project(_off_axis(middle, turn))[:, 0])
        low, high = np.where(shown, middle, low), np.where(shown, high, middle)
    return _off_axis(low, turn)


def _off_axis(angle: Array, turn: Array) -> Array:
    """Unit rays (N, 3) at angles off the axis, rad, turned about it from x towards y."""
    sine = np.sin(angle)
    return np.stack([sine * np.cos(turn), sine * np.sin(turn), np.cos(angle)], axis=-1)


def _rays(camera: Intrinsics, uv: Array) -> Array:
    """Rays (..., 3) of pixels (..., 2): with z = 1, but unit ones of a lens that looks past 90 degrees."""
    return camera.ray(uv) if camera.is_wide else ahead(camera.normalize(uv))


def crossings(origin: Array, rays: Array, fan: Array) -> Array:
    """How far along `rays` (K, 3) from `origin` (3,) they pierce the sides of the pyramid over `fan` (M, 3).

    Returns:
        (K, M), in lengths of the ray; NaN where a side is missed, or lies behind.
    """
    after = np.roll(fan, -1, axis=0)
    normals = np.cross(fan, after)
    with np.errstate(all="ignore"):
        reach = -(normals @ origin) / (rays @ normals.T)
        at = origin + reach[..., None] * rays[:, None, :]
        # at = alpha fan + beta after, both weights positive on the side itself
        slack = 1e-9 * np.linalg.norm(at, axis=-1) * (normals**2).sum(axis=-1) / np.linalg.norm(fan, axis=-1)
        alpha = (np.cross(at, after) * normals).sum(axis=-1)
        beta = (np.cross(fan, at) * normals).sum(axis=-1)
        met = (reach >= 0) & np.isfinite(reach) & (alpha >= -slack) & (beta >= -slack)
    return np.asarray(np.where(met, reach, np.nan))


def nearest_common_depth(rig: StereoRig) -> float:
    """Least Z, m along the left optical axis, of a point that both frusta hold; infinite if there is none.

    Two cones that begin to meet do so where a border ray of one pierces a side of the other, or at the
    apex of one inside the other.
    """
    left_from_right = rig.right_from_left.inverse
    if rig.right.contains(rig.right.project(rig.right_from_left.t)):
        return 0.0
    fan_left, fan_right = outline(rig.left), outline(rig.right)
    found = crossings(rig.right_from_left.t, fan_left @ rig.right_from_left.R.T, fan_right)
    rays = fan_right @ left_from_right.R.T
    found = found * fan_left[:, 2:]
    back = left_from_right.t[2] + crossings(left_from_right.t, rays, fan_left) * rays[:, 2:]
    depths = np.concatenate([found.ravel(), back.ravel()])
    if rig.left.contains(rig.left.project(left_from_right.t)):
        depths = np.append(depths, left_from_right.t[2])
    depths = depths[np.isfinite(depths)]
    return max(float(depths.min()), 0.0) if depths.size else math.inf


def _pieces(rig: StereoRig, inverse_depth: float) -> Iterator[tuple[Array, Array]]:
    """Polygons (N, K, 2) px of the left image, with where the right one shows their corners (N, K, 3)."""
    camera = rig.left
    columns, rows = _CELLS
    u, v = np.meshgrid(
        np.linspace(-0.5, camera.width - 0.5, columns + 1), np.linspace(-0.5, camera.height - 0.5, rows + 1)
    )
    uv = np.stack([u, v], axis=-1)
    cells = np.stack([uv[:-1, :-1], uv[:-1, 1:], uv[1:, 1:], uv[1:, :-1]], axis=2).reshape(-1, 4, 2)
    triangles = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    for _ in range(_SPLITS + 1):
        seen = _seen_right(rig, triangles, inverse_depth)
        known = np.all(np.isfinite(seen), axis=2)
        whole = np.all(known, axis=1)
        yield triangles[whole], seen[whole]
        triangles = _quartered(triangles[np.any(known, axis=1) & ~whole])


def _seen_right(rig: StereoRig, uv_left: Array, inverse_depth: Array | float) -> Array:
    """Where the right lens sees the plane's points at left pixels (..., 2): homogeneous (..., 3), the last
    number the depth; NaN where a lens shows nothing."""
    rays = _rays(rig.left, uv_left)
    points = rays @ rig.right_from_left.R.T + rig.right_from_left.t * (inverse_depth * rays[..., 2:])
    if rig.right.lens is None:
        return np.asarray(points @ rig.right.K.T)
    with np.errstate(invalid="ignore"):
        uv = rig.right.project(points)
        weight = np.linalg.norm(points, axis=-1)[..., None] if rig.right.is_wide else points[..., 2:]
        # a plane at a depth has no points beside or behind the camera
        known = ~np.isnan(uv[..., :1]) & ((rays[..., 2:] > 0) | (np.asarray(inverse_depth) == 0))
        return np.where(known, np.concatenate([uv * weight, weight], axis=-1), np.nan)


def _right_edges(camera: Intrinsics, seen: Array) -> Array:
    """Four numbers (..., 4), linear in `seen` (..., 3), that are all >= 0 where the image shows it."""
    u, v, w = seen[..., 0], seen[..., 1], seen[..., 2]
    return np.stack(
        [u + 0.5 * w, (camera.width - 0.5) * w - u, v + 0.5 * w, (camera.height - 0.5) * w - v], axis=-1
    )


def _clip(polygon: Array) -> Array:
    """The part (M, 2) of a convex polygon (N, 2 + E) where all of the numbers after the first two are >= 0.

    Sutherland and Hodgman, CACM 1974; on plain numbers, as there are few.
    """
    corners: list[list[float]] = polygon.tolist()
    for edge in range(2, polygon.shape[1]):
        kept: list[list[float]] = []
        for i, here in enumerate(corners):
            before = corners[i - 1]
            if (here[edge] >= 0) != (before[edge] >= 0):
                share = before[edge] / (before[edge] - here[edge])
                kept.append([a + share * (b - a) for a, b in zip(before, here, strict=True)])
            if here[edge] >= 0:
                kept.append(here)
        if len(kept) < 3:
            return np.empty((0, 2))
        corners = kept
    return np.array(corners)[:, :2]


def _areas(polygons: Array) -> Array:
    """Areas (N,) of polygons (N, K, 2)."""
    x, y = polygons[..., 0], polygons[..., 1]
    return np.asarray(np.abs((x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)) / 2)


def _area(corners: list[list[float]]) -> float:
    """Area of one polygon."""
    ahead = corners[1:] + corners[:1]
    return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(corners, ahead, strict=True))) / 2


def _quartered(triangles: Array) -> Array:
    """Four triangles in the place of each of (N, 3, 2)."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    quarters = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([np.stack(corners, axis=1) for corners in quarters])
