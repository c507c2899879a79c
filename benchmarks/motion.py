"""Cameras that are not triggered at once, against rendered pairs: the right picture from the moved rig."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from rigsim.pixels.corners.boards import find_sizes
from rigsim.rig.arrays import Array
from rigsim.rig.motion import Motion
from rigsim.rig.pose import Pose
from rigsim.rig.presets import preset
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig
from rigsim.sim.exposure import expose
from rigsim.sim.simulator import Simulator
from rigsim.study.calc.motion import shift_of
from rigsim.theory.triangulation import triangulate

SUPERSAMPLE = 4
LIMIT_PX = 0.02

PLAIN = preset("boards").rig
TOED_IN = StereoRig.verged(PLAIN.left, 0.2, 4.0)
CASES = (
    ("rig sideways", PLAIN, Motion(0.005, 0.5)),
    ("rig forward", PLAIN, Motion(0.005, 0.0, 2.0)),
    ("rig turns right", PLAIN, Motion(0.002, turn_rate_rad_s=math.radians(30))),
    ("rig turns left, early", PLAIN, Motion(-0.004, turn_rate_rad_s=-math.radians(45))),
    ("rig, all at once", PLAIN, Motion(0.004, -0.7, 1.5, math.radians(40))),
    ("rig toed in, all at once", TOED_IN, Motion(0.004, 0.7, -1.5, math.radians(40))),
    ("object sideways", PLAIN, Motion(0.005, 0.5, moving="object")),
    ("object away, rig turns", PLAIN, Motion(0.005, 0.0, 1.0, math.radians(20), moving="object")),
    ("object across, toed in", TOED_IN, Motion(0.006, -0.8, 0.5, moving="object")),
)


def run() -> None:
    """Print shifts as measured in rendered corners against those predicted, and the depths they make."""
    print(
        f"boards, 1280 x 720 px, supersampled {SUPERSAMPLE}; right corners, late minus in time; limit .02 px"
    )
    print(
        f"{'case':26} {'corners':>7} {'shift, px':>10} {'error rms':>10} {'largest':>8} {'mean u':>8}"
        f" {'mean v':>8} {'depth error, mm':>16} {'measured/pred.':>15}"
    )
    with Simulator("boards") as simulator:
        for name, rig, motion in CASES:
            seen = measure(simulator, rig, motion)
            error = seen.measured - seen.predicted
            size = np.hypot(*error.T)
            shift = float(np.sqrt((seen.predicted**2).sum(axis=1).mean()))
            slope = float(seen.depth_measured_m @ seen.depth_predicted_m / (seen.depth_predicted_m**2).sum())
            depth_mm = float(np.sqrt((seen.depth_predicted_m**2).mean())) * 1e3
            flag = "" if np.sqrt((size**2).mean()) < LIMIT_PX else "  over"
            print(
                f"{name:26} {len(error):7d} {shift:10.3f} {np.sqrt((size**2).mean()):10.4f} {size.max():8.4f}"
                f" {error[:, 0].mean():8.4f} {error[:, 1].mean():8.4f} {depth_mm:16.2f} {slope:15.4f}{flag}"
            )


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """Corners (N,) that both right pictures show."""

    measured: Array
    """How far each moved in the pictures (N, 2), px."""
    predicted: Array
    """How far it does by projection."""
    depth_measured_m: Array
    """Depth found with the late picture minus that with the one in time, m."""
    depth_predicted_m: Array
    """The same predicted, m."""


def measure(simulator: Simulator, rig: StereoRig, motion: Motion) -> Seen:
    """Render the pair in time and the right picture that is late, and find the corners in all three."""
    left, in_time = (corners(simulator, rig, side) for side in (0, 1))
    points = simulator.true_corners().points_left
    sizes = simulator.true_corners().sizes
    visible = np.isfinite(rig.project(points)[1]).all(axis=1)
    points, sizes = points[visible], sizes[visible]
    moved_rig, moved_object = brute_force(rig, motion)
    late = corners(simulator, rig, 1, moved_rig, moved_object)
    # the board's own order of corners pairs the two right pictures; no prediction does
    now, then = paired(in_time, late)
    near, place = KDTree(rig.project(points)[1]).query(now)
    left_uv = np.concatenate(left_all(left))
    near_left, place_left = KDTree(left_uv).query(rig.project(points[place])[0])
    keep = (near < 0.5) & (near_left < 0.5)
    now, then, true, uv_left = now[keep], then[keep], points[place[keep]], left_uv[place_left[keep]]
    shift = shift_of(rig, motion, true)
    found = [triangulate(rig, uv_left, uv)[:, 2] for uv in (then, now)]
    predicted = np.column_stack([shift.along_px, shift.across_px])
    return Seen(then - now, predicted, found[0] - found[1], shift.depth_error_m)


def brute_force(rig: StereoRig, motion: Motion) -> tuple[Pose, Array]:
    """Where the rig is off its mount when the right picture is taken, in its own axes; and how far things
    have moved meanwhile, in the same axes: by hand, without `Motion.apply`."""
    angle, dt = motion.turn_rate_rad_s * motion.time_offset_s, motion.time_offset_s
    turn = np.array(
        [[math.cos(angle), 0, math.sin(angle)], [0, 1, 0], [-math.sin(angle), 0, math.cos(angle)]]
    )
    way = np.array([motion.speed_m_s, 0.0, motion.forward_speed_m_s]) * dt
    nothing = np.zeros(3)
    return (Pose(turn, way), nothing) if motion.moving == "rig" else (Pose(turn, nothing), way)


Boards = dict[tuple[int, int, int], Array]
"""Corners (N, 2) px of each board, by its size and its place from left to right among those of its size."""


def corners(
    simulator: Simulator, rig: StereoRig, side: int, moved: Pose | None = None, things: Array | None = None
) -> Boards:
    """Corners in one picture; `things` (3,) m moves every body of the world, in the rig's axes."""
    scene = simulator.scene
    kept = scene.model.body_pos.copy()
    if things is not None:
        on_floor = scene.model.body_parentid == 0
        scene.model.body_pos[on_floor] += scene.world_from_rig.R @ things
    try:
        simulator.place(rig, moved)
        frame = simulator.render(SUPERSAMPLE)
    finally:
        scene.model.body_pos[:] = kept
        if things is not None:
            simulator.place(rig)
    light = (frame.left, frame.right)[side].light
    picture = expose(light, Sensor(), np.random.default_rng(0), ("left", "right")[side])
    wanted = sorted({tuple(int(n) for n in size) for size in simulator.true_corners().sizes})
    found: Boards = {}
    for board in find_sizes(picture, wanted):
        rank = sum(key[:2] == (board.rows, board.cols) for key in found)
        found[board.rows, board.cols, rank] = np.where(board.valid[:, None], board.uv, np.nan)
    return found


def paired(one: Boards, other: Boards) -> tuple[Array, Array]:
    """Corners of the boards that both pictures show, in the same order."""
    same = [key for key in one if key in other]
    first, second = (np.concatenate([boards[key] for key in same]) for boards in (one, other))
    known = np.isfinite(first).all(axis=1) & np.isfinite(second).all(axis=1)
    return first[known], second[known]


def left_all(boards: Boards) -> list[Array]:
    """Corners of every board, those that were not fitted left out."""
    return [uv[np.isfinite(uv).all(axis=1)] for uv in boards.values()]
