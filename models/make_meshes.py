"""Makes the OBJ files of the bundled scenes again: python models/make_meshes.py [FOLDER].

Lengths in metres, z up.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from solids import TURN, Array, Mesh, circle, join, polygon_prism, quad, revolve, sheet, tube


def _smooth(rng: np.random.Generator, count: int, knots: int, closed: bool) -> Array:
    """A smooth random curve (count,), about -1..1."""
    values = rng.uniform(-1, 1, knots)
    position = np.arange(count) * knots / count if closed else np.linspace(0, knots - 1.001, count)
    i = position.astype(int)
    t = position - i
    t = t * t * (3 - 2 * t)
    return np.asarray(values[i] * (1 - t) + values[(i + 1) % knots] * t)


def limb(seed: int, length: float, thick: float, thin: float, sections: int, sides: int, sway: float) -> Mesh:
    """A bough along x from the origin: sways, tapers, and has knots."""
    rng = np.random.default_rng(seed)
    s = np.linspace(0, 1, sections)
    start = np.minimum(1, s * 4)
    path = np.stack(
        [s * length, *(start * sway * _smooth(rng, sections, 7, closed=False) for _ in range(2))], axis=1
    )
    bumps = np.array([_smooth(rng, sides, 6, closed=True) for _ in range(9)])
    at = s * 8 * 0.999
    i = at.astype(int)
    blend = bumps[i] * (1 - (at - i))[:, None] + bumps[i + 1] * (at - i)[:, None]
    knots = 1 + 0.10 * np.abs(_smooth(rng, sections, sections // 3, closed=False))
    around = max(round(TURN * (thick + thin) / 2 / 0.3), 1)
    return tube(path, thick * (1 - s) ** 0.8 + thin, sides, around, 0.45, (1 + 0.1 * blend) * knots[:, None])


def leaf_spray(seed: int, count: int, reach: float) -> Mesh:
    """Leaves on all sides of a twig along x, 0.4 mm thick, each folded along its rib."""
    rng = np.random.default_rng(seed)
    pieces = []
    for _ in range(count):
        length = rng.uniform(0.07, 0.13)
        w, lift = 0.24 * length, 0.10 * length
        points = np.array(
            [
                [0, 0, 0],
                [0.35, 1, lift / w],
                [0.7, 0.75, lift / w],
                [1, 0, 0],
                [0.7, -0.75, lift / w],
                [0.35, -1, lift / w],
            ]
        ) * (length, w, w)
        azimuth, droop, twist = rng.uniform(0, TURN), rng.uniform(0.2, 1.0), rng.uniform(-0.7, 0.7)
        direction = np.array(
            [0.35, np.cos(azimuth) * np.cos(droop), np.sin(azimuth) * np.cos(droop) - 0.45 * droop]
        )
        direction /= np.linalg.norm(direction)
        side = np.cross([0, 0, 1], direction)
        side /= np.linalg.norm(side)
        up = np.cross(direction, side)
        side, up = np.cos(twist) * side + np.sin(twist) * up, np.cos(twist) * up - np.sin(twist) * side
        R = np.stack([direction, side, up], axis=1)
        at = np.array([rng.uniform(0, reach), 0, 0]) + 0.01 * direction
        uv = rng.uniform(0, 1, 2) + points[:, :2] / 0.25
        top, bottom = points @ R.T + at, points @ R.T + at - 0.0004 * up
        for half in ([0, 3, 2, 1], [0, 5, 4, 3]):
            pieces.append(quad(top[half], uv[half]))
            pieces.append(quad(bottom[half[::-1]], uv[half[::-1]]))
        for a, b in zip([0, 5, 4, 3, 2, 1], [5, 4, 3, 2, 1, 0], strict=True):
            pieces.append(quad(np.array([bottom[a], bottom[b], top[b], top[a]]), uv[[a, b, b, a]]))
    return join(pieces)


def crown(seed: int, rings: int, sides: int, rough: float) -> Mesh:
    """A tree's crown or a bush of radius 1: a lumpy ball."""
    rng = np.random.default_rng(seed)
    lat = np.linspace(-np.pi / 2 * 0.96, np.pi / 2 * 0.96, rings)
    lumps = sum(
        2.0**-k * np.array([_smooth(rng, sides, 7 * 2**k, closed=True) for _ in range(rings)])
        for k in range(2)
    )
    r = 1 + rough * (0.6 * np.asarray(lumps) + 0.4 * rng.uniform(-1, 1, (rings, sides)))
    angle = TURN * np.arange(sides) / sides
    ball = np.stack(
        [
            np.cos(lat)[:, None] * np.cos(angle),
            np.cos(lat)[:, None] * np.sin(angle),
            np.sin(lat)[:, None] + 0 * angle,
        ],
        axis=-1,
    )
    return sheet(ball * r[..., None], np.linspace(0, 5, rings), np.arange(sides + 1) / sides * 10)


def hedge(seed: int, length: float, height: float, depth: float) -> Mesh:
    """A clipped hedge along y, standing on z = 0 and centred there."""
    rng = np.random.default_rng(seed)
    sections, sides = 60, 24
    angle = TURN * np.arange(sides) / sides
    corner = 1 / np.maximum(np.abs(np.cos(angle)), np.abs(np.sin(angle))) ** 0.7
    y = np.linspace(-length / 2, length / 2, sections)
    bump = 1 + 0.05 * rng.uniform(-1, 1, (sections, sides))
    x = depth / 2 * corner * np.cos(angle) * bump
    z = height / 2 * (1 + np.clip(corner * np.sin(angle), -1, 1) * bump)
    rings = np.stack([x, np.broadcast_to(y[:, None], x.shape), np.maximum(z, 0)], axis=-1)[:, ::-1]
    return sheet(rings, y / 1.0, np.arange(sides + 1) / sides * round(2 * (height + depth)))


def blade() -> Mesh:
    """A two-bladed propeller, 0.24 m across, along x."""
    s = np.linspace(-1, 1, 17)
    pieces = []
    chord = 0.011 * (1 - 0.55 * np.abs(s)) * np.minimum(1, 6 * (1.03 - np.abs(s))) + 0.002
    pitch = np.sign(s) * 0.35 * (1 - 0.6 * np.abs(s))
    rings = []
    for i in range(len(s)):
        ring = np.array([[1, 0], [0, 0.0013], [-1, 0], [0, -0.0013]]) * (chord[i], 1)
        c, q = np.cos(pitch[i]), np.sin(pitch[i])
        rings.append(np.column_stack([np.full(4, 0.12 * s[i]), ring @ np.array([[c, q], [-q, c]])]))
    pieces.append(sheet(np.array(rings), s * 2, np.arange(5) / 4))
    return join(pieces)


def amphora() -> Mesh:
    """The pot of the scan, 0.40 m tall, standing on z = 0; hollow at the mouth."""
    r_mm = (0, 48, 52, 40, 52, 92, 118, 122, 105, 66, 45, 41, 48, 64, 66, 58, 40, 34, 0)
    z_mm = (0, 0, 10, 22, 50, 110, 175, 215, 262, 298, 322, 350, 378, 392, 400, 402, 380, 340, 335)
    knots = np.array([r_mm, z_mm]).T / 1e3
    t = np.linspace(0, len(knots) - 1, 46)
    i = np.minimum(t.astype(int), len(knots) - 2)
    before, after = knots[np.maximum(i - 1, 0)], knots[np.minimum(i + 2, len(knots) - 1)]
    f = (t - i)[:, None]
    a, b = knots[i], knots[i + 1]
    profile = 0.5 * (  # Catmull-Rom
        2 * a
        + (b - before) * f
        + (2 * before - 5 * a + 4 * b - after) * f**2
        + (3 * a - before - 3 * b + after) * f**3
    )
    profile[:, 0] = np.maximum(profile[:, 0], 0.0005)
    return revolve(profile, 72, 2.0)


def handle() -> Mesh:
    """One handle of the amphora, on its +x side, from shoulder to neck."""
    knots = np.array(
        [(0.098, 0.262), (0.118, 0.285), (0.122, 0.320), (0.104, 0.350), (0.070, 0.362), (0.040, 0.362)]
    )
    t = np.linspace(0, len(knots) - 1, 22)
    x, z = (np.interp(t, np.arange(len(knots)), knots[:, k]) for k in range(2))
    for _ in range(3):
        x[1:-1], z[1:-1] = ((w[:-2] + 2 * w[1:-1] + w[2:]) / 4 for w in (x, z))
    path = np.stack([x, np.zeros_like(x), z], axis=1)
    return tube(path, np.full(len(x), 0.0095), 12, 1, 0.08)


def gear(teeth: int, radius: float, depth: float, bore: float) -> Mesh:
    """A spur gear about z."""
    tooth = np.array([(-0.5, 0.86), (-0.27, 0.87), (-0.16, 1.0), (0.16, 1.0), (0.27, 0.87)])
    angle = TURN * (np.arange(teeth)[:, None] + tooth[:, 0]).ravel() / teeth
    r = radius * np.tile(tooth[:, 1], teeth)
    outline = np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1)
    hole = 1.3 * bore * np.stack([np.cos(angle), np.sin(angle)], axis=1)  # the hub's bore is the one seen
    hub = polygon_prism(circle(1.9 * bore, 24), depth * 1.8, 0.08, circle(bore, 24))
    return polygon_prism(outline, depth, 0.08, hole) + hub


def plate(half_x: float, half_y: float, depth: float, bore: float, center_x: float = 0.0) -> Mesh:
    """A rectangular plate with one round hole in the middle."""
    angle = TURN * (np.arange(32) + 0.5) / 32
    c, s = np.cos(angle), np.sin(angle)
    reach = np.minimum(half_x / np.abs(c), half_y / np.abs(s))
    outline = np.stack([reach * c, reach * s], axis=1)
    # the corners themselves belong to the outline
    for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
        k = int(np.argmin(np.hypot(outline[:, 0] - sx * half_x, outline[:, 1] - sy * half_y)))
        outline[k] = (sx * half_x, sy * half_y)
    hole = bore * np.stack([c, s], axis=1)
    mesh = polygon_prism(outline, depth, 0.08, hole)
    return mesh.moved(np.eye(3), (center_x, 0, 0))


def bracket() -> Mesh:
    """An angle bracket of two drilled plates, 60 x 45 x 50 mm, 5 mm thick."""
    lying = plate(0.03, 0.0225, 0.005, 0.007)
    standing = plate(0.025, 0.0225, 0.005, 0.007).moved(
        np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]), (-0.0275, 0.0, 0.0275)
    )
    return lying + standing


def bolt(length: float, radius: float) -> Mesh:
    """A hexagon bolt along z, head up, with the ridges of a thread."""
    head = polygon_prism(circle(1.85 * radius, 6), 1.4 * radius, 0.08).moved(np.eye(3), (0, 0, 0.7 * radius))
    z = np.linspace(-length, 0, 2 * int(length / 0.0035) + 1)
    r = radius * np.where(np.arange(len(z)) % 2 == 0, 0.86, 1.0)
    r[z > -0.35 * length] = 0.97 * radius
    shank = revolve(np.stack([r, z], axis=1), 16, 1.0)
    return head + shank


def ring(outer: float, inner: float, depth: float, sides: int, inner_sides: int = 0) -> Mesh:
    """A nut (6 sides), a washer or a piece of pipe about z."""
    fine = sides * max(1, 24 // sides)
    corners = circle(outer, sides)
    share = np.arange(fine) / (fine // sides)
    i, t = share.astype(int), (share % 1)[:, None]
    outline = corners[i % sides] * (1 - t) + corners[(i + 1) % sides] * t
    return polygon_prism(outline, depth, 0.08, circle(inner, fine))


def shaft() -> Mesh:
    """A stepped shaft along z, 0.22 m long."""
    r_mm = (0.5, 10, 12, 12, 18, 18, 24, 24, 16, 16, 10, 10, 8, 0.5)
    z_mm = (-110, -110, -108, -50, -50, 10, 10, 25, 25, 80, 80, 108, 110, 110)
    profile = np.array([r_mm, z_mm]).T / 1e3
    twice = np.repeat(profile, 2, axis=0)  # sharp shoulders
    return revolve(twice[1:-1], 28, 2.0)


MESHES: dict[str, Callable[[], Mesh]] = {
    "branch/trunk.obj": lambda: limb(11, 5.0, 0.09, 0.11, 40, 24, 0.05),
    "branch/limb.obj": lambda: limb(12, 3.3, 0.058, 0.026, 72, 24, 0.07),
    "branch/bough.obj": lambda: limb(13, 1.3, 0.022, 0.009, 32, 14, 0.05),
    "branch/twig.obj": lambda: limb(14, 0.7, 0.007, 0.004, 18, 8, 0.035),
    "branch/spray.obj": lambda: leaf_spray(15, 44, 0.66),
    "branch/crown.obj": lambda: crown(16, 30, 48, 0.16),
    "branch/hedge.obj": lambda: hedge(17, 14.0, 1.9, 1.0),
    "branch/blade.obj": blade,
    "artifact/amphora.obj": amphora,
    "artifact/handle.obj": handle,
    "corridor/plant.obj": lambda: crown(18, 24, 32, 0.3).moved(np.diag([0.28, 0.26, 0.38])),
    "bin/gear.obj": lambda: gear(24, 0.048, 0.014, 0.010),
    "bin/pinion.obj": lambda: gear(14, 0.026, 0.020, 0.006),
    "bin/bracket.obj": bracket,
    "bin/flange.obj": lambda: plate(0.04, 0.04, 0.008, 0.018),
    "bin/bolt.obj": lambda: bolt(0.075, 0.008),
    "bin/nut.obj": lambda: ring(0.020, 0.0095, 0.014, 6),
    "bin/pipe.obj": lambda: ring(0.023, 0.018, 0.11, 24),
    "bin/shaft.obj": shaft,
}
"""Every mesh by its path below the models folder."""


def main() -> None:
    """Write all meshes below the folder given, by default this one."""
    root = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent
    for path, make in MESHES.items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_text(make().obj(), encoding="utf-8")


if __name__ == "__main__":
    main()
