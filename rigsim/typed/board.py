"""Boards as people type them: ``9x6@30mm``."""

from __future__ import annotations

import re

from rigsim.errors import InvalidRange
from rigsim.rig.board import Board
from rigsim.typed import quantity

SQUARE = quantity.QuantityKind("board's square", "mm", quantity.BASELINE.factors, above=0)
_FORM = re.compile(r"\s*(\d+)\s*[x×]\s*(\d+)\s*@\s*(\S.*?)\s*", re.IGNORECASE)


def board(text: str) -> Board:
    """A board of ``COLSxROWS@SQUARE``: inner corners along it and down, and the side of a square.

    Raises:
        InvalidRange: it is none.

    Example:
        >>> board("9x6@30mm").text
        '9x6@30mm'
    """
    found = _FORM.fullmatch(text)
    if found is None:
        raise InvalidRange(
            f"board {text!r}: must be COLSxROWS@SQUARE, as 9x6@30mm: inner corners (one fewer than squares)"
            " and a square's side"
        )
    cols, rows, square = found.groups()
    return Board(int(cols), int(rows), quantity.value(square, SQUARE) / 1e3)
