"""TOML, read without what would take its parser for ever."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from typing import Any

from rigsim.errors import InvalidRig
from rigsim.interop.formats.tables.lens import LARGEST

_MOST_DOTS = 1000  # of a line: keys within keys take the parser the square of that


def toml_table(text: str, parse_float: Callable[[str], Any] = float) -> dict[str, object]:
    """The table that a TOML text holds; `parse_float` makes what a number with a point is.

    Raises:
        InvalidRig: it is no TOML, or nested deeper than a calibration is.
    """
    if any(line.count(".") > _MOST_DOTS for line in text.splitlines()):
        raise InvalidRig(f"is not TOML: a line with more than {_MOST_DOTS} points")
    try:
        return tomllib.loads(text, parse_float=parse_float)
    except ArithmeticError:
        raise InvalidRig(f"a number is too large: must be within +-{LARGEST:g}") from None
    except RecursionError:
        raise InvalidRig("is not TOML: brackets are nested too deep") from None
    except ValueError as error:
        raise InvalidRig(f"is not TOML: {' '.join(str(error).split())[:200]}") from None
