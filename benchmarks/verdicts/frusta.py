"""Overlap, share and blind zone of `calc limits` against a count of rays, on 12 rigs.

The count shares nothing with the package but the rig's numbers: rotations from three angles, lenses inverted
by bisection on the radius, a dense grid of pixels, each ray followed to the plane and into the other image.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory.limits import blind_zone_m, overlap_at_depth, overlap_fov_deg

GRID = (1280, 960)
BORDER = 1500
DEPTHS_M = (0.25, 1.0, 5.0)


class Lens(NamedTuple):
    """A camera: focal length and principal point px, radial k1 and k2."""

    width: int
    height: int
    f: float
    cx: float
    cy: float
    k1: float = 0.0
    k2: float = 0.0


class Case(NamedTuple):
    """A rig: the right camera turned by pitch, yaw and roll, deg, about x, y and z, and where it is."""

    name: str
    left: Lens
    right: Lens
    turned_deg: tuple[float, float, float]
    place_m: tuple[float, float, float]


SD = Lens(640, 480, 420.0, 319.5, 239.5)
HD = Lens(1280, 720, 900.0, 639.5, 359.5)
OFF = Lens(1280, 720, 900.0, 560.0, 400.0)
TELE = Lens(800, 600, 2200.0, 399.5, 299.5)
BARREL = Lens(1280, 960, 640.0, 650.0, 470.0, -0.17, 0.02)
CUSHION = Lens(1280, 960, 900.0, 630.0, 490.0, 0.18, 0.05)

CASES = (
    Case("side by side", HD, OFF, (0, 0, 0), (0.12, 0, 0)),
    Case("vertical", HD, HD, (0, 0, 0), (0, 0.12, 0)),
    Case("diagonal", SD, SD, (0, 0, 0), (0.08, 0.06, 0)),
    Case("rolled 90", HD, HD, (0, 0, 90), (0.12, 0, 0)),
    Case("rolled 180", OFF, OFF, (0, 0, 180), (0.12, 0, 0)),
    Case("pitched", HD, HD, (-18, 0, 0), (0, 0.15, 0)),
    Case("verged", SD, SD, (0, -25, 0), (0.3, 0, 0)),
    Case("turned about all axes", HD, SD, (9, -16, 33), (0.2, -0.05, 0.1)),
    Case("zoomed, ahead", SD, TELE, (2, -3, 0), (0.05, 0.02, 0.3)),
    Case("distorted", BARREL, BARREL, (0, 0, 0), (0.1, 0, 0)),
    Case("distorted, verged, unequal", BARREL, CUSHION, (3, -12, 5), (0.15, 0.02, -0.03)),
    Case("vertical chain", HD, HD, (0, 0, 0), (0, 1.5, 0)),
)


def turned(pitch: float, yaw: float, roll: float) -> Array:
    """Axes of the right camera in the left one's frame, as columns."""
    (cx, sx), (cy, sy), (cz, sz) = (
        (math.cos(math.radians(a)), math.sin(math.radians(a))) for a in (pitch, yaw, roll)
    )
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return np.asarray(about_y @ about_x @ about_z)


def rig_of(case: Case) -> StereoRig:
    """The same rig for the package."""
    lenses = [
        Intrinsics(
            lens.width, lens.height, lens.f, lens.f, lens.cx, lens.cy, BrownConrady(k1=lens.k1, k2=lens.k2)
        )
        for lens in (case.left, case.right)
    ]
    R = turned(*case.turned_deg).T
    return StereoRig(lenses[0], lenses[1], Pose(R, -R @ np.array(case.place_m)))


def fold2(lens: Lens) -> float:
    """Squared radius at which r (1 + k1 r^2 + k2 r^4) stops growing; infinite if it never does."""
    root = 9 * lens.k1**2 - 20 * lens.k2
    if root < 0 or (lens.k1 >= 0 and lens.k2 >= 0):
        return math.inf
    return 2 / (-3 * lens.k1 + math.sqrt(root))


def slopes(lens: Lens, u: Array, v: Array) -> Array:
    """Slopes (N, 2) of the rays of pixels, the lens inverted by bisection."""
    x, y = (u - lens.cx) / lens.f, (v - lens.cy) / lens.f
    radius = np.hypot(x, y)
    low, high = np.zeros_like(radius), np.full_like(radius, 2.5)
    # up to where the radius stops growing
    high = np.minimum(high, math.sqrt(fold2(lens)))
    for _ in range(45):
        middle = (low + high) / 2
        short = middle * (1 + lens.k1 * middle**2 + lens.k2 * middle**4) < radius
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    scale = np.where(radius > 0, low / np.where(radius > 0, radius, 1), 1.0)
    return np.column_stack([x * scale, y * scale])


def holds(lens: Lens, points: Array) -> Mask:
    """Whether the image shows points (N, 3) of its camera's frame."""
    z = points[:, 2]
    with np.errstate(all="ignore"):
        x, y = points[:, 0] / z, points[:, 1] / z
        r2 = x**2 + y**2
        grows = r2 < fold2(lens)
        scale = 1 + lens.k1 * r2 + lens.k2 * r2**2
        u, v = lens.f * x * scale + lens.cx, lens.f * y * scale + lens.cy
        inside = (abs(u - (lens.width - 1) / 2) <= lens.width / 2) & (
            abs(v - (lens.height - 1) / 2) <= lens.height / 2
        )
    return np.asarray((z > 0) & grows & inside)


def border(lens: Lens) -> Array:
    """Slopes of rays all around the image's edge, a hair inside."""
    t = np.linspace(0, 1, BORDER)
    u = np.concatenate([t, t, 0 * t, 0 * t + 1]) * lens.width
    v = np.concatenate([0 * t, 0 * t + 1, t, t]) * lens.height
    hair = 1e-9
    return slopes(lens, np.clip(u, hair, lens.width - hair) - 0.5, np.clip(v, hair, lens.height - hair) - 0.5)


def counted_blind_m(case: Case, grid: Array) -> float:
    """The least depth at which a ray of either image, at the border or inside, is seen by both."""
    axes, place = turned(*case.turned_deg), np.array(case.place_m)
    from_left = np.concatenate([grid, border(case.left)])
    rays_left = np.column_stack([from_left, np.ones(len(from_left))])
    out = border(case.right)
    rays_right = np.column_stack([out, np.ones(len(out))]) @ axes.T

    def any_seen(z: float) -> bool:
        if holds(case.right, (rays_left * z - place) @ axes).any():
            return True
        with np.errstate(all="ignore"):
            reach = (z - place[2]) / rays_right[:, 2]
        met = reach > 0
        return bool(holds(case.left, place + rays_right[met] * reach[met, None]).any())

    depths = np.geomspace(1e-3, 100, 400)
    first = next((i for i, z in enumerate(depths) if any_seen(z)), None)
    if first is None:
        return math.inf
    low, high = depths[max(first - 1, 0)], depths[first]
    for _ in range(30):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if any_seen(middle) else (middle, high)
    return float(high)


def run() -> None:
    """Print share, angle, extents and blind zone of each rig, and the worst differences."""
    print(
        f"share at Z = {', '.join(f'{z:g}' for z in DEPTHS_M)} m, % counted (told - counted); "
        "overlap far away, deg; blind zone, mm"
    )
    worst = dict.fromkeys(("share", "angle", "extent", "blind"), 0.0)
    for case in CASES:
        rig, axes, place = rig_of(case), turned(*case.turned_deg), np.array(case.place_m)
        left = case.left
        u, v = np.meshgrid(
            (np.arange(GRID[0]) + 0.5) / GRID[0] * left.width - 0.5,
            (np.arange(GRID[1]) + 0.5) / GRID[1] * left.height - 0.5,
        )
        grid = slopes(left, u.ravel(), v.ravel())
        rays = np.column_stack([grid, np.ones(len(grid))])
        told = []
        for z in DEPTHS_M:
            seen = holds(case.right, (rays * z - place) @ axes)
            overlap = overlap_at_depth(rig, z)
            off = 100 * (float(overlap.fraction) - seen.mean())
            worst["share"] = max(worst["share"], abs(off))
            told.append(f"{100 * seen.mean():6.2f} ({off:+.3f})")
            if seen.mean() > 0.01:
                for extent, slope in zip((overlap.width_m, overlap.height_m), grid[seen].T, strict=True):
                    worst["extent"] = max(worst["extent"], abs(float(extent) / (np.ptp(slope) * z) - 1) * 100)
        seen = holds(case.right, rays @ axes)
        angle = np.degrees(np.ptp(np.arctan(grid[seen, 0]))) if seen.any() else 0.0
        worst["angle"] = max(worst["angle"], abs(overlap_fov_deg(rig)[0] / angle - 1) * 100 if angle else 0.0)
        blind, counted = blind_zone_m(rig), counted_blind_m(case, grid[::7919])
        if math.isfinite(counted):
            worst["blind"] = max(worst["blind"], abs(blind / counted - 1) * 100)
        print(
            f"{case.name:28s}", *told, f"{angle:6.2f} ({overlap_fov_deg(rig)[0] - angle:+.3f})",
            f"{counted * 1e3:8.2f} ({(blind - counted) * 1e3:+.4f})",
        )  # fmt: skip
    print(
        f"worst: share {worst['share']:.3f} points, overlap angle {worst['angle']:.2f} %, extents "
        f"{worst['extent']:.2f} %, blind zone {worst['blind']:.3f} %"
    )
