"""Pictures of a held board, and the corners that are found in them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rigsim.pixels.corners.boards import find_sizes, nearest_order, refit
from rigsim.rig.arrays import GREY_WEIGHTS, Array
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.sensor import Sensor, Side
from rigsim.sim.exposure import digitise, optics
from rigsim.sim.faces import needs_faces
from rigsim.sim.lens import wider_intrinsics
from rigsim.sim.simulator import SUPERSAMPLE, Simulator
from rigsim.study.calibrate.witness.bench import CalibrationBench

SENSOR = Sensor(blur_px=0.6, full_well_e=10_000, read_noise_e=5.0, gain=24.0)
"""A small sensor in a dim room: noise, not what the renderer's samples shift them by, moves the corners."""

_RIM_PX = 16
"""Round a board's outer squares."""
_SIDES: tuple[Side, Side] = ("left", "right")


@dataclass(frozen=True, slots=True)
class _HeldView:
    """The part of one camera's picture that shows a board."""

    board: int
    side: int
    camera: Intrinsics
    """The camera of that part alone."""
    drawn: Intrinsics
    """What is drawn of it: finer, and straight where one pinhole is enough."""
    origin: Array
    """The camera's pixel that is the first of it, (2,)."""

    @property
    def resampled(self) -> bool:
        return self.camera.lens is not None and self.drawn.lens is None


def found_corners(
    bench: CalibrationBench,
    sensor: Sensor,
    count: int,
    seed: int,
    progress: Callable[[int, int], None] | None = None,
) -> Array:
    """Corners (count, n, 2, m, 2) px as found in `count` noisy pictures of each board by each camera.

    Each board is drawn once; each picture of it has noise of its own. The detector looks for the board in the
    first, and every corner is fitted in all of them. NaN where a camera is not to see a board, or the
    detector finds none.

    Args:
        bench: Boards, where they are held, and the cameras that look at them.
        sensor: Takes the pictures.
        count: Pictures of each board by each camera.
        seed: Of their noise.
        progress: Called with the numbers of pictures drawn, and to draw.
    """
    from rigsim.sim.scenes.held import held_board, hold

    exact, rig, board = bench.exact, bench.truth, bench.held
    corners = np.full((count, *exact.shape), np.nan)
    if not bench.seen.any():
        return corners
    far_m = float(np.linalg.norm(bench.poses.points_left(board.outline), axis=2).max())
    views = [_view(bench, n, side) for n, side in np.argwhere(bench.seen).tolist()]
    with Simulator(held_board(board, far_m)) as simulator:
        simulator.make_room(view.drawn for view in views)
        for done, view in enumerate(views):
            hold(simulator.scene, rig, board, Pose(bench.poses.R[view.board], bench.poses.t[view.board]))
            light = _light(simulator, view, sensor)
            rng = np.random.default_rng((seed, view.board, view.side))
            near = exact[view.board, view.side] - view.origin
            found = _found(light, near, board, sensor, rng, count)
            corners[:, view.board, view.side] = found + view.origin
            if progress:
                progress(done + 1, len(views))
    return corners


def _view(bench: CalibrationBench, board: int, side: int) -> _HeldView:
    """No more of the camera's picture than is about the board."""
    camera = (bench.truth.left, bench.truth.right)[side]
    rim = bench.poses.points_left(bench.held.outline)[board]
    uv = camera.project(rim if side == 0 else bench.truth.right_from_left.apply(rim))
    uv = np.concatenate([uv[np.isfinite(uv).all(axis=1)], bench.exact[board, side]])
    limit = np.array([camera.width, camera.height]) - 1
    first = np.clip(np.floor(uv.min(axis=0)) - _RIM_PX, 0, limit).astype(int)
    last = np.clip(np.ceil(uv.max(axis=0)) + _RIM_PX, 0, limit).astype(int)
    part = camera.cropped(int(first[0]), int(first[1]), *(int(size) for size in last - first + 1))
    straight = part.lens is not None and not needs_faces(part)
    drawn = wider_intrinsics(part, SUPERSAMPLE) if straight else part.supersampled(SUPERSAMPLE)
    return _HeldView(board, side, part, drawn, first.astype(np.float64))


def _light(simulator: Simulator, view: _HeldView, sensor: Sensor) -> Array:
    """Grey light (H, W) on the pixels, lens and blur included."""
    fine = simulator.light(view.side, view.drawn).astype(np.float64) @ np.asarray(GREY_WEIGHTS)
    side = _SIDES[view.side]
    if view.resampled:
        return optics(fine, sensor, side, supersample=SUPERSAMPLE, wide=view.drawn, camera=view.camera)
    return optics(fine, sensor, side, supersample=SUPERSAMPLE)


def _found(
    light: Array, near: Array, board: Board, sensor: Sensor, rng: np.random.Generator, count: int
) -> Array:
    """Corners (count, m, 2) px found in noisy pictures of one light; NaN where there is none.

    They are in the order that lies nearest to `near` (m, 2): whoever holds the board knows which way up.
    """
    corners = np.full((count, len(near), 2), np.nan)
    boards = find_sizes(digitise(light, sensor, rng), [(board.rows, board.cols)], limit=1)
    if not boards:
        return corners
    order = nearest_order(boards[0], near)
    corners[0] = boards[0].uv[order]
    for k in range(1, count):
        corners[k] = refit(digitise(light, sensor, rng), boards[0])[order]
    return corners
