"""Where in the pictures the board's corners were."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Mask
from rigsim.study.calibrate.pictures.sightings import Sightings

ACROSS = 8
"""Cells over a picture's longer side."""


@dataclass(frozen=True, slots=True, eq=False)
class CornerCoverage:
    """Which cells of a picture held a corner, at least one of them in one pair."""

    left: Mask
    """Cells (rows, columns) of the left pictures."""
    right: Mask
    """Of the right pictures."""

    @property
    def shares(self) -> tuple[float, float]:
        """Share of the cells that held one, of the left and of the right pictures."""
        return float(self.left.mean()), float(self.right.mean())


def coverage(sightings: Sightings) -> CornerCoverage:
    """The cells that corners fell into."""
    return CornerCoverage(*(_cells(sightings, side) for side in (0, 1)))


def _cells(sightings: Sightings, side: int) -> Mask:
    width, height = sightings.sizes[side]
    cell = max(width, height) / ACROSS
    cols, rows = max(round(width / cell), 1), max(round(height / cell), 1)
    uv = sightings.observed[:, side].reshape(-1, 2)
    uv = uv[np.isfinite(uv).all(axis=1)]
    col = np.clip(((uv[:, 0] + 0.5) * cols / width).astype(np.intp), 0, cols - 1)
    row = np.clip(((uv[:, 1] + 0.5) * rows / height).astype(np.intp), 0, rows - 1)
    cells = np.zeros((rows, cols), dtype=bool)
    cells[row, col] = True
    return cells
