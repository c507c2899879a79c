"""poses.json: where a calibration's board is held."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rigsim import foreign
from rigsim.errors import InvalidRange
from rigsim.interop.formats.values import clipped, shown
from rigsim.rig.board import Board
from rigsim.theory.calibration.boards import BoardPoses

KEY = "left_from_board"
"""The key of the poses: of each the rotation vector, rad, and the translation, m."""
_FORM = '{"left_from_board": [[rx, ry, rz, tx, ty, tz], ...]}, rad and m'


def read_poses(path: str | Path) -> BoardPoses:
    """The poses in a poses.json; keys that it has besides are passed over.

    Raises:
        OutputError, InvalidRange: as `read_recorded_poses`.
    """
    return read_recorded_poses(path)[0]


def read_recorded_poses(path: str | Path) -> tuple[BoardPoses, Board | None]:
    """The poses in a poses.json, and the board that they were recorded with; None where it says none.

    Raises:
        OutputError: the file cannot be read, or is too large.
        InvalidRange: it holds no poses.
    """
    try:
        text = foreign.read_text(path, f"a poses file, {_FORM}")
    except UnicodeDecodeError:
        raise InvalidRange(f"{path}: no JSON (not UTF-8 text): must be {_FORM}") from None
    try:
        found = json.loads(text)
    except (ValueError, RecursionError) as error:
        why = clipped(str(error))
        raise InvalidRange(f"{path}: no JSON ({why}): must be {_FORM}") from None
    if not isinstance(found, dict) or KEY not in found:
        keys = ", ".join(map(str, list(found)[:8])) if isinstance(found, dict) else shown(found)
        raise InvalidRange(f"{path}: no {KEY} (found {clipped(keys) or 'nothing'}): must be {_FORM}")
    rows = found[KEY]
    if not isinstance(rows, list):
        raise InvalidRange(f"{path}: {KEY} {shown(rows)}: must be {_FORM}")
    if not rows:
        raise InvalidRange(f"{path}: {KEY} is empty: give two poses at least, {_FORM}")
    for place, row in enumerate(rows, 1):
        _check_row(row, f"{path}: pose {place}")
    return BoardPoses.of(rows), _board(found.get("board"))


def _board(text: object) -> Board | None:
    try:
        return Board.of(text) if isinstance(text, str) else None
    except InvalidRange:  # somebody else's key
        return None


def _check_row(row: Any, name: str) -> None:
    if not isinstance(row, list) or len(row) != 6:
        count = f"{len(row)} numbers" if isinstance(row, list) else shown(row)
        raise InvalidRange(f"{name}: {count}: must be six, rx, ry, rz (rad), tx, ty, tz (m)")
    for value in row:
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e6:
            raise InvalidRange(f"{name}: {shown(value)}: must be a finite number, rad or m")
    turn = math.hypot(*row[:3])
    if turn > 2 * math.pi:
        raise InvalidRange(
            f"{name}: rotation vector of {turn:.3g} rad, more than a whole turn (6.28): must be rad; are"
            " these degrees?"
        )


def poses_document(board: Board, poses: BoardPoses, holdings: Sequence[str]) -> dict[str, Any]:
    """The poses as JSON values; `holdings` says in words how each is held."""
    return {
        "board": board.text,
        KEY: poses.rows.tolist(),
        "holdings": list(holdings),
    }
