"""Pictures through any lens, of a renderer that knows only pinholes.

One wider pinhole picture is enough for most lenses (`rigsim.sim.lens`). Where it is not, because a lens sees
to its sides or behind itself, up to six pinholes that look along the axes of a cube about the camera are
drawn, each as large and as fine as what the lens shows through it. A pixel's light is then the mean over the
rays of its finer pixels, each looked up in its face by a cubic spline; 0 where the lens shows nothing.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array, Light
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.planar import PlanarLens
from rigsim.sim.lens import covers, distort_image, wider_intrinsics
from rigsim.sim.supersampling import box_average

if TYPE_CHECKING:
    from rigsim.sim.simulator import Renderer

_MARGIN_PX = 8  # for the spline's reach
_AT_ONCE = 1 << 20  # pixels whose rays are held at once
_PROBES = 129  # along each side, to tell how finely the lens shows
# a face's x, y and z axis in the camera's frame, as columns: ahead, right, left, below, above, behind
_TURNS = tuple(
    np.array([x, np.cross(z, x), z], dtype=np.float64).T
    for x, z in (
        ((1, 0, 0), (0, 0, 1)),
        ((0, 0, -1), (1, 0, 0)),
        ((0, 0, 1), (-1, 0, 0)),
        ((1, 0, 0), (0, 1, 0)),
        ((1, 0, 0), (0, -1, 0)),
        ((-1, 0, 0), (0, 0, -1)),
    )
)


@dataclass(frozen=True, slots=True, eq=False)
class Face:
    """A turned pinhole at a camera's place, and which of the camera's pixels it serves."""

    lens: Intrinsics
    """The pinhole to draw through."""
    camera_from_face: Array
    """Its turn, (3, 3)."""
    pixels: npt.NDArray[np.int32]
    """The camera's pixels that look through it, (N,), row-major."""
    normalized: Light
    """Where they look, x/z and y/z in the face's frame, (N, 2)."""


def needs_faces(camera: Intrinsics) -> bool:
    """Whether no single pinhole picture, or only a vast one, holds what the camera's lens shows."""
    return camera.lens is not None and not covers(camera)


def pinholes_of(camera: Intrinsics, supersample: int) -> tuple[tuple[Intrinsics, int], ...]:
    """The pinholes that `draw` draws through, and the supersampling of each.

    Raises:
        InvalidRig: the distortion folds the picture over.
    """
    if camera.lens is None:
        return ((camera, supersample),)
    if needs_faces(camera):
        return tuple((face.lens, 1) for face in faces_of(camera.supersampled(supersample)))
    return ((wider_intrinsics(camera, supersample), 1),)


def draw(renderer: Renderer, side: int, camera: Intrinsics, supersample: int) -> Light:
    """Linear light (H, W, 3) on the placed rig's left (0) or right (1) camera through any lens.

    Args:
        renderer: what draws.
        side: which camera's place and turn.
        camera: the camera that is drawn, usually the placed one's.
        supersample: samples along each side of a pixel.

    Raises:
        InvalidRig: the distortion folds the picture over.
    """
    if camera.lens is None:
        return renderer.light(side, camera, supersample)
    if needs_faces(camera):
        fine = through_faces(renderer, side, camera.supersampled(supersample))
        return box_average(fine, supersample)
    wide = wider_intrinsics(camera, supersample)
    return distort_image(renderer.light(side, wide, 1), wide, camera).astype(np.float32)


def through_faces(renderer: Renderer, side: int, camera: Intrinsics, order: Literal[1, 3] = 3) -> Light:
    """Light (H, W, 3) along the rays of the pixels' centres, by splines of an order: 1 is quick, 3 is true.

    Raises:
        InvalidRig: as `draw`.
    """
    if renderer.bends:
        return renderer.light(side, camera, 1)
    light = np.zeros((camera.height * camera.width, 3), dtype=np.float32)
    for face in faces_of(camera):
        picture = renderer.light(side, face.lens, 1, face.camera_from_face)
        for channel in range(3):
            _look_up(picture[..., channel], face, light[:, channel], order)
    return light.reshape(camera.height, camera.width, 3)


def _look_up(picture: Light, face: Face, light: Light, order: Literal[1, 3]) -> None:
    from scipy.ndimage import map_coordinates, spline_filter  # heavy, and not always needed

    spline = picture if order == 1 else spline_filter(picture, order=3, mode="mirror", output=np.float32)
    for start in range(0, len(face.pixels), _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        rows_and_columns = face.lens.denormalize(face.normalized[part]).T[::-1]
        light[face.pixels[part]] = map_coordinates(
            spline, rows_and_columns, order=order, prefilter=False, mode="mirror"
        )


@lru_cache(maxsize=2)
def faces_of(camera: Intrinsics) -> tuple[Face, ...]:
    """The faces of a cube that the lens looks through, a ray through the middle of every pixel.

    Raises:
        InvalidRig: the distortion folds the picture over, or the lens shows nothing.
    """
    pixels: list[list[npt.NDArray[np.int32]]] = [[] for _ in _TURNS]
    places: list[list[Light]] = [[] for _ in _TURNS]
    for start, rays in _rays(camera):
        shown = np.isfinite(rays[:, 2])
        if isinstance(camera.lens, PlanarLens) and not shown.all():
            raise InvalidRig(
                "distortion folds within the picture: some of its pixels show no ray; "
                "weaken it or crop the picture"
            )
        which = np.where(shown, _face(rays), -1)
        for index in range(len(_TURNS)):
            mine = np.flatnonzero(which == index)
            turned = rays[mine] @ _TURNS[index]
            pixels[index].append((start + mine).astype(np.int32))
            places[index].append((turned[:, :2] / turned[:, 2:]).astype(np.float32))
    focal_px = _focal_lengths(camera)
    faces = tuple(
        _face_of(focal_px[index], turn, np.concatenate(pixels[index]), np.concatenate(places[index]))
        for index, turn in enumerate(_TURNS)
        if any(len(part) for part in pixels[index])
    )
    if not faces:
        raise InvalidRig("the lens shows nothing within the picture: its circle lies beside it")
    return faces


def _rays(camera: Intrinsics) -> Iterator[tuple[int, Array]]:
    """Rays (N, 3) of all pixels, some rows at a time, and the first one's number."""
    rows = max(1, _AT_ONCE // camera.width)
    for top in range(0, camera.height, rows):
        v, u = np.mgrid[top : min(top + rows, camera.height), : camera.width]
        yield top * camera.width, camera.ray(np.column_stack([u.ravel(), v.ravel()]))


def _face(rays: Array) -> npt.NDArray[np.intp]:
    """Through which face each ray (N, 3) goes, (N,)."""
    along = np.abs(rays)
    axis = np.where(
        (along[:, 2] >= along[:, 0]) & (along[:, 2] >= along[:, 1]), 2, along[:, 1] > along[:, 0]
    ).astype(np.intp)
    backwards = np.take_along_axis(rays, axis[:, None], axis=1)[:, 0] < 0
    return np.array([[1, 2], [3, 4], [0, 5]])[axis, backwards.astype(np.intp)]


def _focal_lengths(camera: Intrinsics) -> Array:
    """Focal lengths (6,), px, with which each face is nowhere coarser than the lens shows it.

    A pinhole shows a step of an angle least finely in its middle, and there by its focal length.
    """
    rays = _probed(camera)
    need = px_per_rad(camera, rays) * np.abs(rays).max(axis=1)
    which = _face(rays)
    found = np.full(len(_TURNS), max(camera.fx, camera.fy))
    for index in np.unique(which):
        # towards a lens's end the scale may grow beyond all bounds, for next to no pixels
        found[index] = np.nanquantile(need[which == index], 0.995)
    return found


@lru_cache(maxsize=8)
def field(camera: Intrinsics) -> tuple[float, float]:
    """The widest angle to its axis at which the camera shows something, rad, and its largest `px_per_rad`."""
    rays = _probed(camera)
    if not len(rays):
        return 0.0, max(camera.fx, camera.fy)
    return float(np.arccos(rays[:, 2].clip(-1, 1)).max()), float(np.nanmax(px_per_rad(camera, rays)))


def _probed(camera: Intrinsics) -> Array:
    """Unit rays (N, 3) of pixels spread over the picture, its corners included, where the lens shows any."""
    u = np.linspace(-0.5, camera.width - 0.5, _PROBES)
    v = np.linspace(-0.5, camera.height - 0.5, _PROBES)
    rays = camera.ray(np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2))
    return rays[np.isfinite(rays[:, 2])]


def px_per_rad(camera: Intrinsics, rays: Array) -> Array:
    """How many pixels a turn of each unit ray (N, 3) is worth, (N,): the way it is worth most, but at most
    twice what it is worth the other way, as far behind a camera a point is drawn out to an arc."""
    J = camera.jacobian(rays)
    a, b, c = (np.sum(J[:, i] * J[:, j], axis=1) for i, j in ((0, 0), (0, 1), (1, 1)))
    mean, half = (a + c) / 2, np.hypot((a - c) / 2, b)
    return np.asarray(np.sqrt(np.minimum(mean + half, 4 * np.maximum(mean - half, 0))))


def _face_of(focal_px: float, turn: Array, pixels: npt.NDArray[np.int32], normalized: Light) -> Face:
    first = np.floor(normalized.min(axis=0) * focal_px) - _MARGIN_PX
    last = np.ceil(normalized.max(axis=0) * focal_px) + _MARGIN_PX
    width, height = (last - first).astype(int) + 1
    lens = Intrinsics(int(width), int(height), focal_px, focal_px, -float(first[0]), -float(first[1]))
    return Face(lens, turn, pixels, normalized)
