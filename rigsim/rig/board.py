"""The flat target that a calibration looks at: a checker board's inner corners."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig import given
from rigsim.rig.arrays import Array
from rigsim.rig.quantity import LENGTHS

LEAST = 3
"""Fewest corners along a side that a board is found by."""
MOST = 100
"""Most corners along a side."""
_FORM = re.compile(r"\s*(\d{1,9})\s*[x×]\s*(\d{1,9})\s*@\s*([-+.\w]*?)\s*([a-zµμ]*)\s*", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Board:
    """A checker board of `cols` x `rows` inner corners.

    Its first corner is the origin; corners lie along +x (columns) and +y (rows), z = 0 but for its warp.

    Example:
        >>> import rigsim
        >>> rigsim.Board(9, 6, 0.03).points[[1, 9]].tolist()  # one along x, one along y
        [[0.03, 0.0, 0.0], [0.0, 0.03, 0.0]]
    """

    cols: int
    """Inner corners along x."""
    rows: int
    """Inner corners along y."""
    square_m: float
    """Side of a square, m."""
    warp_m: tuple[float, float] = (0.0, 0.0)
    """How far the middle of each side along x, and along y, rises over its ends, along +z, m."""

    def __post_init__(self) -> None:
        for name, unknown in (("columns", self.cols), ("rows", self.rows)):
            count = given.real(unknown, f"board {name}", InvalidRange)
            if not (count.is_integer() and LEAST <= count <= MOST):
                raise InvalidRange(f"board of {count:g} {name} of inner corners: must be {LEAST} to {MOST}")
        object.__setattr__(self, "cols", int(self.cols))
        object.__setattr__(self, "rows", int(self.rows))
        square = given.real(self.square_m, "board's square", InvalidRange)
        if not (math.isfinite(square) and square > 0):
            raise InvalidRange(f"board's square {square * 1e3:g} mm: must be > 0")
        if not all(math.isfinite(rise) and abs(rise) < max(self.size_m) for rise in self.warp_m):
            raise InvalidRange(f"board's warp {self.warp_m} m: must be smaller than the board")

    @classmethod
    def of(cls, text: str) -> Board:
        """A board as `text` has it, ``COLSxROWS@SQUARE``: inner corners, a square's side (mm unless said).

        Raises:
            InvalidRange: it is none.

        Example:
            >>> import rigsim
            >>> rigsim.Board.of("9x6@3cm").text
            '9x6@30mm'
        """
        found = _FORM.fullmatch(text)
        if found is None:
            raise InvalidRange(
                f"board {given.shown(text)}: must be COLSxROWS@SQUARE, as 9x6@30mm: inner corners (one fewer"
                " than squares) and a square's side"
            )
        cols, rows, square, unit = found.groups()
        if unit and unit not in LENGTHS:
            raise InvalidRange(f"board's square {square}{unit}: unknown unit {unit!r}; write um, mm, cm or m")
        try:
            side = float(square)
        except ValueError:
            raise InvalidRange(
                f"board's square {given.shown(square) if square else 'empty'}: must be a length, as 30mm"
            ) from None
        return cls(int(cols), int(rows), side * float(LENGTHS[unit or "mm"]) / 1e3)

    @property
    def size_m(self) -> tuple[float, float]:
        """From the first to the last corner, along x and y, m."""
        return (self.cols - 1) * self.square_m, (self.rows - 1) * self.square_m

    @property
    def points(self) -> Array:
        """The corners (rows * cols, 3) m, row-major, in the board's frame."""
        points = np.zeros((self.rows * self.cols, 3))
        y, x = np.mgrid[: self.rows, : self.cols]
        points[:, 0], points[:, 1] = x.ravel() * self.square_m, y.ravel() * self.square_m
        points[:, 2] = self.warp_shape @ np.array(self.warp_m)
        return points

    @property
    def warp_shape(self) -> Array:
        """Rise along z (rows * cols, 2) per metre of each of the two warps: a parabola, 1 in the middle."""
        y, x = np.mgrid[: self.rows, : self.cols]
        return self.warp_shape_at(x.ravel() * self.square_m, y.ravel() * self.square_m)

    def warp_shape_at(self, x_m: Array, y_m: Array) -> Array:
        """The same (..., 2) anywhere on the board, also beside its corners."""
        width, height = self.size_m
        return np.stack([1 - (2 * x_m / width - 1) ** 2, 1 - (2 * y_m / height - 1) ** 2], axis=-1)

    @property
    def outline(self) -> Array:
        """Corners (4, 3) m of the outer squares' rim, all round, from the one beside the first corner."""
        (w, h), s = self.size_m, self.square_m
        return np.array([[-s, -s, 0], [w + s, -s, 0], [w + s, h + s, 0], [-s, h + s, 0.0]])

    @property
    def text(self) -> str:
        """As the command line has it: ``9x6@30mm``."""
        return f"{self.cols}x{self.rows}@{self.square_m * 1e3:g}mm"
