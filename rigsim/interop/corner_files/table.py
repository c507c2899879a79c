"""Corners in a CSV table: ``picture,camera,corner,u_px,v_px``, a row a corner.

``camera`` is left or right. ``corner`` counts from 0, row-major. A ``level``
is as in corners.vnl; ``std_px`` is the standard deviation that their finder claims. Corners that are not
there were not found. Other columns are left alone.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.interop.corner_files.read import PictureCorners, columns, number

HEAD = ("picture", "camera", "corner", "u_px", "v_px")
"""The columns."""
LEAST_STD_PX = 1e-4
"""No finder is better."""


def read_table(path: Path, lines: Sequence[str], count: int) -> list[PictureCorners]:
    """The pictures of a table's lines.

    Raises:
        InvalidRange: a column is missing, or a value is none.
    """
    reader = csv.reader(lines)
    names = [name.strip() for name in next(reader)]
    at = columns(path, names, HEAD)
    pictures: dict[tuple[str, str], PictureCorners] = {}
    said: dict[tuple[str, str, float], int] = {}
    for k, cells in enumerate(reader, start=2):
        if not cells:
            continue
        if len(cells) != len(names):
            raise InvalidRange(
                f"{path}: line {k}: {len(cells)} values, must be {len(names)}: {', '.join(names)}"
            )
        picture, camera = cells[at["picture"]].strip(), cells[at["camera"]].strip().lower()
        if camera not in ("left", "right"):
            raise InvalidRange(f"{path}: line {k}: camera {camera[:40]!r}: must be left or right")
        corner = number(path, k, cells[at["corner"]])
        if not (corner.is_integer() and 0 <= corner < count):
            raise InvalidRange(
                f"{path}: line {k}: corner {corner:g}: must be a whole number, 0 to {count - 1}"
            )
        before = said.setdefault((picture, camera, corner), k)
        if before != k:
            raise InvalidRange(
                f"{path}: line {k}: corner {corner:g} of {picture}, {camera}, stands on line {before}"
                " already: leave one out"
            )
        told = pictures.get((picture, camera))
        if told is None:
            told = pictures[picture, camera] = PictureCorners.none(picture, camera, count)
        if cells[at["u_px"]].strip() == "" or cells[at["v_px"]].strip() == "":
            continue
        told.uv[int(corner)] = [number(path, k, cells[at[axis]]) for axis in ("u_px", "v_px")]
        if "std_px" in names and (std := cells[names.index("std_px")].strip()):
            told.std_px[int(corner)] = _std(path, k, std)
        if "level" in names:
            told.level[int(corner)] = max(number(path, k, cells[names.index("level")]), 0.0)
    return list(pictures.values())


def _std(path: Path, line: int, text: str) -> float:
    """The standard deviation of a coordinate, px.

    Raises:
        InvalidRange: it is none.
    """
    std_px = number(path, line, text)
    if std_px < LEAST_STD_PX:
        raise InvalidRange(
            f"{path}: line {line}: std_px {std_px:g}: must be >= {LEAST_STD_PX:g} px, or empty where the"
            " finder claims none"
        )
    return std_px


def table_text(pictures: Sequence[PictureCorners]) -> str:
    """The table of pictures, which `read_table` reads."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow((*HEAD, "std_px"))
    for each in pictures:
        for corner in np.flatnonzero(np.isfinite(each.uv).all(axis=1)):
            u, v = each.uv[corner]
            claimed = each.std_px[corner]
            # what is written must be read: exact pictures claim next to nothing
            std = f"{max(claimed, LEAST_STD_PX):.5f}" if np.isfinite(claimed) else ""
            writer.writerow([each.picture, each.camera, int(corner), f"{u:.6f}", f"{v:.6f}", std])
    return buffer.getvalue()
