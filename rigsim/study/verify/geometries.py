"""Rigs of every kind that triangulators get wrong: directions, turns, sizes and lenses."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.saying import Saying, saying


@dataclass(frozen=True, slots=True)
class Geometry:
    """A rig, the depths it is tried at, and what goes wrong there."""

    name: str
    """Short, as ``verged``."""
    rig: StereoRig
    """The rig."""
    range_m: tuple[float, float]
    """Nearest and farthest depth, m."""
    noise_px: float = 0.25
    """Standard deviation per coordinate of the noisy case, px."""
    least_parallax_px: float = 0.0
    """Least parallax of a point, px: what moves along an epipolar line by less is not asked for."""
    kind: str = ""
    """What it shows, where that is not in its name: ``random``."""

    @property
    def about(self) -> Saying:
        """What it shows."""
        return saying(self.kind or self.name)


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
    ),
    Geometry(
        "doffs",
        StereoRig.rectified(_HD, 0.12, right=replace(_HD, cx=_HD.cx + 37.5)),
        (0.5, 8.0),
    ),
    Geometry(
        "off-centre",
        StereoRig.rectified(Intrinsics(1280, 720, 900.0, 900.0, 560.25, 420.75), 0.12),
        (0.5, 8.0),
    ),
    Geometry(
        "non-square",
        StereoRig.rectified(Intrinsics(1280, 720, 960.0, 720.0, 639.5, 359.5), 0.12),
        (0.5, 8.0),
    ),
    Geometry(
        "near",
        StereoRig.rectified(Intrinsics.from_focal(1280, 960, 700.0), 0.06),
        (0.08, 0.3),
    ),
    Geometry(
        "far",
        StereoRig.rectified(Intrinsics.from_focal(1920, 1080, 1400.0), 0.10),
        (40.0, 1200.0),
        noise_px=0.01,
    ),
    Geometry(
        "verged",
        StereoRig.verged(_HD, 0.30, 20.0),
        (0.5, 2.5),
    ),
    Geometry(
        "rolled",
        StereoRig(_HD, _HD, _turned((9.0, -6.0, 14.0), (0.20, 0.05, -0.08))),
        (0.6, 4.0),
    ),
    Geometry(
        "vertical",
        StereoRig(_HD, _HD, _turned((0.0, 0.0, 0.0), (0.0, 0.15, 0.0))),
        (0.5, 6.0),
    ),
    Geometry(
        "forward",
        StereoRig(_HD, _HD, _turned((1.0, 2.0, -1.0), (0.03, -0.02, 0.35))),
        (1.0, 5.0),
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
    ),
    Geometry(
        "distorted",
        StereoRig(
            replace(_HD, lens=BrownConrady(k1=-0.18, k2=0.05, p1=0.0012, p2=-0.0008, k3=-0.006)),
            replace(_HD, lens=BrownConrady(k1=-0.12, k2=0.02, p1=-0.0006, p2=0.0015)),
            _turned((0.4, -2.0, 0.8), (0.15, 0.004, -0.006)),
        ),
        (0.5, 5.0),
    ),
    Geometry(
        "pincushion",
        StereoRig(
            replace(_HD, lens=BrownConrady(k1=0.11, k2=-0.02, p1=-0.0009, p2=0.0011)),
            replace(_HD, lens=BrownConrady(k1=0.08, k3=0.004)),
            _turned((-0.6, 1.0, -0.4), (0.14, 0.003, 0.005)),
        ),
        (0.5, 5.0),
    ),
    Geometry(
        "toe-out",
        StereoRig.verged(_HD, 0.30, -12.0),
        (1.0, 6.0),
    ),
    Geometry(
        "convergent",
        StereoRig(_HD, _HD, _aimed((1.5, 0.1, 0.6), (0.05, 0.0, 1.6), roll_deg=4.0)),
        (1.0, 2.4),
    ),
    Geometry(
        "from the side",
        StereoRig(_HD, _HD, _aimed((-2.0, -0.15, 2.1), (0.0, 0.0, 2.0), roll_deg=-7.0)),
        (1.4, 2.8),
    ),
    Geometry(
        "left-handed",
        StereoRig(_HD, _HD, _turned((0.5, -1.0, 0.8), (-0.18, 0.01, -0.01))),
        (0.6, 5.0),
    ),
    Geometry(
        "upside-down",
        StereoRig(_HD, _HD, _turned((1.0, -2.0, 172.0), (0.2, 0.03, -0.02))),
        (0.6, 5.0),
    ),
    Geometry(
        "on its side",
        StereoRig(_HD, replace(_HD, width=720, height=1280), _turned((-1.0, 2.0, 93.0), (0.15, 0.06, 0.01))),
        (0.6, 5.0),
    ),
    Geometry(
        "portrait",
        StereoRig.rectified(Intrinsics(720, 1280, 880.0, 940.0, 371.5, 610.25), 0.10),
        (0.4, 6.0),
    ),
    Geometry(
        "diagonal",
        StereoRig(_HD, _HD, _turned((0.0, 0.0, 0.0), (0.11, -0.13, 0.0))),
        (0.5, 6.0),
    ),
    Geometry(
        "backward",
        StereoRig(_HD, _HD, _turned((-1.0, -1.5, 2.0), (-0.04, 0.03, -0.4))),
        (1.0, 5.0),
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
    ),
    Geometry(
        "wide",
        StereoRig(
            Intrinsics.from_focal(1280, 960, 400.0),
            Intrinsics.from_focal(1280, 960, 405.0),
            _turned((0.3, 1.5, -0.5), (0.10, 0.0, 0.0)),
        ),
        (0.2, 3.0),
    ),
    Geometry(
        "close-up",
        StereoRig(
            Intrinsics.from_focal(1280, 960, 1800.0),
            Intrinsics.from_focal(1280, 960, 1800.0),
            _turned((0.0, -4.0, 0.0), (0.002, 0.0, 0.0)),
        ),
        (0.012, 0.05),
    ),
    Geometry(
        "aerial",
        StereoRig(
            Intrinsics.from_focal(2000, 1500, 2600.0),
            Intrinsics.from_focal(2000, 1500, 2600.0),
            _turned((0.6, -0.9, 1.2), (42.0, 1.5, -2.0)),
        ),
        (250.0, 2000.0),
    ),
    Geometry(
        "remote",
        StereoRig(
            Intrinsics.from_focal(1920, 1080, 5200.0),
            Intrinsics.from_focal(1920, 1080, 5200.0),
            _turned((0.02, -0.05, 0.03), (3.0, 0.0, 0.02)),
        ),
        (1500.0, 15_000.0),
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
        least_parallax_px=8.0,
        kind="random",
    )
