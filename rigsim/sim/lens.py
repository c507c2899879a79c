"""Lens distortion of a picture, and its removal.

A renderer knows only pinholes. So a wider and finer pinhole picture is rendered (`wider_intrinsics`) and
every pixel of the distorted picture is the mean over its square, sampled as finely as was rendered, of a
cubic spline through it (`distort_image`). `rectify_image` goes back, with the calibration somebody believes.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from rigsim.errors import InvalidImage, InvalidRig
from rigsim.rig.arrays import AnyImage, Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.lens import ahead
from rigsim.sim.truth.points import directions

_MARGIN_PX = 8.0  # for the lens blur and the spline's reach
_MAX_WIDENING = 3.0
_FAIR = 2.0  # beyond it the faces of a cube have fewer pixels


def wider_intrinsics(
    intrinsics: Intrinsics, supersample: int = 2, *, margin_px: float = _MARGIN_PX
) -> Intrinsics:
    """The pinhole camera whose picture covers every pixel of a distorted one, `supersample` times finer.

    Args:
        intrinsics: The camera with distortion.
        supersample: Pixels rendered for one, along each side.
        margin_px: How much more is covered on every side, px of the distorted picture.

    Raises:
        InvalidRig: the distortion folds the picture over, or needs more than three times its width.
    """
    if not (isinstance(supersample, int) and supersample >= 1):
        raise InvalidRig(f"supersample {supersample}: must be a whole number >= 1")
    first, last = _extent(intrinsics, margin_px)
    if not np.isfinite(first).all():
        raise InvalidRig(
            "distortion folds within the picture or its margin: no straight ray ends at its rim; "
            "weaken it or crop the picture"
        )
    (first_u, first_v), (width, height) = first.astype(int), (last - first).astype(int) + 1
    if width > _MAX_WIDENING * intrinsics.width or height > _MAX_WIDENING * intrinsics.height:
        raise InvalidRig(
            f"distortion needs a pinhole picture of {width} x {height} px for one of {intrinsics.width} x "
            f"{intrinsics.height}: at most {_MAX_WIDENING:g} times as wide; weaken it or crop the picture"
        )
    k = supersample
    return Intrinsics(
        int(width) * k,
        int(height) * k,
        intrinsics.fx * k,
        intrinsics.fy * k,
        (intrinsics.cx - first_u) * k + (k - 1) / 2,
        (intrinsics.cy - first_v) * k + (k - 1) / 2,
    )


def covers(camera: Intrinsics) -> bool:
    """Whether one wider pinhole picture holds what the camera shows; of a wide lens, at a fair price."""
    first, last = _extent(camera, _MARGIN_PX)
    size = last - first + 1  # NaN compares as false
    return bool(
        (size <= (_FAIR if camera.is_wide else _MAX_WIDENING) * np.array([camera.width, camera.height])).all()
    )


def _extent(camera: Intrinsics, margin_px: float) -> tuple[Array, Array]:
    """First and last column and row, (2,) each, of the camera's pixels as a pinhole would have them.

    NaN where a ray of the rim is none, or 90 degrees off the axis.
    """
    left, top = -0.5 - margin_px, -0.5 - margin_px
    right, bottom = camera.width - 0.5 + margin_px, camera.height - 0.5 + margin_px
    along = np.linspace(0, 1, 257)
    u, v = left + (right - left) * along, top + (bottom - top) * along
    ends = [np.full_like(u, value) for value in (top, bottom, left, right)]
    rim = np.concatenate(
        [np.stack(pair, axis=-1) for pair in ((u, ends[0]), (u, ends[1]), (ends[2], v), (ends[3], v))]
    )
    ideal = camera.normalize(rim)
    focal, center = np.array([camera.fx, camera.fy]), np.array([camera.cx, camera.cy])
    # whole pixels of the coarse grid on every side keep the fine pixels nested in it
    return np.floor(ideal.min(axis=0) * focal + center), np.ceil(ideal.max(axis=0) * focal + center)


def distort_image(wide_image: AnyImage, wide_intrinsics: Intrinsics, intrinsics: Intrinsics) -> Array:
    """The picture (H, W[, 3]) of a camera with distortion, from a wider pinhole picture.

    Every pixel is the mean over its square; `wide_intrinsics.fx / intrinsics.fx` says how finely to sample.

    Raises:
        InvalidImage: the wide picture is not of `wide_intrinsics`' size.
        InvalidRig: it does not cover the distorted one.
    """
    _check_size(wide_image, wide_intrinsics, "wide image")
    samples = max(1, round(wide_intrinsics.fx / intrinsics.fx))
    ideal, inverse = _undistorted_grid(intrinsics)
    uv = wide_intrinsics.denormalize(ideal)
    # u, v of the wide picture for a step of one distorted pixel, (H, W, 2, 2)
    slope = inverse * np.array([[wide_intrinsics.fx], [wide_intrinsics.fy]]) / (intrinsics.fx, intrinsics.fy)
    limit = np.array([wide_intrinsics.width - 1, wide_intrinsics.height - 1])
    if not (np.isfinite(uv).all() and (uv >= 0).all() and (uv <= limit).all()):
        raise InvalidRig("wide image does not cover the distorted one: render it with wider_intrinsics")
    offsets = (np.arange(samples) + 0.5) / samples - 0.5
    positions = [uv + slope @ np.array([du, dv]) for dv in offsets for du in offsets]
    return _per_channel(wide_image, lambda channel: _mean_of_spline(channel, positions))


def rectify_image(image: AnyImage, assumed: Intrinsics, target: Intrinsics) -> Array:
    """The pinhole picture `target` of a distorted one, as the calibration `assumed` would have it.

    A cubic spline through the pixels, and 0 where no pixel was. Levels stay as they are, not rounded.

    Raises:
        InvalidImage: the picture is not of the calibration's size.
    """
    _check_size(image, assumed, "image")
    v, u = np.mgrid[0 : target.height, 0 : target.width]
    uv = assumed.denormalize(target.normalize(np.stack([u, v], axis=-1)))
    seen = assumed.contains(uv)
    return _per_channel(image, lambda channel: np.where(seen, _mean_of_spline(channel, [uv]), 0.0))


@lru_cache(maxsize=4)
def ray_grid(intrinsics: Intrinsics) -> Array:
    """`directions` (H, W, 3) of every pixel; read-only, as it is kept."""
    v, u = np.mgrid[0 : intrinsics.height, 0 : intrinsics.width]
    rays = directions(intrinsics, np.column_stack([u.ravel(), v.ravel()]))
    rays = rays.reshape(intrinsics.height, intrinsics.width, 3)
    rays.flags.writeable = False
    return rays


def ideal_grid(intrinsics: Intrinsics) -> Array:
    """Undistorted normalised coordinates (H, W, 2) of every pixel, all of them ahead of the camera."""
    rays = ray_grid(intrinsics)
    return rays[..., :2] / rays[..., 2:] if intrinsics.is_wide else rays[..., :2]


@lru_cache(maxsize=2)
def _undistorted_grid(intrinsics: Intrinsics) -> tuple[Array, Array]:
    """Ideal coordinates (H, W, 2) of every pixel, and their derivative (H, W, 2, 2) by distorted ones."""
    ideal = ideal_grid(intrinsics)
    if intrinsics.lens is None:
        return ideal, np.broadcast_to(np.eye(2), (*ideal.shape, 2))
    J = intrinsics.lens.jacobian(ahead(ideal))[..., :2]
    determinant = J[..., 0, 0] * J[..., 1, 1] - J[..., 0, 1] * J[..., 1, 0]
    inverse = np.empty_like(J)
    inverse[..., 0, 0], inverse[..., 1, 1] = J[..., 1, 1], J[..., 0, 0]
    inverse[..., 0, 1], inverse[..., 1, 0] = -J[..., 0, 1], -J[..., 1, 0]
    inverse /= determinant[..., None, None]
    return ideal, inverse


def _mean_of_spline(channel: Array, positions: list[Array]) -> Array:
    from scipy.ndimage import map_coordinates, spline_filter  # heavy, and not always needed

    coefficients = spline_filter(channel, order=3, mode="mirror")
    total = np.zeros(positions[0].shape[:-1])
    for uv in positions:
        total += map_coordinates(
            coefficients, (uv[..., 1], uv[..., 0]), order=3, prefilter=False, mode="mirror"
        )
    return total / len(positions)


def _per_channel(image: AnyImage, resample: Callable[[Array], Array]) -> Array:
    levels = np.asarray(image, dtype=np.float64)
    if levels.ndim == 2:
        return resample(levels)
    return np.stack([resample(levels[..., i]) for i in range(levels.shape[2])], axis=-1)


def _check_size(image: AnyImage, intrinsics: Intrinsics, name: str) -> None:
    shape = np.asarray(image).shape
    if len(shape) not in (2, 3) or shape[:2] != (intrinsics.height, intrinsics.width):
        raise InvalidImage(
            f"{name} of shape {shape}: the camera has {intrinsics.height} rows and {intrinsics.width} columns"
        )
