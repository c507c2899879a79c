"""mrcal's corners.vnl: ``# filename x y level``, a line a corner, ``-`` for a picture without a board.

A board's corners stand row-major. A level above 0 says that the corner was found in a picture halved so
often; ``-``, or a level below 0, that it was not found. Without a level column the fourth is a weight, as
mrcal has it: ``weight`` is 1 over the noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.interop.corner_files.read import PictureCorners, columns, number


def read_vnl(path: Path, lines: Sequence[str], count: int) -> list[PictureCorners]:
    """The pictures of a file's lines.

    Raises:
        InvalidRange: a column is missing, a value is none, or a picture has not as many corners as the board.
    """
    names: list[str] | None = None
    rows: dict[str, list[tuple[float, float, float]]] = {}
    at: dict[str, int] = {}
    for k, line in enumerate(lines, start=1):
        text = line.strip()
        if not text or text.startswith("##"):
            continue
        if text.startswith("#"):
            if names is None:
                names = text.lstrip("#").split()
                at = columns(path, names, ("filename", "x", "y"))
            continue
        if names is None:
            raise InvalidRange(
                f"{path}: line {k}: comes before a line that names the columns: # filename x y level"
            )
        cells = text.split()
        if len(cells) != len(names):
            raise InvalidRange(
                f"{path}: line {k}: {len(cells)} values, must be {len(names)}: {', '.join(names)}"
            )
        told = rows.setdefault(cells[at["filename"]], [])
        u, v = cells[at["x"]], cells[at["y"]]
        if "-" in (u, v):
            told.append((np.nan, np.nan, 0.0))
            continue
        told.append((number(path, k, u), number(path, k, v), _level(path, k, names, cells)))
    return [_picture(path, name, told, count) for name, told in rows.items()]


def _level(path: Path, line: int, names: Sequence[str], cells: Sequence[str]) -> float:
    """How often the picture was halved; NaN where the corner does not count."""
    if "level" in names:
        text = cells[names.index("level")]
        level = 0.0 if text == "-" else number(path, line, text)
        return level if level >= 0 else np.nan
    if "weight" in names:
        text = cells[names.index("weight")]
        weight = 1.0 if text == "-" else number(path, line, text)
        return float(-np.log2(weight)) if weight > 0 else np.nan
    return 0.0


def _picture(path: Path, name: str, told: Sequence[tuple[float, float, float]], count: int) -> PictureCorners:
    corners = np.array(told, dtype=np.float64)
    if len(told) == 1 and np.isnan(corners[0, 0]):
        corners = np.full((count, 3), (np.nan, np.nan, 0.0))
    if len(corners) != count:
        raise InvalidRange(
            f"{path}: {name} has {len(corners)} corners, the board has {count}: give its --board"
        )
    lost = np.isnan(corners[:, 2])
    uv = np.where(lost[:, None], np.nan, corners[:, :2])
    return PictureCorners(name, "", uv, np.where(lost, 0.0, corners[:, 2]), np.full(count, np.nan))
