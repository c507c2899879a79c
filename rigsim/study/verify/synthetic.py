"""Cases without a scene: pixels of points all over the view of a rig of `geometries`."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.saying import saying
from rigsim.study.verify.case import Case
from rigsim.study.verify.geometries import GEOMETRIES, Geometry
from rigsim.theory.uncertainty import parallax_px

_BATCH = 4096
_PATIENCE = 50  # batches
_LEAST_SHARE = 1e-3


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
        saying("noisy", geometry=geometry.about, noise_px=geometry.noise_px),
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
        saying("behind"),
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
        saying("identical images"),
        parallel.rig,
        uv_left,
        uv_left,
        nowhere,
    )
    yield Case(
        "swapped images",
        "nowhere",
        "nowhere",
        saying("swapped images"),
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
        about=saying("missing pixels"),
        uv_right=np.where(lost[:, None], np.nan, whole.uv_right),
        points_left=np.where(lost[:, None], np.nan, whole.points_left),
    )
    for size, name in ((0, "no pixels"), (1, "one pixel pair")):
        yield replace(exact(verged, size, rng), name=name, group="rows", about=saying(name))


def special_rows(many: int, rng: np.random.Generator) -> Iterator[Case]:
    """Rows that formulas stumble over: pixels on the principal points and axes, and very many rows."""
    by_name = {geometry.name: geometry for geometry in GEOMETRIES}
    verged = by_name["verged"]
    lens = replace(verged.rig.left, cx=640.0, cy=360.0)  # that doubles hold exactly
    geometry = replace(verged, rig=StereoRig(lens, lens, verged.rig.right_from_left))
    rig = geometry.rig
    along_right = np.linspace(*verged.range_m, 5)[:, None] * (0.0, 0.0, 1.0)
    points_left = np.concatenate(
        [
            np.linspace(*verged.range_m, 5)[:, None] * (0.0, 0.0, 1.0),
            rig.right_from_left.inverse.apply(along_right),
        ]
    )
    on_one_axis = visible_points(geometry, 10, rng)
    on_one_axis[:5, 0] = on_one_axis[5:, 1] = 0.0
    points_left = np.concatenate([points_left, on_one_axis])
    uv_left, uv_right = rig.project(points_left)
    seen = rig.left.contains(uv_left) & rig.right.contains(uv_right)
    uv_left[:5] = uv_right[5:10] = lens.cx, lens.cy
    uv_left[10:15, 0], uv_left[15:, 1] = lens.cx, lens.cy
    yield Case(
        "on the axes",
        "rows",
        "exact",
        saying("on the axes"),
        rig,
        uv_left[seen],
        uv_right[seen],
        points_left[seen],
    )
    yield replace(
        exact(by_name["unequal"], many, rng),
        name="many rows",
        group="rows",
        about=saying("many rows"),
    )


def _mirrored(rig: StereoRig, points_left: Array) -> tuple[Array, Array]:
    """Pixels of the points mirrored through each camera's own ideal pinhole: lines that meet behind."""
    pixels = []
    for lens, points in ((rig.left, -points_left), (rig.right, rig.right_from_left.apply(-points_left))):
        pixels.append(lens.denormalize(points[:, :2] / points[:, 2:]))
    return pixels[0], pixels[1]
