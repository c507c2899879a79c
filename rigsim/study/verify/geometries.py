"""Rigs of every kind that triangulators get wrong: directions, turns, sizes and lenses."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig


@dataclass(frozen=True, slots=True)
class Geometry:
    """A rig, the depths it is tried at, and what goes wrong there."""

    name: str
    """Short, as ``verged``."""
    rig: StereoRig
    """The rig."""
    range_m: tuple[float, float]
    """Nearest and farthest depth, m."""
    about: str
    """What it shows, one sentence."""
    noise_px: float = 0.25
    """Standard deviation per coordinate of the noisy case, px."""
    least_parallax_px: float = 0.0
    """Least parallax of a point, px: what moves along an epipolar line by less is not asked for."""


def _turned(rotation_deg: tuple[float, float, float], centre_right_m: tuple[float, float, float]) -> Pose:
    """right_from_left of a right camera at a place in the left frame, turned by a rotation vector."""
    left_from_right = Pose.from_rotvec(np.radians(rotation_deg), centre_right_m)
    return left_from_right.inverse


def _aimed(
    centre_right_m: tuple[float, float, float], target_m: tuple[float, float, float], roll_deg: float = 0.0
) -> Pose:
    """right_from_left of a right camera at a place in the left frame that looks at a point, rows level but
    for a roll about its axis."""
    ahead = np.subtract(target_m, centre_right_m)
    ahead /= np.linalg.norm(ahead)
    across = np.cross((0.0, 1.0, 0.0), ahead)
    across /= np.linalg.norm(across)
    level = np.stack([across, np.cross(ahead, across), ahead])
    R = Pose.from_rotvec(np.radians((0.0, 0.0, roll_deg)), (0.0, 0.0, 0.0)).R @ level
    return Pose(R, -R @ np.asarray(centre_right_m))


_HD = Intrinsics.from_focal(1280, 720, 900.0)

GEOMETRIES: tuple[Geometry, ...] = (
    Geometry(
        "rectified",
        StereoRig.rectified(_HD, 0.12),
        (0.5, 8.0),
        "Parallel cameras, equal lenses: Z = f B / d, in the left camera's frame.",
    ),
    Geometry(
        "doffs",
        StereoRig.rectified(_HD, 0.12, right=replace(_HD, cx=_HD.cx + 37.5)),
        (0.5, 8.0),
        "Rectified, but the principal points differ: doffs must be added to every disparity.",
    ),
    Geometry(
        "off-centre",
        StereoRig.rectified(Intrinsics(1280, 720, 900.0, 900.0, 560.25, 420.75), 0.12),
        (0.5, 8.0),
        "The principal point is not the middle of the image.",
    ),
    Geometry(
        "non-square",
        StereoRig.rectified(Intrinsics(1280, 720, 960.0, 720.0, 639.5, 359.5), 0.12),
        (0.5, 8.0),
        "Pixels that are not square: fx and fy differ.",
    ),
    Geometry(
        "near",
        StereoRig.rectified(Intrinsics.from_focal(1280, 960, 700.0), 0.06),
        (0.08, 0.3),
        "So near that the disparity is half the image.",
    ),
    Geometry(
        "far",
        StereoRig.rectified(Intrinsics.from_focal(1920, 1080, 1400.0), 0.10),
        (40.0, 1200.0),
        "So far that the disparity is a tenth of a pixel: single precision and clamps show here.",
        noise_px=0.01,
    ),
    Geometry(
        "verged",
        StereoRig.verged(_HD, 0.30, 20.0),
        (0.5, 2.5),
        "Cameras that toe in by 20 deg: rows do not correspond, and Z = f B / d does not hold.",
    ),
    Geometry(
        "rolled",
        StereoRig(_HD, _HD, _turned((9.0, -6.0, 14.0), (0.20, 0.05, -0.08))),
        (0.6, 4.0),
        "The right camera turned about all axes and off the x axis: R, its transpose and its inverse differ.",
    ),
    Geometry(
        "vertical",
        StereoRig(_HD, _HD, _turned((0.0, 0.0, 0.0), (0.0, 0.15, 0.0))),
        (0.5, 6.0),
        "One camera below the other: the parallax lies along v.",
    ),
    Geometry(
        "forward",
        StereoRig(_HD, _HD, _turned((1.0, 2.0, -1.0), (0.03, -0.02, 0.35))),
        (1.0, 5.0),
        "The second camera ahead of the first: parallax grows away from the epipole in the picture.",
        least_parallax_px=8.0,
    ),
    Geometry(
        "unequal",
        StereoRig(
            Intrinsics(1280, 960, 1100.0, 1085.0, 610.0, 500.0),
            Intrinsics(800, 600, 520.0, 531.0, 420.5, 287.25),
            _turned((0.5, -3.0, 1.0), (0.18, -0.01, 0.02)),
        ),
        (0.6, 5.0),
        "Two different cameras: each pixel belongs with its own K.",
    ),
    Geometry(
        "distorted",
        StereoRig(
            replace(_HD, distortion=BrownConrady(k1=-0.18, k2=0.05, p1=0.0012, p2=-0.0008, k3=-0.006)),
            replace(_HD, distortion=BrownConrady(k1=-0.12, k2=0.02, p1=-0.0006, p2=0.0015)),
            _turned((0.4, -2.0, 0.8), (0.15, 0.004, -0.006)),
        ),
        (0.5, 5.0),
        "Lenses that distort, each its own way: pixels are as they were seen and must be undistorted once.",
    ),
    Geometry(
        "pincushion",
        StereoRig(
            replace(_HD, distortion=BrownConrady(k1=0.11, k2=-0.02, p1=-0.0009, p2=0.0011)),
            replace(_HD, distortion=BrownConrady(k1=0.08, k3=0.004)),
            _turned((-0.6, 1.0, -0.4), (0.14, 0.003, 0.005)),
        ),
        (0.5, 5.0),
        "Lenses that bend outwards: the signs of all terms are the other way round.",
    ),
    Geometry(
        "toe-out",
        StereoRig.verged(_HD, 0.30, -12.0),
        (1.0, 6.0),
        "Cameras that turn away from each other: infinity has a disparity below zero.",
    ),
    Geometry(
        "convergent",
        StereoRig(_HD, _HD, _aimed((1.5, 0.1, 0.6), (0.05, 0.0, 1.6), roll_deg=4.0)),
        (1.0, 2.4),
        "Cameras that look at one place from two sides, turned by more than 50 deg against each other.",
    ),
    Geometry(
        "from the side",
        StereoRig(_HD, _HD, _aimed((-2.0, -0.15, 2.1), (0.0, 0.0, 2.0), roll_deg=-7.0)),
        (1.4, 2.8),
        "The second camera looks in from the left, at right angles.",
    ),
    Geometry(
        "left-handed",
        StereoRig(_HD, _HD, _turned((0.5, -1.0, 0.8), (-0.18, 0.01, -0.01))),
        (0.6, 5.0),
        "The right camera stands on the left side: disparities are negative, depths are not.",
    ),
    Geometry(
        "upside-down",
        StereoRig(_HD, _HD, _turned((1.0, -2.0, 172.0), (0.2, 0.03, -0.02))),
        (0.6, 5.0),
        "The right camera hangs upside down: its pixels run the other way.",
    ),
    Geometry(
        "on its side",
        StereoRig(_HD, replace(_HD, width=720, height=1280), _turned((-1.0, 2.0, 93.0), (0.15, 0.06, 0.01))),
        (0.6, 5.0),
        "The right camera stands on its side, its pictures are upright.",
    ),
    Geometry(
        "portrait",
        StereoRig.rectified(Intrinsics(720, 1280, 880.0, 940.0, 371.5, 610.25), 0.10),
        (0.4, 6.0),
        "Upright pictures with pixels that are not square.",
    ),
    Geometry(
        "diagonal",
        StereoRig(_HD, _HD, _turned((0.0, 0.0, 0.0), (0.11, -0.13, 0.0))),
        (0.5, 6.0),
        "One camera above the other and beside it: the parallax lies along both axes.",
    ),
    Geometry(
        "backward",
        StereoRig(_HD, _HD, _turned((-1.0, -1.5, 2.0), (-0.04, 0.03, -0.4))),
        (1.0, 5.0),
        "The second camera behind the first.",
        least_parallax_px=8.0,
    ),
    Geometry(
        "alike",
        StereoRig(
            _HD,
            Intrinsics(1280, 720, 917.5, 913.0, 633.25, 364.5),
            _turned((0.2, -0.7, 0.3), (0.12, -0.002, 0.003)),
        ),
        (0.5, 6.0),
        "Two lenses of one kind, 2 % apart, and cameras turned by less than a degree.",
    ),
    Geometry(
        "wide",
        StereoRig(
            Intrinsics.from_focal(1280, 960, 400.0),
            Intrinsics.from_focal(1280, 960, 405.0),
            _turned((0.3, 1.5, -0.5), (0.10, 0.0, 0.0)),
        ),
        (0.2, 3.0),
        "A field of view of 116 deg: rays up to 63 deg off the axis.",
    ),
    Geometry(
        "close-up",
        StereoRig(
            Intrinsics.from_focal(1280, 960, 1800.0),
            Intrinsics.from_focal(1280, 960, 1800.0),
            _turned((0.0, -4.0, 0.0), (0.002, 0.0, 0.0)),
        ),
        (0.012, 0.05),
        "A rig of 2 mm that looks at 12 to 50 mm: what is small in metres is not small here.",
    ),
    Geometry(
        "aerial",
        StereoRig(
            Intrinsics.from_focal(2000, 1500, 2600.0),
            Intrinsics.from_focal(2000, 1500, 2600.0),
            _turned((0.6, -0.9, 1.2), (42.0, 1.5, -2.0)),
        ),
        (250.0, 2000.0),
        "Pictures from two places of an aircraft, 42 m apart.",
    ),
    Geometry(
        "remote",
        StereoRig(
            Intrinsics.from_focal(1920, 1080, 5200.0),
            Intrinsics.from_focal(1920, 1080, 5200.0),
            _turned((0.02, -0.05, 0.03), (3.0, 0.0, 0.02)),
        ),
        (1500.0, 15_000.0),
        "Points kilometres away, seen by a rig of 3 m through long lenses.",
        noise_px=0.02,
    ),
)
"""One geometry for each thing that goes wrong."""


def random_geometry(number: int, rng: np.random.Generator) -> Geometry:
    """A rig nobody would think of: unequal lenses, any direction and length of the baseline; every second
    one is turned by up to 15 deg, the others look at one place from any two sides."""

    def lens() -> Intrinsics:
        width, height = int(rng.integers(800, 1600)), int(rng.integers(600, 1200))
        fx = width * rng.uniform(0.7, 1.2)
        cx, cy = (side * rng.uniform(0.4, 0.6) for side in (width, height))
        bent = BrownConrady(k1=rng.uniform(-0.1, 0.05), p1=rng.uniform(-1e-3, 1e-3)) if number % 2 else None
        return Intrinsics(width, height, fx, fx * rng.uniform(0.9, 1.1), cx, cy, bent)

    direction = rng.standard_normal(3)
    direction /= np.linalg.norm(direction)
    size = 10 ** rng.uniform(-1.5, 1.5)  # 30 mm to 30 m stand for a metre
    if number % 2:
        centre = rng.uniform(0.1, 0.3) * size * direction
        pose = Pose.from_rotvec(np.radians(rng.uniform(-9, 9, 3)), centre).inverse
    else:
        x, y, z = rng.uniform(0.5, 1.5) * size * direction
        centre = np.array([x, y, min(z, 0.5 * size)])  # not among the points
        target = size * np.array([*rng.uniform(-0.1, 0.1, 2), 2.0])
        roll_deg = rng.uniform(-180, 180)
        pose = _aimed((centre[0], centre[1], centre[2]), (target[0], target[1], target[2]), roll_deg)
    return Geometry(
        f"random {number}",
        StereoRig(lens(), lens(), pose),
        (0.8 * size, 4.0 * size),
        "A rig drawn at random: lenses, size, rotation and direction of the baseline.",
        least_parallax_px=8.0,
    )
