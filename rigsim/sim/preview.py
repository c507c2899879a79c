"""Pictures for a rig that is being turned in one's hands: as soon as they can be had.

One pass for the light and one for the depth of each camera. A lens that distorts is drawn through the
pinhole that covers it, and looked up there: linearly between pixels, and linearly in 1/Z on one surface,
which is exact where that is flat.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
import numpy.typing as npt

from rigsim.rig.arrays import Array, Ids, Light
from rigsim.rig.intrinsics import Intrinsics
from rigsim.sim import faces
from rigsim.sim.lens import ideal_grid, wider_intrinsics
from rigsim.sim.scenes.scene import Scene

if TYPE_CHECKING:
    from rigsim.sim.simulator import Renderer

_CORNERS = ((0, 0), (0, 1), (1, 0), (1, 1))
_MARGIN_PX = 2.0

_Lookup: TypeAlias = tuple[npt.NDArray[np.intp], Light]
"""The four pixels of the pinhole's picture about each of the camera's, flat (4, H W), and their weights."""


def pinhole_of(camera: Intrinsics) -> Intrinsics:
    """The pinhole whose picture is drawn for a camera: itself, or one that covers what its lens shows.

    Raises:
        InvalidRig: the distortion folds the picture over, or needs more than three times its width.
    """
    return camera if camera.lens is None else wider_intrinsics(camera, 1, margin_px=_MARGIN_PX)


def pinholes_of(camera: Intrinsics) -> tuple[Intrinsics, ...]:
    """All pinholes that are drawn for a camera: one, or the faces of a cube.

    Raises:
        InvalidRig: the distortion folds the picture over.
    """
    if faces.needs_faces(camera):
        return tuple(face.lens for face in faces.faces_of(camera))
    return (pinhole_of(camera),)


def light(scene: Scene, renderer: Renderer, side: int) -> Light:
    """Linear light (H, W, 3) on the left (0) or right (1) camera of the placed rig, lens included.

    Raises:
        InvalidRig: as `pinhole_of`.
    """
    camera = scene.lens(side)
    if renderer.bends or camera.lens is None:
        return renderer.light(side, camera, 1)
    if faces.needs_faces(camera):
        return faces.through_faces(renderer, side, camera, order=1)
    drawn = renderer.light(side, pinhole_of(camera), 1)
    at, weights = _lookup(camera)
    pixels = drawn.reshape(-1, 3)
    found = sum(pixels[at[i]] * weights[i][:, None] for i in range(4))
    return np.asarray(found, dtype=np.float32).reshape(camera.height, camera.width, 3)


def through(camera: Intrinsics, depth: Array, segmentation: Ids) -> tuple[Array, Ids]:
    """Depth (h, w) m and geom ids of its pinhole's picture as the camera sees them, both (H, W)."""
    at, weights = _lookup(camera)
    depths, geom = depth.ravel()[at], segmentation.ravel()[at]
    first = np.argmax(weights, axis=0)[None]
    nearest, nearest_geom = (np.take_along_axis(part, first, axis=0)[0] for part in (depths, geom))
    with np.errstate(divide="ignore", invalid="ignore"):
        between = 1 / (weights / depths).sum(axis=0)
    found = np.where((geom == nearest_geom).all(axis=0), between, nearest)
    shape = (camera.height, camera.width)
    return found.reshape(shape), nearest_geom.reshape(shape)


@lru_cache(maxsize=4)
def _lookup(camera: Intrinsics) -> _Lookup:
    pinhole = pinhole_of(camera)
    uv = pinhole.denormalize(ideal_grid(camera)).reshape(-1, 2)
    limit = (pinhole.width - 2, pinhole.height - 2)
    first = np.clip(np.floor(uv), 0, limit)
    share = (uv - first).astype(np.float32)
    u, v = first.astype(np.intp).T
    at = np.stack([(v + dv) * pinhole.width + u + du for dv, du in _CORNERS])
    along_u, along_v = (1 - share[:, 0], share[:, 0]), (1 - share[:, 1], share[:, 1])
    weights = np.stack([along_v[dv] * along_u[du] for dv, du in _CORNERS])
    return at, weights
