"""Whatever terminal, pipe or file there is to print on."""

from __future__ import annotations

import codecs
import os
import sys

_PLAIN = {
    "−": "-",
    "–": "-",
    "—": "-",
    "×": "x",
    "±": "+-",
    "≈": "~",
    "≤": "<=",
    "≥": ">=",
    "°": " deg",
    "σ": "sigma",
    "√": "sqrt",
    "²": "^2",
    "³": "^3",
    "⁻": "^-",
    "…": "...",
    "→": "->",
    "·": ".",
    "µ": "u",
    "μ": "u",
    "“": '"',
    "”": '"',
    "‘": "'",
    "’": "'",
    "\u202f": " ",
    "\u00a0": " ",
    "é": "e",
    "━": "-",
    "─": "-",
}
_HANDLER = "rigsim-plain"


def prepare() -> None:
    """Make standard output and error take whatever is printed, and a terminal have a width."""
    codecs.register_error(_HANDLER, _plain)
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors=_HANDLER)
    if not os.environ.get("COLUMNS", "1").strip().lstrip("0").isdigit():
        del os.environ["COLUMNS"]  # 0, or no number: as if nobody had said
    os.environ.pop("MPLBACKEND", None)  # figures are drawn into files, by one backend whatever there is


def _plain(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(_PLAIN.get(letter, "?") for letter in error.object[error.start : error.end]), error.end
