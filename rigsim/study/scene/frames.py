"""A data set: one rig in one scene, looked at from many places, one frame in memory at a time."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRange, NothingSeen
from rigsim.rig import extent
from rigsim.rig.arrays import AnyImage, Array, Image, Mask
from rigsim.rig.pose import Pose
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.sim.simulator import SUPERSAMPLE, Simulator
from rigsim.sim.truth.points import at_depth
from rigsim.study.scene.pictures import Pictures, expose_pair

MOVE_SHARE = 0.05
"""How far a frame is moved along each axis unless it is said, share of the first frame's median depth."""
TURN_DEG = 3.0
"""How far a frame is turned about each axis unless it is said, deg."""

_TRIES = 50
_PROBES = 512
_LEAST_SHARE = 0.5  # of what the first frame sees, and of how near it is to the nearest thing


@dataclass(frozen=True, slots=True, eq=False)
class DatasetFrame:
    """One stereo pair with its truth."""

    index: int
    """Number of the frame, from 0."""
    rig: StereoRig
    """The calibration that the pictures are handed on with."""
    pictures: Pictures
    """Grey levels of both pictures, (H, W), uint8, or uint16 whose upper bits are the sensor's."""
    depth_left: Array
    """Depth at the left pixels' centres, (H, W), m; NaN for nothing."""
    depth_right: Array
    """Depth at the right pixels' centres, (H, W), m; NaN for nothing."""
    seen_by_both: Mask
    """Left pixels whose point the right camera sees too, (H, W)."""
    left_from_world: Pose
    """Where the left camera was; the world is the scene's, its z up."""

    def disparity(self, side: int) -> Array:
        """``u_left - u_right`` of each left (0) or right (1) pixel's point, seen by the other camera or not.

        (H, W), px; NaN for nothing. Only a rectified rig has it.
        """
        depth = (self.depth_left, self.depth_right)[side]
        return self.rig.left.fx * self.rig.baseline_m / depth - self.rig.doffs_px

    def cloud(self, at_most: int) -> tuple[Array, Image]:
        """Points (N, 3), m, in the left camera's frame, of every so many left pixels; their grey (N, 3)."""
        step = max(1, math.ceil(math.sqrt(self.depth_left.size / at_most)))
        depth = self.depth_left[::step, ::step]
        v, u = np.nonzero(np.isfinite(depth))
        uv = step * np.column_stack([u, v]).astype(np.float64)
        image = self.pictures.left[::step, ::step][v, u]
        grey = image if image.dtype == np.uint8 else image >> 8
        return at_depth(self.rig.left, uv, depth[v, u]), np.repeat(grey.astype(np.uint8)[:, None], 3, axis=1)


@dataclass(frozen=True, slots=True, kw_only=True)
class Views:
    """Which views of a scene are taken.

    Raises:
        InvalidRange: a number out of bounds.
    """

    count: int
    """How many frames."""
    seed: int
    """Of viewpoints and noise."""
    move_m: float | None = None
    """Farthest move along each axis; by default `MOVE_SHARE` of the first frame's median depth."""
    turn_deg: float = TURN_DEG
    """Farthest turn about each axis."""
    nearest_m: float = 0.0
    """Views of something nearer are drawn again, but for the first frame's."""

    def __post_init__(self) -> None:
        extent.FRAMES.check(self.count)
        if self.seed < 0:
            raise InvalidRange(f"seed {self.seed}: must be >= 0")
        if not 0 <= self.turn_deg <= 90:
            raise InvalidRange(f"turn {self.turn_deg:g} deg: must be >= 0 and <= 90")
        if self.move_m is not None and not 0 <= self.move_m < math.inf:
            raise InvalidRange(f"move {self.move_m:g} m: must be >= 0")

    def reach_m(self, median_m: float) -> float:
        """Farthest move, m, where the first frame's median depth is `median_m`."""
        return MOVE_SHARE * median_m if self.move_m is None else self.move_m


def render_frames(
    simulator: Simulator, rig: StereoRig, views: Views, sensor: Sensor
) -> Iterator[DatasetFrame]:
    """Frames of `rig` in the simulator's scene: the first one on the mount, the others moved and turned.

    Every frame has random numbers of its own, found from the seed and its number.

    Args:
        simulator: the scene and what draws it.
        rig: the rig.
        views: how many, and from where.
        sensor: takes the pictures; with 8 to 16 bits.

    Raises:
        InvalidRange: the sensor has no bits.
        NothingSeen: the rig sees nothing, or no view within reach sees as much.
    """
    if not sensor.bits:
        raise InvalidRange("sensor bits 0: a data set's pictures are whole numbers; give it 8, 10, 12 or 16")
    simulator.place(rig)
    first = _view(simulator, rig)
    if first.share == 0:
        raise NothingSeen(
            f"scene {simulator.scene.name}: the left camera at {simulator.scene.mount} sees nothing; "
            f"the scene has {', '.join(simulator.scene.mounts)} for --mount"
        )
    for index in range(views.count):
        yield _drawn(simulator, rig, index, views, sensor, first)


def _drawn(
    simulator: Simulator, rig: StereoRig, index: int, views: Views, sensor: Sensor, first: _View
) -> DatasetFrame:
    """The frame of the first view drawn that will do."""
    rng = np.random.default_rng((views.seed, index))
    reach_m = views.reach_m(first.median_m)
    least_m = max(views.nearest_m, _LEAST_SHARE * first.nearest_m)
    for _ in range(_TRIES):
        shift = rng.uniform(-1, 1, 6) * (0.0 if index == 0 else 1.0)
        simulator.place(rig, Pose.from_rotvec(np.radians(views.turn_deg) * shift[:3], reach_m * shift[3:]))
        seen = _view(simulator, rig)
        if index and not (seen.share >= _LEAST_SHARE * first.share and seen.nearest_m >= least_m):
            continue
        try:
            frame = _frame(simulator, rig, index, sensor, rng)
        except NothingSeen:
            if index == 0:
                raise
            continue  # a camera went into a surface
        if index == 0 or not (frame.depth_left < views.nearest_m).any():
            return frame
    raise NothingSeen(
        f"scene {simulator.scene.name}: of {_TRIES} views within {reach_m * 1e3:.3g} mm and"
        f" {views.turn_deg:g} deg none will do: half of what the mount's sees, and nothing nearer than"
        f" {least_m:.3g} m; give a smaller --move or --turn"
    )


def _frame(
    simulator: Simulator, rig: StereoRig, index: int, sensor: Sensor, rng: np.random.Generator
) -> DatasetFrame:
    exposure = expose_pair(simulator, rig, sensor, SUPERSAMPLE)
    taken = exposure.pictures(sensor, rng)
    return DatasetFrame(
        index=index,
        rig=rig,
        pictures=Pictures(_levels(taken.left, sensor), _levels(taken.right, sensor)),
        depth_left=exposure.frame.left.depth,
        depth_right=exposure.frame.right.depth,
        seen_by_both=np.isfinite(simulator.true_disparity(exposure.frame)),
        left_from_world=simulator.left_from_world,
    )


def _levels(image: AnyImage, sensor: Sensor) -> AnyImage:
    """Whole grey levels that fill their type, so that readers of 8 bits see 10 and 12 as well."""
    levels = np.clip(np.rint(image), 0, sensor.full_scale)
    if sensor.bits == 8:
        return levels.astype(np.uint8)
    return levels.astype(np.uint16) << np.uint16(16 - sensor.bits)


@dataclass(frozen=True, slots=True)
class _View:
    """The share of the left image that shows something, its nearest and its median depth, m."""

    share: float
    nearest_m: float
    median_m: float


def _view(simulator: Simulator, rig: StereoRig) -> _View:
    side = math.isqrt(_PROBES)
    u = np.linspace(0, rig.left.width - 1, side)
    v = np.linspace(0, rig.left.height - 1, side)
    uv = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    depth = simulator.points_at(uv)[0][:, 2]
    depth = depth[np.isfinite(depth)]
    if not len(depth):
        return _View(0.0, math.inf, math.inf)
    return _View(len(depth) / len(uv), float(depth.min()), float(np.median(depth)))
