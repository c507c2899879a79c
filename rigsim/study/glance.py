"""One rig in one scene, looked at in passing: pictures, depth, disparity and expected error, while one drags.

Depth, disparity and expected error are of the rig that is assumed, in pixels of its own pictures, whatever
the size that is drawn; the pictures may be taken by the rig as it was built.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array, Image, Light, Mask
from rigsim.rig.noise import PixelNoise, as_noise
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.sim.disparity import drawn_disparity, drawn_points
from rigsim.sim.frame import StereoFrame, View
from rigsim.sim.simulator import Simulator
from rigsim.study.scene.plan import RigGrid
from rigsim.theory.uncertainty import predict_depth_std

COARSE_WIDTH_PX = 320
"""Width of a coarse picture unless a size is asked for."""
MOST_PIXELS = 1_300_000
"""Pixels of the largest picture that is drawn in passing; of a larger one a smaller is drawn."""

_SMALL = 100_000  # pixels, each of which is predicted for
_BLOCK = 4
_RECTIFIED_BLOCK = 8
_ALIKE = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Glance:
    """A stereo pair with what is known of each left pixel."""

    left: Image
    """Left picture, (H, W, 3)."""
    right: Image
    """Right picture, (H, W, 3)."""
    depth_m: Light
    """Depth of each left pixel, (H, W), m; NaN for nothing."""
    disparity_px: Light
    """``u_left - u_right`` in pixels of the rig's own pictures, (H, W); NaN where the right camera does not
    see the point."""
    depth_std_m: Light
    """Expected standard deviation of the depth, (H, W), m; NaN where the right camera does not see it."""
    remarks: tuple[Remark, ...]
    """What a person should know of the scene and the rig's place in it."""


@dataclass(frozen=True, slots=True)
class Glimpse:
    """What is asked of `glance`."""

    rig: StereoRig
    """The rig that is assumed."""
    size_px: tuple[int, int] | None
    """Width and height that are drawn; None for the rig's own, or a coarse picture's."""
    coarse: bool
    """One sample a pixel and no shadows; else several samples, and shadows."""
    noise_px: float
    """Standard deviation of one pixel coordinate in the rig's own pictures, px."""
    built: StereoRig | None = None
    """The rig that takes the pictures, where it is another one."""


def picture_size(rig: StereoRig, coarse: bool) -> tuple[int, int]:
    """Width and height, px, of the pictures that are drawn unless a size is asked for: the left camera's, or
    less of its shape, for a coarse picture or one of more than `MOST_PIXELS`."""
    width, height = rig.left.width, rig.left.height
    most = COARSE_WIDTH_PX / width if coarse else math.sqrt(MOST_PIXELS / (width * height))
    scale = min(1.0, most)
    return max(1, round(width * scale)), max(1, round(height * scale))


def sized(rig: StereoRig, size_px: tuple[int, int]) -> StereoRig:
    """The rig with pictures of another size behind the same lenses."""
    own = ((rig.left.width, rig.left.height), (rig.right.width, rig.right.height))
    return rig if own == (size_px, size_px) else next(iter(RigGrid(base=rig, resolutions_px=(size_px,))))


def glance(simulator: Simulator, asked: Glimpse, between: Callable[[], None] = lambda: None) -> Glance:
    """Look at the simulator's scene.

    Args:
        simulator: the scene and what draws it.
        asked: the rig, and how it is drawn.
        between: is called between parts of the work; what it raises ends it.

    Raises:
        InvalidRange: the size or the noise cannot be.
        InvalidRig: the lens cannot be drawn.
        NothingSeen: a camera lies in a surface.
        RenderMismatch: the renderer disagrees with the rig or with rays.
        RenderUnavailable: the pictures are too large.
    """
    noise = as_noise(asked.noise_px)
    size_px = asked.size_px or picture_size(asked.rig, asked.coarse)
    rig = sized(asked.rig, size_px)
    built = rig if asked.built is None else sized(asked.built, size_px)
    frame = _frame(simulator, rig, built, asked.coarse, between)
    points = drawn_points(rig, frame.left.depth)
    disparity = drawn_disparity(rig, points, frame.right.depth)
    seen = np.isfinite(disparity)
    between()
    return Glance(
        left=frame.left.image,
        right=frame.right.image,
        depth_m=frame.left.depth.astype(np.float32),
        disparity_px=_of_own_pictures(asked.rig, rig, points, disparity),
        depth_std_m=_expected_std(asked.rig, points, seen, noise),
        remarks=simulator.remarks,
    )


def _of_own_pictures(rig: StereoRig, drawn: StereoRig, points: Array, disparity: Array) -> Light:
    """The disparity (H, W) of the drawn pictures in pixels of the rig's own."""
    if drawn is rig:
        return disparity.astype(np.float32)
    seen = np.isfinite(disparity)
    uv_left, uv_right = rig.project(points[seen])
    return _spread(uv_left[:, 0] - uv_right[:, 0], seen)


def _frame(
    simulator: Simulator, rig: StereoRig, built: StereoRig, coarse: bool, between: Callable[[], None]
) -> StereoFrame:
    """The pictures of the built rig, and the depths of the one that is assumed, with the left cameras in one
    place: there the two rigs differ by what moved the right one."""
    simulator.place(rig)
    depths = simulator.preview_depth(coarse)
    between()
    if built is not rig:
        simulator.place(built, rig.rig_from_left @ built.rig_from_left.inverse)
    left = simulator.preview_light(0, coarse)
    between()
    right = simulator.preview_light(1, coarse)
    between()
    return StereoFrame(View(left, *depths[0]), View(right, *depths[1]))


def _expected_std(rig: StereoRig, points: Array, seen: Mask, noise: PixelNoise) -> Light:
    """Standard deviation of the depth of the points (H, W, 3) that are seen, (H, W) m.

    It is predicted for one pixel of a block, and taken to the others by the square of their depth: exactly so
    for a rectified rig. For another rig that is done in large pictures alone, among pixels of nearly the same
    depth, and right to half a percent.
    """
    if rig.is_rectified:
        return _by_blocks(rig, points, seen, noise, _RECTIFIED_BLOCK, math.inf)
    if seen.size > _SMALL:
        return _by_blocks(rig, points, seen, noise, _BLOCK, _ALIKE)
    return _spread(predict_depth_std(rig, points[seen], noise), seen)


def _by_blocks(
    rig: StereoRig, points: Array, seen: Mask, noise: PixelNoise, block: int, alike: float
) -> Light:
    depth = points[..., 2]
    corners = points[::block, ::block].reshape(-1, 3)
    per_square = predict_depth_std(rig, corners, noise) / corners[:, 2] ** 2
    height, width = seen.shape
    rows, columns = np.arange(height) // block, np.arange(width) // block
    of = (rows[:, None] * (columns[-1] + 1) + columns)[seen]
    known, own = corners[of, 2], depth[seen]
    found = per_square[of] * own**2
    apart = ~(np.abs(own - known) <= alike * known)  # of a corner that shows nothing, too
    found[apart] = predict_depth_std(rig, points[seen][apart], noise)
    return _spread(found, seen)


def _spread(values: Array, where: Mask) -> Light:
    """Values (N,) of the pixels `where` (H, W) says, NaN elsewhere."""
    found = np.full(where.shape, np.nan, dtype=np.float32)
    found[where] = values
    return found
