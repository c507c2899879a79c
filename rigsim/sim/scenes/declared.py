"""Checker boards as the texts of a scene declare them: ``board:GEOM`` with ``rows=6 cols=9 square_mm=40``."""

from __future__ import annotations

import math
from typing import Any

from rigsim.errors import InvalidScene

_PREFIX = "board:"
_KEYS = ("rows", "cols", "square_mm")
_MOST_CORNERS = 1000
_LARGEST_SQUARE_MM = 1e6


def declared_boards(spec: Any) -> dict[str, dict[str, float]]:
    """Rows and columns of inner corners and square_mm of each board of a mujoco.MjSpec, by its geom's name.

    Raises:
        InvalidScene: a key is missing or unknown, a value is out of bounds, or there is no such geom.
    """
    geoms = {geom.name for geom in spec.geoms}
    boards = {}
    for text in spec.texts:
        if not text.name.startswith(_PREFIX):
            continue
        name = text.name.removeprefix(_PREFIX)
        if name not in geoms:
            raise InvalidScene(f"text {text.name}: no geom is called {name!r}: name the geom with the board")
        boards[name] = _board(text.name, text.data)
    return boards


def _board(name: str, data: str) -> dict[str, float]:
    words = {key: word for key, _, word in (item.partition("=") for item in data.split())}
    if set(words) != set(_KEYS):
        raise InvalidScene(f"text {name}: {data[:80]}: must be as rows=6 cols=9 square_mm=40")
    return {key: _value(name, key, words[key]) for key in _KEYS}


def _value(name: str, key: str, word: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if key == "square_mm":
        if not 0 < value <= _LARGEST_SQUARE_MM:
            raise InvalidScene(
                f"text {name}: {key}={word[:40]}: must be a number above 0, up to {_LARGEST_SQUARE_MM:g}"
            )
    elif not (1 <= value <= _MOST_CORNERS and value == int(value)):
        raise InvalidScene(
            f"text {name}: {key}={word[:40]}: must be a whole number from 1 to {_MOST_CORNERS}"
        )
    return value
