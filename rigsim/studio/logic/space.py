"""What stands in the scene in space."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rigsim.present.kit.format import number, with_error
from rigsim.present.live.space import CameraShape, PointShapes, camera_shapes, point_shapes
from rigsim.rig.arrays import Array
from rigsim.studio.logic.numbers import RigNumbers
from rigsim.study.calc.cloud import Cloud, cloud, walls

NEAREST_SHARE = 1.3
"""Points farther than this many working ranges are left out of the picture."""


@dataclass(frozen=True, slots=True, eq=False)
class Space:
    """Cameras, and points that both see."""

    far_m: float
    """Far end of the working range, m."""
    cameras: tuple[CameraShape, CameraShape]
    """The left and the right camera."""
    cloud: Cloud
    """The points, and what is known of them."""
    shapes: PointShapes
    """How they look."""


def cameras_of(found: RigNumbers) -> tuple[float, tuple[CameraShape, CameraShape]] | None:
    """The far end, m, and both cameras: quick enough to follow a hand; None for no rig."""
    if found.shown is None or found.distances is None:
        return None
    far_m = found.distances.far_m
    return far_m, camera_shapes(found.shown.rig, far_m)


def space_of(found: RigNumbers, points_left: Array | None) -> Space | None:
    """Everything; None for no rig.

    Args:
        found: the numbers.
        points_left: points (N, 3) m of the scene; None for walls over the working range.
    """
    cameras = cameras_of(found)
    if cameras is None or found.shown is None or found.distances is None:
        return None
    rig, far_m = found.shown.rig, found.distances.far_m
    if points_left is None:
        points_left = walls(rig, found.distances.near_m, far_m)
    seen = cloud(rig, found.shown.noise, points_left[points_left[:, 2] <= NEAREST_SHARE * far_m])
    return Space(far_m, cameras[1], seen, point_shapes(rig, seen, far_m))


def told(seen: Cloud, index: int) -> Mapping[str, tuple[str, str]]:
    """What is known of one point, by name: value and unit."""
    point, std = seen.points_left[index] * 1e3, seen.std_mm[index]
    left, right = seen.uv_left[index], seen.uv_right[index]
    axes = {
        f"{name} ± std": (with_error(float(value), float(error)), "mm")
        for name, value, error in zip("XYZ", point, std, strict=True)
    }
    pixels = {
        f"{name} pixel": (f"{number(float(uv[0]), 5)}, {number(float(uv[1]), 5)}", "px")
        for name, uv in (("left", left), ("right", right))
    }
    return {**axes, **pixels}
