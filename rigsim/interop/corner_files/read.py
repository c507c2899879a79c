"""Corner files of either form, as rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rigsim import foreign
from rigsim.errors import InvalidRange, OutputError
from rigsim.rig.arrays import Array


@dataclass(frozen=True, slots=True, eq=False)
class PictureCorners:
    """What a file says of one picture."""

    picture: str
    """The picture's name."""
    camera: str
    """Which camera took it; empty where the file does not say."""
    uv: Array
    """Corners (m, 2) px, row-major; NaN where none was found."""
    level: Array
    """How much coarser than the picture's own pixels each was found, (m,): its noise is 2^level times."""
    std_px: Array
    """Standard deviation of a coordinate that its finder claims, px, (m,); NaN where it claims none."""

    @classmethod
    def none(cls, picture: str, camera: str, count: int) -> PictureCorners:
        """A picture without a corner, so far."""
        nothing = np.full(count, np.nan)
        return cls(picture, camera, np.full((count, 2), np.nan), np.zeros(count), nothing)


def read_corners(path: Path, count: int) -> list[PictureCorners]:
    """The corners in a corners.vnl, or in a CSV table, of a board of `count` corners.

    Raises:
        OutputError: the file cannot be read.
        InvalidRange: it is neither, or a picture's corners are not the board's.
    """
    from rigsim.interop.corner_files.table import read_table
    from rigsim.interop.corner_files.vnl import read_vnl

    try:
        text = foreign.read_text(path, "a corners.vnl or a CSV table of corners", foreign.TABLE_BYTES)
    except UnicodeDecodeError:
        raise OutputError(f"{path}: is no text: name a corners.vnl or a CSV table of corners") from None
    lines = text.splitlines()
    first = next((line for line in lines if line.strip()), "")
    if first.lstrip().startswith("#"):
        return read_vnl(path, lines, count)
    if "," in first:
        return read_table(path, lines, count)
    raise InvalidRange(
        f"{path}: begins with {first[:60]!r}: must be a corners.vnl ('# filename x y level') or a CSV table"
        " ('picture,camera,corner,u_px,v_px')"
    )


def columns(path: Path, names: Sequence[str], wanted: Sequence[str]) -> dict[str, int]:
    """Where the columns called `wanted` are.

    Raises:
        InvalidRange: one is missing.
    """
    missing = [name for name in wanted if name not in names]
    if missing:
        raise InvalidRange(f"{path}: has no column {', '.join(missing)} (it has {', '.join(names)}): add it")
    return {name: list(names).index(name) for name in wanted}


def number(path: Path, line: int, text: str) -> float:
    """A number in a file.

    Raises:
        InvalidRange: it is none.
    """
    try:
        value = float(text)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise InvalidRange(f"{path}: line {line}: {text[:40]!r}: must be a number")
    return value
