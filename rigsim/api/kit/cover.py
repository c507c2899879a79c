"""The head of somebody's own report, read within bounds."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from rigsim.errors import InvalidRange, OutputError
from rigsim.rig import given

if TYPE_CHECKING:
    from rigsim.present.kit.page import Cover

LOGO_BYTES = 500_000
"""Largest logo: it stands in the page itself."""
MOST_TITLE, MOST_NOTE = 200, 4000
"""Longest title and note, characters."""

_PNG = b"\x89PNG\r\n\x1a\n"
_MOST_SIDE_PX = 8192


def cover(title: str = "", note: str = "", logo: str | os.PathLike[str] | None = None) -> Cover:
    """The head of a report.

    Raises:
        InvalidRange: a title or note is too long.
        OutputError: the logo cannot be read, is too large, or neither PNG nor SVG.
    """
    from rigsim.present.kit.page import Cover

    for name, text, most in (("title", title, MOST_TITLE), ("note", note, MOST_NOTE)):
        if len(str(text)) > most:
            raise InvalidRange(f"{name} of {len(str(text))} characters: must be <= {most}")
    if logo is None:
        return Cover(str(title), str(note))
    content, kind = _logo(given.path(logo, "logo"))
    return Cover(str(title), str(note), content, kind)


def _logo(path: Path) -> tuple[bytes, str]:
    from rigsim import foreign

    content = foreign.read_bytes(path, "a PNG or SVG picture", LOGO_BYTES)
    if content.startswith(_PNG) and len(content) > 33:
        width, height = (int.from_bytes(content[at : at + 4], "big") for at in (16, 20))
        if not (0 < width <= _MOST_SIDE_PX and 0 < height <= _MOST_SIDE_PX):
            raise OutputError(f"logo {path}: {width}x{height} px: must be within {_MOST_SIDE_PX} px a side")
        return content, "image/png"
    if b"<svg" in content[:2000].lower() and b"\0" not in content:
        return content, "image/svg+xml"
    raise OutputError(f"logo {path}: neither PNG nor SVG: name a picture of that kind")
