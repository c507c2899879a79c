"""A rig and the points it sees, as shapes in space: x right, y forward, z up, in units of the picture.

The far end of the working range lies `REACH` units away, so that one place to look from suits every rig.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.present.live.colors import ColorScale, colors, scale_for
from rigsim.present.live.ink import round_step, ticks
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.calc.cloud import Cloud
from rigsim.theory.frusta import outline

REACH = 10.0
"""Units from the rig to the far end of its working range."""
_UPRIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""From a rig's axes (x right, y down, z forward) to those of the picture."""
_MARKS = 6


@dataclass(frozen=True, slots=True)
class CameraShape:
    """A camera with what it sees."""

    at: tuple[float, float, float]
    """Its centre."""
    turn: tuple[tuple[float, float, float], ...]
    """Rows of the rotation from its own axes to the picture's."""
    corners: tuple[tuple[float, float, float], ...]
    """Ends of its four outermost rays, in its own axes."""


@dataclass(frozen=True, slots=True, eq=False)
class PointShapes:
    """Points with ellipsoids."""

    at: Array
    """Centres (N, 3)."""
    half_axes: Array
    """Half axes (N, 3) of the ellipsoids, not exaggerated."""
    turns: Array
    """Their rotations (N, 3, 3)."""
    colors: list[str]
    """Colour of each, by the standard deviation of its depth."""
    scale: ColorScale | None
    """What colours mean, mm."""


def camera_shapes(rig: StereoRig, far_m: float) -> tuple[CameraShape, CameraShape]:
    """Both cameras, with frusta to the far end of the working range."""
    left = rig.rig_from_left
    right = left @ rig.right_from_left.inverse
    return _camera(rig.left, left, far_m), _camera(rig.right, right, far_m)


def _camera(lens: Intrinsics, rig_from_camera: Pose, far_m: float) -> CameraShape:
    rays = outline(lens)
    corners = rays[:: max(len(rays) // 4, 1)][:4] * REACH
    at, turn = _UPRIGHT @ rig_from_camera.t * (REACH / far_m), _UPRIGHT @ rig_from_camera.R
    return CameraShape(
        _triple(at), tuple(_triple(row) for row in turn), tuple(_triple(row) for row in corners)
    )


def point_shapes(rig: StereoRig, seen: Cloud, far_m: float) -> PointShapes:
    """The points with their ellipsoids, coloured by the error of their depth."""
    rig_from_left = rig.rig_from_left
    upright = _UPRIGHT @ rig_from_left.R
    at = rig_from_left.apply(seen.points_left) @ _UPRIGHT.T * (REACH / far_m)
    scale = scale_for(seen.std_mm[:, 2])
    shades = [] if scale is None else colors(seen.std_mm[:, 2], scale)
    return PointShapes(at, seen.half_axes_m * (REACH / far_m), upright @ seen.turns, shades, scale)


def depth_marks(far_m: float) -> list[tuple[float, str]]:
    """Places ahead in units of the picture, and what stands there."""
    step = round_step(far_m / _MARKS)
    unit, per_m = ("mm", 1e3) if far_m < 1.0 else ("m", 1.0)
    return [(z * REACH / far_m, f"{z * per_m:g} {unit}") for z in ticks(step, far_m * 1.0001, step)]


def _triple(values: Array) -> tuple[float, float, float]:
    x, y, z = (round(float(value), 6) for value in values)
    return x, y, z
