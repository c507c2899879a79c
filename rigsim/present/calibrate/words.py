"""What is said of calibrations: parameters by name, how a board is held, what stands in the way."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

from rigsim.present.kit.format import plain
from rigsim.rig.board import Board
from rigsim.study.calibrate.holding import Holding

_POSE: Mapping[str, str] = MappingProxyType(
    {
        "rx_rad": "the pitch between the cameras",
        "ry_rad": "the yaw between the cameras",
        "rz_rad": "the roll between the cameras",
        "tx_m": "the baseline",
        "ty_m": "the vertical shift between the cameras",
        "tz_m": "the axial shift between the cameras",
        "warp_x_m": "the board's warp along its rows",
        "warp_y_m": "the board's warp along its columns",
        "frame.rx_rad": "the turn of the boards about x",
        "frame.ry_rad": "the turn of the boards about y",
        "frame.rz_rad": "the turn of the boards about z",
        "frame.tx_m": "where the boards are along x",
        "frame.ty_m": "where the boards are along y",
        "frame.tz_m": "where the boards are along z",
    }
)
_CAMERA: Mapping[str, str] = MappingProxyType(
    {
        "fx": "focal length fx",
        "fy": "focal length fy",
        "cx": "principal point u",
        "cy": "principal point v",
    }
)
_STEP_DEG = 5
_LEVEL_DEG = 20
"""Turns up to this are seen in the picture, and do not matter."""
_UPRIGHT_DEG = 80


def parameter(name: str) -> str:
    """A parameter of `RigParameters`, as a sentence calls it: ``the left principal point u``."""
    if name in _POSE:
        return _POSE[name]
    side, _, own = name.partition(".")
    return f"the {side} {_CAMERA.get(own, own)}"


def parameter_head(name: str) -> str:
    """The same at the head of a table's row."""
    return parameter(name).removeprefix("the ").removesuffix(" between the cameras")


def board_words(board: Board) -> str:
    """``9x6 board of 30 mm squares``."""
    return f"{board.cols}x{board.rows} board of {plain(board.square_m * 1e3)} mm squares"


def pictures(count: int) -> str:
    """``1 picture``, ``15 pictures``: by each camera."""
    return f"{count} picture" + ("" if count == 1 else "s")


def place_words(across: float, down: float) -> str:
    """Where in the picture: ``upper left``, ``middle``."""
    column = "left" if across < 1 / 3 else "right" if across > 2 / 3 else ""
    row = "upper" if down < 1 / 3 else "lower" if down > 2 / 3 else ""
    if row and column:
        return f"{row} {column}"
    return column or {"upper": "top", "lower": "bottom", "": "middle"}[row]


def distance_words(distance_m: float) -> str:
    """As one measures it by hand: ``60 cm``, ``1.2 m``."""
    if distance_m < 1.5:
        step = 5 if distance_m >= 0.2 else 1
        return f"{step * round(distance_m * 100 / step)} cm"
    return f"{distance_m:.1f} m"


def tilt_words(held: Holding) -> str:
    """How the board is tilted: ``upper edge 30° away``."""
    degrees = _STEP_DEG * round(math.degrees(held.tilt_rad) / _STEP_DEG)
    if degrees == 0:
        return "facing the cameras"
    what = "corner" if " " in held.away else "edge"
    return f"{held.away} {what} tilted {degrees}° away"


def turn_words(held: Holding) -> str:
    """How the board is turned in the picture; empty where its rows are level."""
    degrees = math.degrees(held.turn_rad)
    if abs(degrees) <= _LEVEL_DEG:
        return ""
    rounded = _STEP_DEG * round(abs(degrees) / _STEP_DEG)
    if rounded >= _UPRIGHT_DEG:
        return "on its side"
    return f"turned {rounded}° {'clockwise' if degrees > 0 else 'anticlockwise'}"


def seen_words(held: Holding) -> str:
    """Which camera sees the board, where not both do."""
    return {
        (True, True): "",
        (True, False): "only the left camera sees it whole",
        (False, True): "only the right camera sees it whole",
        (False, False): "no camera sees it whole",
    }[held.seen]


def holding_words(held: Holding) -> str:
    """How a board is held, in one line."""
    said = (
        f"{distance_words(held.distance_m)} away",
        place_words(held.across, held.down),
        tilt_words(held),
        turn_words(held),
        seen_words(held),
    )
    return ", ".join(word for word in said if word)
