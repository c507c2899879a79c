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

SENSOR = Sensor(blur_px=0.6, full_well_e=10_000, read_noise_e=5.0, gain=8.0)
"""A small machine-vision sensor in a dim room: noise, not the renderer's samples, is what moves a corner."""

_RIM_PX = 16
"""Round a board's outer squares."""
_SIDES: tuple[Side, Side] = ("left", "right")


@dataclass(frozen=True, slots=True)
class _Picture:
    """One camera's light about one board."""

    light: Array
    """(H, W), 0 to 1."""
    corner: tuple[int, int]
    """The camera's pixel that is the first of it, (u, v)."""


def found_corners(
    bench: CalibrationBench,
    sensor: Sensor,
    count: int,
    seed: int,
    progress: Callable[[int], None] | None = None,
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
        progress: Called with the number of boards done.
    """
    from rigsim.sim.scenes.held import hold, held_board

    exact, rig, board = bench.exact, bench.truth, bench.held
    corners = np.full((count, *exact.shape), np.nan)
    far_m = float(np.linalg.norm(bench.poses.points_left(board.outline), axis=2).max())
    with Simulator(held_board(board, far_m)) as simulator:
        for n in range(len(bench.poses)):
            left_from_board = Pose(bench.poses.R[n], bench.poses.t[n])
            hold(simulator.scene, rig, board, left_from_board)
            for side in np.flatnonzero(bench.seen[n]):
                picture = _picture(simulator, bench, n, int(side), sensor)
                rng = np.random.default_rng((seed, n, int(side)))
                corners[:, n, side] = _corners(picture, exact[n, side], board, sensor, rng, count)
            if progress:
                progress(n + 1)
    return corners


def _picture(
    simulator: Simulator, bench: CalibrationBench, n: int, side: int, sensor: Sensor
) -> _Picture:
    """What one camera sees of the board that is held, no more than about it."""
    camera = (bench.truth.left, bench.truth.right)[side]
    rim = bench.poses.points_left(bench.held.outline)[n]
    uv = camera.project(rim if side == 0 else bench.truth.right_from_left.apply(rim))
    uv = np.where(np.isfinite(uv), uv, bench.exact[n, side].mean(axis=0))
    limit = np.array([camera.width, camera.height])
    first = np.clip(np.floor(uv.min(axis=0)).astype(int) - _RIM_PX, 0, limit - 1)
    last = np.clip(np.ceil(uv.max(axis=0)).astype(int) + _RIM_PX, 0, limit - 1)
    part = camera.cropped(int(first[0]), int(first[1]), *(int(size) for size in last - first + 1))
    light = light_through(simulator, side, part, sensor)
    return _Picture(light, (int(first[0]), int(first[1])))


def light_through(simulator: Simulator, side: int, camera: Intrinsics, sensor: Sensor) -> Array:
    """Grey light (H, W) on one camera's pixels, lens and blur included."""
    resampled = camera.lens is not None and not needs_faces(camera)
    drawn = wider_intrinsics(camera, SUPERSAMPLE) if resampled else camera.supersampled(SUPERSAMPLE)
    fine = simulator.light(side, drawn, 1).astype(np.float64) @ np.asarray(GREY_WEIGHTS)
    geometry = {"wide": drawn, "camera": camera} if resampled else {}
    return optics(fine, sensor, _SIDES[side], supersample=SUPERSAMPLE, **geometry)


def _corners(
    picture: _Picture, exact: Array, board: Board, sensor: Sensor, rng: np.random.Generator, count: int
) -> Array:
    """Corners (count, m, 2) px found in noisy pictures; NaN where there is none.

    They are in the order that lies nearest to `exact` (m, 2): whoever holds the board knows which way up.
    """
    found = np.full((count, len(exact), 2), np.nan)
    image = digitise(picture.light, sensor, rng)
    boards = find_sizes(image, [(board.rows, board.cols)], limit=1)
    if not boards:
        return found
    origin = np.array(picture.corner, dtype=np.float64)
    order = nearest_order(boards[0], exact - origin)
    found[0] = boards[0].uv[order]
    for k in range(1, count):
        found[k] = refit(digitise(picture.light, sensor, rng), boards[0])[order]
    return found + origin
