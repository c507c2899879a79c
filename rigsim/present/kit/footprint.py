"""The rig seen from above: where the cameras stand and what they see, as plane geometry.

Everything is in the rig's frame (`StereoRig.rig_from_left`: origin in the middle of the baseline) and
keeps two of its axes, (x, z): x right and z forward, m.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

_FAR_BASELINES = 1e5
_WIDEST_DEG = 89.0


@dataclass(frozen=True, slots=True)
class CameraView:
    """One camera seen from above."""

    center: Array
    """Camera centre (x, z), (2,), m."""
    axis: Array
    """Unit direction (x, z) of the optical axis."""
    left_edge: Array
    """Unit direction (x, z) of the leftmost ray, counter-clockwise of the axis on paper."""
    right_edge: Array
    """Unit direction (x, z) of the rightmost ray."""

    def clip(self, polygon: Array) -> Array:
        """The part (M, 2) of a convex polygon (N, 2) that this camera sees; (0, 2) when it sees none."""
        # inside lies clockwise of the left edge and counter-clockwise of the right one
        polygon = _clip_half_plane(polygon, self.center, _quarter_turn(-self.left_edge))
        return _clip_half_plane(polygon, self.center, _quarter_turn(self.right_edge))

    def sees(self, points_xz: Array) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        """Whether points (N, 2) lie between the two edges, (N,)."""
        offset = points_xz - self.center
        return np.asarray(
            (offset @ _quarter_turn(-self.left_edge) >= 0) & (offset @ _quarter_turn(self.right_edge) >= 0)
        )


@dataclass(frozen=True, slots=True)
class Footprint:
    """Both cameras seen from above."""

    left: CameraView
    """Left camera."""
    right: CameraView
    """Right camera."""
    nearest: Array | None
    """Nearest point (x, z), (2,), m, in front of the rig that both cameras see; None when there is none."""

    @property
    def blind(self) -> Array | None:
        """Triangle (3, 2) m between the cameras and `nearest` that neither camera sees."""
        if self.nearest is None:
            return None
        triangle = np.stack([self.left.center, self.right.center, self.nearest])
        middle = triangle.mean(axis=0, keepdims=True)
        seen = bool(self.left.sees(middle)[0] or self.right.sees(middle)[0])
        return None if seen or self.nearest[1] <= 0 else triangle

    def overlap(self, polygon: Array) -> Array:
        """The part (M, 2) of a convex polygon (N, 2) that both cameras see."""
        return self.right.clip(self.left.clip(polygon))


def footprint(rig: StereoRig) -> Footprint:
    """The rig seen from above."""
    rig_from_left = rig.rig_from_left
    left = _view(rig.left, rig_from_left)
    right = _view(rig.right, rig_from_left @ rig.right_from_left.inverse)
    far = _FAR_BASELINES * rig.baseline_m
    both = right.clip(left.clip(np.array([[-far, 0.0], [far, 0.0], [far, far], [-far, far]])))
    nearest = both[np.argmin(both[:, 1])] if len(both) else None
    return Footprint(left, right, nearest)


def _view(lens: Intrinsics, rig_from_camera: Pose) -> CameraView:
    """A camera from above; the edges enclose the rays of the whole image border."""
    u = np.array([-0.5, lens.cx, lens.width - 0.5])
    v = np.array([-0.5, lens.cy, lens.height - 0.5])
    border = np.array([(a, b) for a in u for b in v if not (a == lens.cx and b == lens.cy)])
    rays = lens.normalize(border)
    ideal = (border - (lens.cx, lens.cy)) / (lens.fx, lens.fy)
    rays = np.where(np.isfinite(rays), rays, ideal)
    rays = np.column_stack([rays, np.ones(len(rays))]) @ rig_from_camera.R.T

    axis = _unit(rig_from_camera.R[[0, 2], 2])
    # angle of each ray to the right of the axis, as seen from above
    across = rays[:, 0] * axis[1] - rays[:, 2] * axis[0]
    along = rays[:, 0] * axis[0] + rays[:, 2] * axis[1]
    angle = np.arctan2(across, along)
    if lens.is_wide:
        # a wedge is less than a half plane
        angle = np.radians(np.clip(lens.edge_angles_deg(0), -_WIDEST_DEG, _WIDEST_DEG))
    return CameraView(rig_from_camera.t[[0, 2]], axis, _turned(axis, angle.min()), _turned(axis, angle.max()))


def _turned(direction: Array, angle_rad: float) -> Array:
    """`direction` (x, z) turned to the right, clockwise on paper."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return np.array([c * direction[0] + s * direction[1], c * direction[1] - s * direction[0]])


def _unit(vector: Array) -> Array:
    norm = float(np.linalg.norm(vector))
    return vector / norm if norm > 1e-9 else np.array([0.0, 1.0])


def _quarter_turn(direction: Array) -> Array:
    """`direction` turned left by 90 degrees."""
    return np.array([-direction[1], direction[0]])


def _clip_half_plane(polygon: Array, origin: Array, inward: Array) -> Array:
    """Sutherland and Hodgman (CACM 1974), one edge: keep where ``(p - origin) . inward >= 0``."""
    if not len(polygon):
        return polygon
    height = (polygon - origin) @ inward
    kept: list[Array] = []
    for i in range(len(polygon)):
        j = i - 1
        if (height[i] >= 0) != (height[j] >= 0):
            share = height[j] / (height[j] - height[i])
            kept.append(polygon[j] + share * (polygon[i] - polygon[j]))
        if height[i] >= 0:
            kept.append(polygon[i])
    return np.array(kept) if kept else np.empty((0, 2))
