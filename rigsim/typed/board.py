"""Boards as people type them: ``9x6@30mm``."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rigsim.rig.board import Board


def board(text: str) -> Board:
    """A board of ``COLSxROWS@SQUARE``, as `Board.of` reads it.

    Raises:
        InvalidRange: it is none.

    Example:
        >>> board("9x6@30mm").text
        '9x6@30mm'
    """
    from rigsim.rig.board import Board

    return Board.of(text)
