"""Cases without a scene: rigs of every kind that triangulators get wrong, and points all over their view."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array
from rigsim.rig.distortion import BrownConrady
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.verify.case import Case
from rigsim.theory.uncertainty import parallax_px

_BATCH = 4096
_PATIENCE = 50  # batches
_LEAST_SHARE = 1e-3


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
)
"""One geometry for each thing that goes wrong."""


def visible_points(geometry: Geometry, n: int, rng: np.random.Generator) -> Array:
    """Points (n, 3) m that both cameras have in view, even over the left image and over log depth.

    Raises:
        InvalidRange: the two views hardly meet at those depths.
    """
    rig, (near_m, far_m) = geometry.rig, geometry.range_m
    kept: list[Array] = []
    found = 0
    for batch in itertools.count(1):
        uv = -0.5 + rng.random((_BATCH, 2)) * (rig.left.width, rig.left.height)
        depth_m = np.exp(rng.uniform(math.log(near_m), math.log(far_m), _BATCH))
        points = np.column_stack([rig.left.normalize(uv), np.ones(_BATCH)]) * depth_m[:, None]
        uv_left, uv_right = rig.project(points)
        seen = rig.left.contains(uv_left) & rig.right.contains(uv_right)
        seen[seen] = parallax_px(rig, points[seen]) >= geometry.least_parallax_px
        kept.append(points[seen])
        found += int(seen.sum())
        if found >= n:
            break
        if batch >= _PATIENCE and found < _LEAST_SHARE * batch * _BATCH:
            raise InvalidRange(
                f"rig {geometry.name!r}: the right camera sees less than {_LEAST_SHARE:.1%} of what the left "
                f"one sees at {near_m:.3g} to {far_m:.3g} m; turn the cameras towards each other"
            )
    return np.concatenate(kept)[:n]


def exact(geometry: Geometry, n: int, rng: np.random.Generator) -> Case:
    """The case of exact projections."""
    points_left = visible_points(geometry, n, rng)
    uv_left, uv_right = geometry.rig.project(points_left)
    return Case(
        f"{geometry.name} exact",
        geometry.name,
        "exact",
        geometry.about,
        geometry.rig,
        uv_left,
        uv_right,
        points_left,
    )


def noisy(geometry: Geometry, n: int, rng: np.random.Generator) -> Case:
    """The case of projections with Gaussian noise in every coordinate."""
    points_left = visible_points(geometry, n, rng)
    noise = PixelNoise(geometry.noise_px)
    uv_left, uv_right = noise.apply(*geometry.rig.project(points_left), rng)
    return Case(
        f"{geometry.name} noisy",
        geometry.name,
        "noisy",
        f"{geometry.about} With {geometry.noise_px:g} px of noise in every coordinate, errors must be of the "
        "size that it causes.",
        geometry.rig,
        uv_left,
        uv_right,
        points_left,
        noise.covariance_px2,
    )


def degenerate(n: int, rng: np.random.Generator) -> Iterator[Case]:
    """Pixels without an answer: behind the cameras, at infinity, swapped or missing; none, and one alone."""
    by_name = {geometry.name: geometry for geometry in GEOMETRIES}
    parallel, verged = by_name["rectified"], by_name["verged"]
    nowhere = np.full((n, 3), np.nan)

    uv_left, uv_right = _mirrored(verged.rig, visible_points(verged, n, rng))
    yield Case(
        "behind",
        "nowhere",
        "nowhere",
        "Lines of sight that meet behind the cameras: there is no point to be seen.",
        verged.rig,
        uv_left,
        uv_right,
        nowhere,
    )
    uv_left, uv_right = parallel.rig.project(visible_points(parallel, n, rng))
    yield Case(
        "identical images",
        "nowhere",
        "nowhere",
        "The left image twice: parallel lines of sight meet at infinity.",
        parallel.rig,
        uv_left,
        uv_left,
        nowhere,
    )
    yield Case(
        "swapped images",
        "nowhere",
        "nowhere",
        "Left image given as the right one: every disparity is negative, so nothing lies in front.",
        parallel.rig,
        uv_right,
        uv_left,
        nowhere,
    )
    whole = exact(verged, n, rng)
    lost = np.arange(n) % 3 == 1
    yield replace(
        whole,
        name="missing pixels",
        group="rows",
        about="Every third right pixel is NaN: those rows must be NaN, and the others must not move.",
        uv_right=np.where(lost[:, None], np.nan, whole.uv_right),
        points_left=np.where(lost[:, None], np.nan, whole.points_left),
    )
    for size, name, about in (
        (0, "no pixels", "No pixels at all: the answer has shape (0, 3)."),
        (1, "one pixel pair", "A single row: the answer has shape (1, 3)."),
    ):
        yield replace(exact(verged, size, rng), name=name, group="rows", about=about)


def random_geometry(number: int, rng: np.random.Generator) -> Geometry:
    """A rig nobody would think of: unequal lenses, any turn up to 15 deg, any direction of the baseline."""

    def lens() -> Intrinsics:
        width, height = int(rng.integers(800, 1600)), int(rng.integers(600, 1200))
        fx = width * rng.uniform(0.7, 1.2)
        cx, cy = (side * rng.uniform(0.4, 0.6) for side in (width, height))
        bent = BrownConrady(k1=rng.uniform(-0.1, 0.05), p1=rng.uniform(-1e-3, 1e-3)) if number % 2 else None
        return Intrinsics(width, height, fx, fx * rng.uniform(0.9, 1.1), cx, cy, bent)

    direction = rng.standard_normal(3)
    centre = rng.uniform(0.1, 0.3) * direction / np.linalg.norm(direction)
    turn = Pose.from_rotvec(np.radians(rng.uniform(-9, 9, 3)), centre)
    return Geometry(
        f"random {number}",
        StereoRig(lens(), lens(), turn.inverse),
        (0.8, 4.0),
        "A rig drawn at random: lenses, rotation and direction of the baseline.",
        least_parallax_px=8.0,
    )


def _mirrored(rig: StereoRig, points_left: Array) -> tuple[Array, Array]:
    """Pixels of the points mirrored through each camera's own ideal pinhole: lines that meet behind."""
    pixels = []
    for lens, points in ((rig.left, -points_left), (rig.right, rig.right_from_left.apply(-points_left))):
        pixels.append(lens.denormalize(points[:, :2] / points[:, 2:]))
    return pixels[0], pixels[1]
