"""Two cameras in a fixed relation; the left one is the reference."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRig
from rigsim.rig import given
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose, rotation_from_rotvec

_RECTIFIED_TOLERANCE = 1e-12


@dataclass(frozen=True, slots=True)
class StereoRig:
    """Left and right camera; axes x right, y down, z forward (OpenCV's).

    Raises:
        InvalidRig: the two camera centres coincide.

    Example:
        >>> import rigsim
        >>> rig = rigsim.StereoRig.rectified(rigsim.Intrinsics.from_focal(1280, 960, 1100.0), 0.06)
        >>> uv_left, uv_right = rig.project([[0, 0, 2.0]])
        >>> float(uv_left[0, 0] - uv_right[0, 0])  # f B / Z
        33.0
    """

    left: Intrinsics
    """Left camera."""
    right: Intrinsics
    """Right camera."""
    right_from_left: Pose
    """Maps points of the left camera's frame to the right camera's, m."""

    def __post_init__(self) -> None:
        for camera in (self.left, self.right):
            given.a(Intrinsics, camera, "an Intrinsics: the camera of a rig", InvalidRig)
        given.a(Pose, self.right_from_left, "a Pose: right_from_left", InvalidRig)
        if self.baseline_m == 0.0:
            raise InvalidRig("baseline 0 mm: must be > 0 (the two camera centres coincide)")

    @classmethod
    def rectified(
        cls, intrinsics: Intrinsics, baseline_m: float, *, right: Intrinsics | None = None
    ) -> StereoRig:
        """Parallel cameras, the right one `baseline_m` along +x; `right` when its lens differs."""
        return cls.verged(intrinsics, baseline_m, 0.0, right=right)

    @classmethod
    def verged(
        cls,
        intrinsics: Intrinsics,
        baseline_m: float,
        vergence_deg: float,
        *,
        right: Intrinsics | None = None,
    ) -> StereoRig:
        """Toe-in: both cameras turn inwards by half of `vergence_deg`, about their y axes."""
        baseline_m = given.real(baseline_m, "baseline", InvalidRig)
        vergence_deg = given.real(vergence_deg, "vergence", InvalidRig)
        if not (math.isfinite(baseline_m) and baseline_m > 0):
            raise InvalidRig(f"baseline {baseline_m * 1e3:g} mm: must be > 0")
        if not (math.isfinite(vergence_deg) and abs(vergence_deg) < 180):
            raise InvalidRig(f"vergence {vergence_deg:g} deg: must be between -180 and 180")
        half = rotation_from_rotvec(np.array([0.0, math.radians(vergence_deg) / 2, 0.0]))
        rig_from_left = Pose(half, np.array([-baseline_m / 2, 0.0, 0.0]))
        rig_from_right = Pose(half.T, np.array([baseline_m / 2, 0.0, 0.0]))
        return cls(intrinsics, right or intrinsics, rig_from_right.inverse @ rig_from_left)

    @property
    def baseline_m(self) -> float:
        """Distance between the camera centres, m."""
        return float(np.linalg.norm(self.right_from_left.t))

    @property
    def doffs_px(self) -> float:
        """``cx_right - cx_left``, px: added to a disparity before it becomes a depth."""
        return self.right.cx - self.left.cx

    @property
    def vergence_deg(self) -> float:
        """Angle between the two optical axes, deg; positive when they meet in front."""
        # the right camera's axis seen from the left: negative x is inwards
        x, _, z = self.right_from_left.R[2]
        return math.degrees(math.atan2(-x, z))

    @property
    def is_rectified(self) -> bool:
        """Whether rows correspond and ``Z = fx b / (disparity + doffs)`` holds: parallel axes, a
        baseline along +x, equal fx, fy and cy, no distortion."""
        left, right, t = self.left, self.right, self.right_from_left.t
        return bool(
            np.abs(self.right_from_left.R - np.eye(3)).max() <= _RECTIFIED_TOLERANCE
            and t[0] < 0
            and max(abs(t[1]), abs(t[2])) <= _RECTIFIED_TOLERANCE * -t[0]
            and left.fx == right.fx
            and left.fy == right.fy
            and left.cy == right.cy
            and left.lens is None
            and right.lens is None
        )

    @property
    def rig_from_left(self) -> Pose:
        """Maps the left camera's frame to the rig's: origin in the middle of the baseline, axes halfway
        between the two cameras' (their geodesic mean), so a verged rig looks straight ahead."""
        half = rotation_from_rotvec(self.right_from_left.rotvec_rad / 2)
        middle_left = self.right_from_left.inverse.t / 2
        return Pose(half, -half @ middle_left)

    def cropped(self, x: int, y: int, w: int, h: int) -> StereoRig:
        """The rig of pictures that are cut out of both cameras' alike; see `Intrinsics.cropped`."""
        return self._changed(lambda camera: camera.cropped(x, y, w, h))

    def binned(self, n: int) -> StereoRig:
        """The rig of pictures in which n x n pixels are averaged to one; see `Intrinsics.binned`."""
        return self._changed(lambda camera: camera.binned(n))

    def resized(self, w: int, h: int) -> StereoRig:
        """The rig of pictures scaled to w x h px; see `Intrinsics.resized`."""
        return self._changed(lambda camera: camera.resized(w, h))

    def _changed(self, change: Callable[[Intrinsics], Intrinsics]) -> StereoRig:
        return StereoRig(change(self.left), change(self.right), self.right_from_left)

    def figure(self, points_left: npt.ArrayLike = (), *, noise_px: float = 0.25, title: str = "") -> Any:
        """Draw the rig from above: a matplotlib Figure, as `rigsim.rig_figure`, which says more."""
        import rigsim  # the front door knows who draws; this room does not

        return rigsim.rig_figure(self, points_left, noise_px=noise_px, title=title)

    def project(self, points_left: npt.ArrayLike) -> tuple[Array, Array]:
        """Project points (N, 3) m in the left camera's frame to (uv_left, uv_right), each (N, 2) px.

        NaN behind a camera; nothing is clipped to the image.
        """
        points = np.asarray(points_left, dtype=np.float64)
        return self.left.project(points), self.right.project(self.right_from_left.apply(points))

    def jacobian(self, points_left: npt.ArrayLike) -> Array:
        """Derivative (N, 4, 3) px/m of (u_left, v_left, u_right, v_right) with respect to the point."""
        points = np.asarray(points_left, dtype=np.float64)
        right = self.right.jacobian(self.right_from_left.apply(points)) @ self.right_from_left.R
        return np.concatenate([self.left.jacobian(points), right], axis=-2)


@dataclass(frozen=True, slots=True)
class PixelGrid:
    """What is done to both pictures before anything else, in this order; None leaves them."""

    crop: tuple[int, int, int, int] | None = None
    """First pixel x, y and size w, h of what is cut out, px."""
    binning: int | None = None
    """Pixels along a side that are averaged to one."""
    resize: tuple[int, int] | None = None
    """Width and height that they are scaled to, px."""

    def apply(self, rig: StereoRig) -> StereoRig:
        """The rig of the pictures that come out; the same one where nothing is done.

        Raises:
            InvalidRig: the cut reaches out of the picture, or the binning does not divide it.
        """
        if self.crop is not None:
            rig = rig.cropped(*self.crop)
        if self.binning is not None:
            rig = rig.binned(self.binning)
        return rig if self.resize is None else rig.resized(*self.resize)
