"""Why no board can be held into both pictures, and what would do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.study.calibrate.plan.asked import PlanAsked
from rigsim.study.calibrate.plan.held import LEAST_SQUARE_PX, facing
from rigsim.theory.calibration.boards import BoardPoses

Seen = Callable[[PlanAsked, BoardPoses], bool]
"""Whether both cameras see one of the poses whole, of what is asked for."""
_STEP = 1.1
_FARTHEST = 60
_ROOM = 1.25
"""Beyond what only just fits."""
_GRID = (13, 9)


def out_of_reach(asked: PlanAsked, seen: Seen) -> InvalidRange:
    """What to say of a board that never fits both views."""
    near, far = asked.reach.near_m, asked.reach.far_m
    left, right = asked.rig.left, asked.rig.right
    focal = min(float(np.min(np.abs(camera.axial_focal_px))) for camera in (left, right))
    square_px = focal * asked.board.square_m / near
    if square_px < LEAST_SQUARE_PX:
        wanted = _rounded(asked.board.square_m * LEAST_SQUARE_PX / square_px * _ROOM)
        return InvalidRange(
            f"board {asked.board.text}: squares too small ({square_px:.2g} px at {near * 1e3:g} mm, finders"
            f" need {LEAST_SQUARE_PX:g} px): take squares of {wanted * 1e3:g} mm, or hold it nearer"
        )
    board = f"board {asked.board.text}"
    where = f"from {near * 1e3:g} to {far * 1e3:g} mm"
    ways = []
    for steps in range(1, _FARTHEST):
        farther, nearer = far * _STEP**steps, near / _STEP**steps
        for distance, room, words in ((farther, _ROOM, "farther off"), (nearer, 1 / _ROOM, "nearer")):
            if _at(asked, distance, seen):
                ways.append(f"hold it {words}, as at {_rounded(distance * room) * 1e3:g} mm")
                break
        if ways:
            break
    for steps in range(1, _FARTHEST):
        smaller = replace(asked.board, square_m=asked.board.square_m / _STEP**steps, warp_m=(0.0, 0.0))
        changed = replace(asked, board=smaller)
        if any(_at(changed, distance, seen) for distance in (near, (near + far) / 2, far)):
            ways.append(f"take squares of {_rounded(smaller.square_m / _ROOM) * 1e3:g} mm")
            break
    if not ways:
        return InvalidRange(
            f"{board}: no place {where} is seen by both cameras; their views do not overlap there"
        )
    return InvalidRange(f"{board}: never fits both views {where}: {', or '.join(ways)}")


def _at(asked: PlanAsked, distance_m: float, seen: Seen) -> bool:
    """Whether the board fits both views at a distance, parallel to the left picture."""
    left = asked.rig.left
    u, v = np.meshgrid(np.linspace(0, left.width - 1, _GRID[0]), np.linspace(0, left.height - 1, _GRID[1]))
    rays = left.ray(np.column_stack([u.ravel(), v.ravel()]))
    middle = rays[np.isfinite(rays).all(axis=1)] * distance_m
    reach = replace(asked.reach, near_m=distance_m, far_m=distance_m)
    turn = np.broadcast_to(np.eye(3), (len(middle), 3, 3))
    return seen(replace(asked, reach=reach), facing(asked.board, middle, turn))


def _rounded(value_m: float) -> float:
    """Two figures."""
    return float(f"{value_m:.2g}")
