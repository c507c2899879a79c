"""How a person holds the board for each pose of a plan: how far, where in the picture, turned how."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.board import Board
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.plan.held import facing
from rigsim.theory.calibration.boards import BoardPoses

Edge: TypeAlias = Literal[
    "right", "lower right", "lower", "lower left", "left", "upper left", "upper", "upper right"
]
EDGES: tuple[Edge, ...] = (
    "right",
    "lower right",
    "lower",
    "lower left",
    "left",
    "upper left",
    "upper",
    "upper right",
)
"""Edges and corners as the picture shows them, clockwise."""


@dataclass(frozen=True, slots=True)
class Holding:
    """One board, as somebody holds it; left and right, up and down are those of the picture."""

    distance_m: float
    """From the left camera to the board's middle, m."""
    across: float
    """Where its middle is in the picture of the camera that sees it, the left one of two: 0 left, 1 right."""
    down: float
    """0 at the top, 1 at the bottom."""
    tilt_rad: float
    """How far it is turned out of the picture's plane, rad; where that is far off the axis, out of facing the
    camera."""
    away: Edge
    """The edge or corner that lies farther away than the middle."""
    turn_rad: float
    """How far the rows of corners are turned clockwise in the picture, rad, above -pi/2 to pi/2."""
    seen: tuple[bool, bool]
    """Whether the left and the right camera see it whole."""


def holdings(
    rig: StereoRig, board: Board, poses: BoardPoses, seen: np.typing.NDArray[np.bool_]
) -> list[Holding]:
    """How each of n poses is held; `seen` (n, 2) says which cameras see it whole."""
    middle = np.append(np.array(board.size_m) / 2, 0.0)
    return [
        _held(rig, board, (R, R @ middle + t), (bool(sees[0]), bool(sees[1])))
        for R, t, sees in zip(poses.R, poses.t, seen, strict=True)
    ]


def _held(rig: StereoRig, board: Board, at: tuple[Array, Array], seen: tuple[bool, bool]) -> Holding:
    R, middle_left = at
    right_only = seen == (False, True)
    camera = rig.right if right_only else rig.left
    middle = rig.right_from_left.apply(middle_left[None]) if right_only else middle_left[None]
    uv = camera.project(middle)[0]
    # as `facing` has it: a board far out is upright when it faces the camera
    upright = facing(board, middle_left[None], np.eye(3)[None]).R[0]
    turned = upright.T @ R
    if turned[2, 2] < 0:  # its back is shown: what is seen of it is turned the same
        turned = turned @ np.diag([-1.0, 1.0, -1.0])
    recedes = math.atan2(-float(turned[1, 2]), -float(turned[0, 2]))
    turn = math.atan2(float(turned[1, 0]), float(turned[0, 0]))
    if not -math.pi / 2 < turn <= math.pi / 2:
        turn -= math.copysign(math.pi, turn)
    return Holding(
        float(np.linalg.norm(middle_left)),
        float(uv[0] / (camera.width - 1)),
        float(uv[1] / (camera.height - 1)),
        math.acos(min(float(turned[2, 2]), 1.0)),
        EDGES[round(recedes / (math.pi / 4)) % 8],
        turn,
        seen,
    )
