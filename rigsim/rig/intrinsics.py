"""One camera's lens and pixel grid.

Pixel convention: integer index = pixel centre, so the image spans u from -0.5 to width - 0.5
and its middle is ``(width - 1) / 2``, not ``width / 2``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRig
from rigsim.rig import given
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.lens.lens import Lens


@dataclass(frozen=True, slots=True)
class Intrinsics:
    """Pinhole camera ``u = fx x/z + cx``, ``v = fy y/z + cy`` with optional lens distortion.

    Example:
        >>> import rigsim
        >>> lens = rigsim.Intrinsics.from_hfov(1280, 720, 90.0)
        >>> lens.cx, round(lens.fx, 3)  # half the width over tan(45 deg)
        (639.5, 640.0)
    """

    width: int
    """Image width, px."""
    height: int
    """Image height, px."""
    fx: float
    """Focal length along u, px."""
    fy: float
    """Focal length along v, px."""
    cx: float
    """Principal point u, px (pixel centres are integers)."""
    cy: float
    """Principal point v, px."""
    distortion: Lens | None = None
    """Lens distortion; None is the ideal pinhole."""

    def __post_init__(self) -> None:
        for name, unknown in (("width", self.width), ("height", self.height)):
            size = given.real(unknown, f"image {name}", InvalidRig)
            if not size.is_integer() or size < 1:
                raise InvalidRig(f"image {name} {size:g} px: must be a whole number >= 1")
            object.__setattr__(self, name, int(size))
        for name, length in (("fx", self.fx), ("fy", self.fy)):
            value = given.real(length, f"focal length {name}", InvalidRig)
            if not (math.isfinite(value) and value > 0):
                raise InvalidRig(f"focal length {name} {value:g} px: must be > 0")
            object.__setattr__(self, name, value)
        for name, place in (("cx", self.cx), ("cy", self.cy)):
            value = given.real(place, f"principal point {name}", InvalidRig)
            if not math.isfinite(value):
                raise InvalidRig(f"principal point {name} {value:g} px: must be a finite number")
            object.__setattr__(self, name, value)
        if self.distortion is not None:
            lens: object = self.distortion
            if not isinstance(lens, Lens):
                wanted = "a lens, as BrownConrady, or None: the lens distortion"
                raise InvalidRig(f"{given.shown(lens)}: must be {wanted}")
            if lens.is_ideal:
                object.__setattr__(self, "distortion", None)

    @classmethod
    def from_focal(
        cls,
        width: int,
        height: int,
        focal_px: float,
        *,
        cx: float | None = None,
        cy: float | None = None,
        distortion: Lens | None = None,
    ) -> Intrinsics:
        """Square pixels and a focal length in px; the principal point defaults to the image's middle."""
        return cls(
            width,
            height,
            focal_px,
            focal_px,
            (given.real(width, "image width", InvalidRig) - 1) / 2 if cx is None else cx,
            (given.real(height, "image height", InvalidRig) - 1) / 2 if cy is None else cy,
            distortion,
        )

    @classmethod
    def from_hfov(cls, width: int, height: int, hfov_deg: float) -> Intrinsics:
        """Square pixels and a horizontal field of view across the full image width, deg."""
        wide = given.real(width, "image width", InvalidRig)
        hfov_deg = given.real(hfov_deg, "horizontal field of view", InvalidRig)
        if not (math.isfinite(hfov_deg) and 0 < hfov_deg < 180):
            raise InvalidRig(f"horizontal field of view {hfov_deg:g} deg: must be > 0 and < 180")
        return cls.from_focal(width, height, wide / 2 / math.tan(math.radians(hfov_deg) / 2))

    @classmethod
    def from_lens(cls, width: int, height: int, focal_mm: float, sensor_width_mm: float) -> Intrinsics:
        """Square pixels, a focal length in mm and the active sensor width in mm."""
        wide = given.real(width, "image width", InvalidRig)
        focal_mm = given.real(focal_mm, "focal length", InvalidRig)
        sensor_width_mm = given.real(sensor_width_mm, "sensor width", InvalidRig)
        for name, value in (("focal length", focal_mm), ("sensor width", sensor_width_mm)):
            if not (math.isfinite(value) and value > 0):
                raise InvalidRig(f"{name} {value:g} mm: must be > 0")
        return cls.from_focal(width, height, focal_mm * wide / sensor_width_mm)

    @property
    def K(self) -> Array:
        """Camera matrix, (3, 3), px."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    @property
    def hfov_deg(self) -> float:
        """Horizontal field of view across the full image width, deg (ideal pinhole)."""
        return math.degrees(
            math.atan((self.cx + 0.5) / self.fx) + math.atan((self.width - 0.5 - self.cx) / self.fx)
        )

    @property
    def vfov_deg(self) -> float:
        """Vertical field of view across the full image height, deg (ideal pinhole)."""
        return math.degrees(
            math.atan((self.cy + 0.5) / self.fy) + math.atan((self.height - 0.5 - self.cy) / self.fy)
        )

    def project(self, points_camera: npt.ArrayLike) -> Array:
        """Project points (..., 3) m in the camera's frame to uv (..., 2) px.

        NaN where z <= 0 or where the distorted lens shows nothing (`Lens.shows`).
        """
        return self.denormalize(self._seen(np.asarray(points_camera, dtype=np.float64)))

    def denormalize(self, normalized: npt.ArrayLike) -> Array:
        """Map undistorted normalised coordinates (..., 2) to pixels (..., 2)."""
        xy = np.asarray(normalized, dtype=np.float64)
        if self.distortion is not None:
            xy = self.distortion.distort(xy)
        with np.errstate(over="ignore"):  # a point in the camera's own plane is infinitely far off
            return xy * (self.fx, self.fy) + (self.cx, self.cy)

    def normalize(self, uv: npt.ArrayLike) -> Array:
        """Map pixels (..., 2) to undistorted normalised coordinates (x/z, y/z), (..., 2)."""
        xy = (np.asarray(uv, dtype=np.float64) - (self.cx, self.cy)) / (self.fx, self.fy)
        return xy if self.distortion is None else self.distortion.undistort(xy)

    def jacobian(self, points_camera: Array) -> Array:
        """Derivative (..., 2, 3) px/m of `project` with respect to the point; NaN where that is."""
        z = points_camera[..., 2]
        normalized = self._seen(points_camera)
        J = np.zeros((*points_camera.shape[:-1], 2, 3))
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            inverse_z = np.where(np.isfinite(normalized[..., 0]), 1 / z, np.nan)
            J[..., 0, 0] = inverse_z
            J[..., 1, 1] = inverse_z
            J[..., 0, 2] = -normalized[..., 0] * inverse_z
            J[..., 1, 2] = -normalized[..., 1] * inverse_z
            if self.distortion is not None:
                J = self.distortion.jacobian(normalized) @ J
        J[..., 0, :] *= self.fx
        J[..., 1, :] *= self.fy
        return J

    def _seen(self, points_camera: Array) -> Array:
        """Undistorted normalised coordinates (..., 2) of points (..., 3); NaN where the camera shows none."""
        z = points_camera[..., 2:]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            normalized = np.where(z > 0, points_camera[..., :2] / z, np.nan)
            if self.distortion is not None:
                normalized = np.where(self.distortion.shows(normalized)[..., None], normalized, np.nan)
        return normalized

    def supersampled(self, k: int) -> Intrinsics:
        """The same camera with k x k pixels in the place of one; averaged, they are the old pixel."""
        return replace(
            self,
            width=k * self.width,
            height=k * self.height,
            fx=k * self.fx,
            fy=k * self.fy,
            cx=k * self.cx + (k - 1) / 2,
            cy=k * self.cy + (k - 1) / 2,
        )

    def contains(self, uv: Array) -> Mask:
        """Whether pixels (..., 2) lie on the image; NaN does not."""
        u, v = uv[..., 0], uv[..., 1]
        inside = (u >= -0.5) & (u <= self.width - 0.5) & (v >= -0.5) & (v <= self.height - 0.5)
        return np.asarray(inside)
