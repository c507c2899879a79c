"""One camera's lens and pixel grid.

Pixel convention: integer index = pixel centre, so the image spans u from -0.5 to width - 0.5
and its middle is ``(width - 1) / 2``, not ``width / 2``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.rig import given
from rigsim.rig.arrays import Array, Mask, by_rows
from rigsim.rig.lens.lens import Lens, ahead, unit
from rigsim.rig.lens.planar import PlanarLens, pinhole_jacobian

_HALVINGS = 60


@dataclass(frozen=True, slots=True)
class Intrinsics:
    """Camera with ``u = fx m_x + cx``, ``v = fy m_y + cy``: m is a pinhole's x/z, y/z, or what its lens says.

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
    lens: Lens | None = None
    """Lens model; None is the ideal pinhole."""

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
        if self.lens is not None:
            lens: object = self.lens
            if not isinstance(lens, Lens):
                wanted = "a lens, as BrownConrady, or None: the lens model"
                raise InvalidRig(f"{given.shown(lens)}: must be {wanted}")
            if lens.is_ideal:
                object.__setattr__(self, "lens", None)

    @classmethod
    def from_focal(
        cls,
        width: int,
        height: int,
        focal_px: float,
        *,
        cx: float | None = None,
        cy: float | None = None,
        lens: Lens | None = None,
    ) -> Intrinsics:
        """Square pixels and a focal length in px; the principal point defaults to the image's middle."""
        return cls(
            width,
            height,
            focal_px,
            focal_px,
            (given.real(width, "image width", InvalidRig) - 1) / 2 if cx is None else cx,
            (given.real(height, "image height", InvalidRig) - 1) / 2 if cy is None else cy,
            lens,
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
        """Horizontal field of view that the lens shows in the principal point's row, deg."""
        if self.lens is None:
            return math.degrees(
                math.atan((self.cx + 0.5) / self.fx) + math.atan((self.width - 0.5 - self.cx) / self.fx)
            )
        first, last = self.edge_angles_deg(0)
        return last - first

    @property
    def vfov_deg(self) -> float:
        """Vertical field of view that the lens shows in the principal point's column, deg."""
        if self.lens is None:
            return math.degrees(
                math.atan((self.cy + 0.5) / self.fy) + math.atan((self.height - 0.5 - self.cy) / self.fy)
            )
        first, last = self.edge_angles_deg(1)
        return last - first

    def edge_angles_deg(self, axis: int) -> tuple[float, float]:
        """Angles off the axis, deg, of the outermost rays that are shown in the principal point's row (0) or
        column (1), the first towards the image's beginning."""
        center = np.array([self.cx, self.cy])
        ends = np.array([center, center])
        ends[:, axis] = -0.5, (self.width, self.height)[axis] - 0.5
        # towards the principal point until the lens shows something: a fisheye's circle may end in the image
        shown, hidden = np.zeros(2), np.ones(2)
        for step in range(_HALVINGS):
            share = hidden if step == 0 else (shown + hidden) / 2
            rays = self.ray(center + share[:, None] * (ends - center))
            seen = np.isfinite(rays[:, 2])
            shown, hidden = np.where(seen, share, shown), np.where(seen, hidden, share)
            if step == 0 and seen.all():
                break
        rays = self.ray(center + shown[:, None] * (ends - center))
        first, last = np.degrees(np.arctan2(rays[:, axis], rays[:, 2]))
        return float(first), float(last)

    def project(self, points_camera: npt.ArrayLike) -> Array:
        """Project points (..., 3) m in the camera's frame to uv (..., 2) px.

        NaN where the camera shows nothing: behind a pinhole, beyond a lens's field (`Lens.sees`).
        """
        return by_rows(self._project, _coordinates(points_camera, "points", 3), 2)

    def ray(self, uv: npt.ArrayLike) -> Array:
        """Unit rays (..., 3) in the camera's frame of pixels (..., 2); NaN where the lens shows nothing."""
        return by_rows(self._ray, _coordinates(uv, "pixels", 2), 3)

    @property
    def axial_focal_px(self) -> tuple[float, float]:
        """Focal lengths along u and v on the optical axis, px: the same thing in every lens model."""
        if self.lens is None:
            return self.fx, self.fy
        J = self.jacobian(np.array([0.0, 0.0, 1.0]))
        return float(J[0, 0]), float(J[1, 1])

    @property
    def is_wide(self) -> bool:
        """Whether its lens model knows rays 90 degrees and more off the axis."""
        return not (self.lens is None or isinstance(self.lens, PlanarLens))

    def faces(self, points_camera: Array) -> Mask:
        """Whether points (..., 3) lie where the camera looks: z > 0, or what a wide lens shows."""
        if self.lens is None or isinstance(self.lens, PlanarLens):
            return np.asarray(points_camera[..., 2] > 0)
        return self.lens.sees(points_camera)

    def denormalize(self, normalized: npt.ArrayLike) -> Array:
        """Map undistorted normalised coordinates (..., 2) to pixels (..., 2)."""
        xy = np.asarray(normalized, dtype=np.float64)
        return self._pixels(xy if self.lens is None else self.lens.bent(xy))

    def normalize(self, uv: npt.ArrayLike) -> Array:
        """Map pixels (..., 2) to undistorted normalised coordinates (x/z, y/z), (..., 2).

        NaN where the lens shows nothing, or shows what is 90 degrees or more off its axis (see `ray`).
        """
        xy = self._image(np.asarray(uv, dtype=np.float64))
        if self.lens is None:
            return xy
        if isinstance(self.lens, PlanarLens):
            return self.lens.undistort(xy)
        return by_rows(self._ahead, xy, 2)

    def jacobian(self, points_camera: npt.ArrayLike) -> Array:
        """Derivative (..., 2, 3) px/m of `project` with respect to the point; NaN where that is."""
        points = _coordinates(points_camera, "points", 3)
        if self.lens is None:
            with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                J = pinhole_jacobian(points, self._straight(points))
        else:
            J = self.lens.jacobian(points)
        J[..., 0, :] *= self.fx
        J[..., 1, :] *= self.fy
        return J

    def _project(self, points: Array) -> Array:
        return self._pixels(self._straight(points) if self.lens is None else self.lens.project(points))

    def _ray(self, uv: Array) -> Array:
        image = self._image(uv)
        return unit(ahead(image)) if self.lens is None else self.lens.ray(image)

    def _ahead(self, image: Array) -> Array:
        assert self.lens is not None
        rays = self.lens.ray(image)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(rays[..., 2:] > 0, rays[..., :2] / rays[..., 2:], np.nan)

    def _image(self, uv: Array) -> Array:
        """Coordinates without units (..., 2) of pixels."""
        return np.asarray((uv - (self.cx, self.cy)) / (self.fx, self.fy))

    def _pixels(self, image: Array) -> Array:
        with np.errstate(over="ignore"):  # a point in the camera's own plane is infinitely far off
            return np.asarray(image * (self.fx, self.fy) + (self.cx, self.cy))

    @staticmethod
    def _straight(points: Array) -> Array:
        """x/z and y/z (..., 2) of points (..., 3); NaN where z <= 0."""
        z = points[..., 2:]
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            return np.where(z > 0, points[..., :2] / z, np.nan)

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

    def cropped(self, x: int, y: int, w: int, h: int) -> Intrinsics:
        """The camera of the pictures that are cut out: w x h px, whose first pixel was (x, y).

        Raises:
            InvalidRig: the cut is empty, or reaches out of the picture.
        """
        x, y, w, h = (_whole(number, "crop") for number in (x, y, w, h))
        cut = f"crop {x},{y},{w},{h}"
        if w < 1 or h < 1:
            raise InvalidRig(f"{cut}: both sides must be >= 1 px; it is x,y,width,height")
        if x < 0 or y < 0 or x + w > self.width or y + h > self.height:
            raise InvalidRig(
                f"{cut}: reaches out of the {self.width}x{self.height} picture; it is x,y,width,height, px"
                " from the upper left corner"
            )
        return replace(self, width=w, height=h, cx=self.cx - x, cy=self.cy - y)

    def binned(self, n: int) -> Intrinsics:
        """The camera of pictures in which n x n pixels are averaged to one; undoes `supersampled`.

        Raises:
            InvalidRig: the picture's sides cannot be divided by n.
        """
        n = _whole(n, "binning")
        if n < 1:
            raise InvalidRig(f"binning {n}: must be >= 1, the pixels along a side that become one")
        if self.width % n or self.height % n:
            width, height = self.width // n * n, self.height // n * n
            way = f"; cut off the rest first, as with --crop 0,0,{width},{height}" if width and height else ""
            raise InvalidRig(f"binning {n}: {self.width}x{self.height} px cannot be divided by it{way}")
        return self.resized(self.width // n, self.height // n)

    def resized(self, w: int, h: int) -> Intrinsics:
        """The camera of the pictures scaled to w x h px, edge to edge; unequal scales make fx and fy differ.

        Raises:
            InvalidRig: a side is less than 1 px.
        """
        w, h = _whole(w, "width"), _whole(h, "height")
        if w < 1 or h < 1:
            raise InvalidRig(f"size {w}x{h}: both sides must be >= 1 px")
        across, down = w / self.width, h / self.height
        return replace(
            self,
            width=w,
            height=h,
            fx=self.fx * across,
            fy=self.fy * down,
            cx=(self.cx + 0.5) * across - 0.5,
            cy=(self.cy + 0.5) * down - 0.5,
        )

    def contains(self, uv: Array) -> Mask:
        """Whether pixels (..., 2) lie on the image; NaN does not."""
        u, v = uv[..., 0], uv[..., 1]
        inside = (u >= -0.5) & (u <= self.width - 0.5) & (v >= -0.5) & (v <= self.height - 0.5)
        return np.asarray(inside)


def _whole(value: object, name: str) -> int:
    """A whole number of px."""
    number = given.real(value, name, InvalidRig)
    if not number.is_integer():
        raise InvalidRig(f"{name} {number:g} px: must be a whole number")
    return int(number)


def _coordinates(values: npt.ArrayLike, name: str, count: int) -> Array:
    """Numbers (..., `count`).

    Raises:
        InvalidRange: they are none, or of another shape.
    """
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidRange(f"{name} {given.shown(values)}: must be numbers (..., {count})") from None
    if array.ndim == 0 or array.shape[-1] != count:
        raise InvalidRange(f"{name} of shape {array.shape}: must be (..., {count})")
    return array
