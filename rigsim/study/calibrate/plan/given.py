"""Poses that somebody gave: which of them count."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigsim.rig.arrays import Mask
from rigsim.rig.remark import Remark
from rigsim.study.calibrate.plan.asked import PlanAsked
from rigsim.study.calibrate.plan.held import middle_of, smallest_square_px
from rigsim.study.calibrate.plan.reach import LEAST_SQUARE_PX, ReachedPoses
from rigsim.theory.calibration.boards import BoardPoses, whole

_MOST_NUMBERS = 12


def counted(asked: PlanAsked, poses: BoardPoses) -> tuple[ReachedPoses, tuple[Remark, ...]]:
    """The poses that a camera sees whole, and what is odd about the others."""
    uv = poses.project(asked.rig, asked.board)
    seen = whole(asked.rig, uv)
    remarks = [*_left_out(asked, poses, seen)]
    one = np.asarray(seen.any(axis=1) & ~seen.all(axis=1))
    if one.any():
        remarks.append(
            Remark(
                "one_camera",
                f"{_boards(one)} seen whole by one camera alone: counted for that camera only",
            )
        )
    middle = poses.points_left(middle_of(asked.board)[None])[:, 0]
    behind = (np.einsum("ni,ni->n", middle, poses.R[:, :, 2]) < 0) & seen.any(axis=1)
    if behind.any():
        remarks.append(
            Remark(
                "back",
                f"{_boards(behind)} seen from the back (+z of a board points away from a camera that sees its"
                " front): counted as if the pattern showed there too",
            )
        )
    with np.errstate(invalid="ignore"):
        small = np.asarray(((smallest_square_px(uv, asked.board) < LEAST_SQUARE_PX) & seen).any(axis=1))
    if small.any():
        remarks.append(
            Remark(
                "small_squares",
                f"{_boards(small)} seen with squares under {LEAST_SQUARE_PX:g} px: corner finders may miss"
                " them; hold them nearer, or take larger squares",
            )
        )
    kept = np.asarray(seen.any(axis=1))
    return ReachedPoses(poses.chosen(kept), seen[kept]), tuple(remarks)


def _left_out(asked: PlanAsked, poses: BoardPoses, seen: Mask) -> list[Remark]:
    remarks = []
    lost = ~seen.any(axis=1)
    behind = lost & (poses.points_left(middle_of(asked.board)[None])[:, 0, 2] <= 0)
    cut = lost & ~behind
    if behind.any():
        remarks.append(
            Remark(
                "behind", f"{_boards(behind)} behind the left camera: left out; the poses are left_from_board"
            )
        )
    if cut.any():
        remarks.append(
            Remark(
                "not_whole", f"{_boards(cut)} seen whole by neither camera: left out; move into both views"
            )
        )
    board = asked.board
    if not seen.all() and board.cols != board.rows:
        turned = replace(board, cols=board.rows, rows=board.cols, warp_m=board.warp_m[::-1])
        # more of all pictures, and none that is lost by it
        instead = whole(asked.rig, poses.project(asked.rig, turned))
        if instead.sum() > seen.sum() and (instead | ~seen).all():
            remarks.append(
                Remark(
                    "board_swapped",
                    f"board {board.text} is seen whole in {seen.sum()} of {seen.size} pictures,"
                    f" {turned.text} in {instead.sum()}: columns run along a board's x, rows along its y",
                )
            )
    return remarks


def _boards(which: Mask) -> str:
    """``board 3 is``, ``boards 3, 7 are``: counted from 1."""
    numbers = [str(k + 1) for k in np.flatnonzero(which)]
    if len(numbers) == len(which) > 1:
        return f"all {len(numbers)} boards are"
    listed = ", ".join(numbers[:_MOST_NUMBERS]) + (", ..." if len(numbers) > _MOST_NUMBERS else "")
    return f"board {listed} is" if len(numbers) == 1 else f"{len(numbers)} boards ({listed}) are"
