"""Solids as triangle and quad meshes with texture coordinates, for the scenes' OBJ files.

Lengths in metres. Every solid is closed and its faces turn counter-clockwise seen from outside, so that
rays and the renderer, which culls back faces, see the same surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
TURN = 2 * np.pi


@dataclass(frozen=True)
class Mesh:
    """Vertices (N, 3), texture coordinates (M, 2), and for each corner of each face its two indices."""

    vertices: Array
    texture: Array
    faces: list[list[tuple[int, int]]]

    def __add__(self, other: Mesh) -> Mesh:
        v, t = len(self.vertices), len(self.texture)
        return Mesh(
            np.vstack([self.vertices, other.vertices]),
            np.vstack([self.texture, other.texture]),
            self.faces + [[(a + v, b + t) for a, b in face] for face in other.faces],
        )

    def moved(self, R: Array, t: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Mesh:
        """The mesh turned by R and shifted by t."""
        return Mesh(self.vertices @ R.T + np.asarray(t), self.texture, self.faces)

    def obj(self) -> str:
        """Wavefront OBJ text, to a tenth of a millimetre and better."""
        lines = [f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in self.vertices + 0.0]
        lines += [f"vt {u:.4f} {v:.4f}" for u, v in self.texture + 0.0]
        lines += ["f " + " ".join(f"{a + 1}/{b + 1}" for a, b in face) for face in self.faces]
        return "\n".join(lines) + "\n"


def sheet(rings: Array, u: Array, v: Array, *, lids: bool = True) -> Mesh:
    """A tube through `rings` (N, M, 3), each closed; texture `u` (N,) along it and `v` (M + 1,) round it.

    The rings turn counter-clockwise about the direction of travel.
    """
    n, m = rings.shape[:2]
    texture = np.stack(np.broadcast_arrays(u[:, None], v[None]), axis=-1).reshape(-1, 2)
    faces = []
    for i in range(n - 1):
        for j in range(m):
            corners = ((i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j))
            faces.append([(a * m + b % m, a * (m + 1) + b) for a, b in corners])
    mesh = Mesh(rings.reshape(-1, 3), texture, faces)
    if lids:
        for ring, back in ((rings[0], True), (rings[-1], False)):
            mesh = mesh + fan(ring[::-1] if back else ring)
    return mesh


def fan(ring: Array, scale: float = 0.25) -> Mesh:
    """A flat lid on a ring (M, 3) that turns counter-clockwise seen from outside."""
    m = len(ring)
    vertices = np.vstack([ring, ring.mean(axis=0)])
    flat = vertices - vertices[-1]
    size = max(float(np.abs(flat).max()), 1e-6)
    drop = int(np.argmin(np.ptp(flat, axis=0)))
    texture = 0.5 + np.delete(flat, drop, axis=1) / size * scale
    return Mesh(vertices, texture, [[(j, j), ((j + 1) % m, (j + 1) % m), (m, m)] for j in range(m)])


def revolve(profile: Array, sides: int, repeat: float = 1.0) -> Mesh:
    """A solid of revolution about z of a profile (N, 2) of radius and height, bottom first; texture once
    round times `repeat`, its top row at the profile's end."""
    angle = TURN * np.arange(sides) / sides
    r, z = profile[:, 0, None], profile[:, 1, None]
    rings = np.stack(np.broadcast_arrays(r * np.cos(angle), r * np.sin(angle), z), axis=-1)
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(profile, axis=0), axis=1))])
    mesh = sheet(rings, length / length[-1], np.arange(sides + 1) / sides * repeat)
    return Mesh(mesh.vertices, mesh.texture[:, ::-1], mesh.faces)


def tube(
    path: Array, radius: Array, sides: int, around: int, along: float, bumps: Array | None = None
) -> Mesh:
    """A tube along `path` (N, 3) with `radius` (N,); texture `around` times round, one per `along` metres.

    `bumps` (N, sides) multiply the radius.
    """
    tangent = np.gradient(path, axis=0)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    normal = np.cross(tangent[0], [0.31, 0.17, 0.93])
    rings = []
    angle = TURN * np.arange(sides) / sides
    for i, axis in enumerate(tangent):
        normal = normal - axis * (normal @ axis)  # carried along without twist
        normal /= np.linalg.norm(normal)
        side = np.cross(axis, normal)
        r = radius[i] * (np.ones(sides) if bumps is None else bumps[i])
        rings.append(path[i] + r[:, None] * (np.cos(angle)[:, None] * normal + np.sin(angle)[:, None] * side))
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    return sheet(np.array(rings), length / along, np.arange(sides + 1) / sides * around)


def polygon_prism(outline: Array, depth: float, scale: float, hole: Array | None = None) -> Mesh:
    """A plate of thickness `depth` along z with sharp edges: a star-shaped outline (N, 2), counter-clockwise,
    perhaps with a hole of as many points; texture one per `scale` metres."""
    n = len(outline)
    pieces = []
    for ring, outward in ((outline, True), *(((hole, False),) if hole is not None else ())):
        turn = ring if outward else ring[::-1]
        step = np.linalg.norm(np.roll(turn, -1, axis=0) - turn, axis=1)
        start = np.concatenate([[0], np.cumsum(step)])
        for j in range(n):
            a, b = turn[j], turn[(j + 1) % n]
            corners = np.array([[*a, -depth / 2], [*b, -depth / 2], [*b, depth / 2], [*a, depth / 2]])
            u = np.array([start[j], start[j + 1], start[j + 1], start[j]]) / scale
            v = np.array([0, 0, depth, depth]) / scale
            pieces.append(quad(corners, np.stack([u, v], axis=1)))
    for z, up in ((depth / 2, True), (-depth / 2, False)):
        inner = np.broadcast_to(outline.mean(axis=0), (n, 2)) if hole is None else hole
        flat = np.vstack([outline, inner])
        vertices = np.column_stack([flat, np.full(2 * n, z)])
        faces = []
        for j in range(n):
            k = (j + 1) % n
            face = [j, k, n + k, n + j] if hole is not None else [j, k, n + j]
            faces.append([(i, i) for i in (face if up else face[::-1])])
        pieces.append(Mesh(vertices, 0.5 + flat / scale, faces))
    return join(pieces)


def quad(corners: Array, texture: Array) -> Mesh:
    """One face of four corners (4, 3), with texture coordinates (4, 2)."""
    return Mesh(corners, texture, [[(i, i) for i in range(4)]])


def join(pieces: list[Mesh]) -> Mesh:
    """All pieces as one mesh."""
    mesh = pieces[0]
    for piece in pieces[1:]:
        mesh = mesh + piece
    return mesh


def circle(radius: float, sides: int, phase: float = 0.0) -> Array:
    """Points (sides, 2) of a circle, counter-clockwise."""
    angle = TURN * (np.arange(sides) + phase) / sides
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
