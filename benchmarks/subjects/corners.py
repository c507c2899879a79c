"""Single corners and single boards of a picture, for what looks at one at a time."""

from __future__ import annotations

import numpy as np

from rigsim.pixels.corners.boards import BoardCorners, find_sizes
from rigsim.pixels.corners.corners import HALF_WINDOW, Corners, fit_corners
from rigsim.pixels.images import grey, quantization_var


def refine_corners(
    image: np.ndarray, uv_initial: object, half_window: int = HALF_WINDOW, steps: np.ndarray | None = None
) -> Corners:
    """Fit corners near given positions (N, 2), px, as the pixels of `image` say; see `fit_corners`."""
    start = np.asarray(uv_initial, dtype=np.float64).reshape(-1, 2)
    return fit_corners(grey(image, "image"), quantization_var(image), start, half_window, steps)[0]


def find_boards(image: np.ndarray, rows: int, cols: int, limit: int = 32) -> tuple[BoardCorners, ...]:
    """All boards of rows x cols inner corners, from left to right."""
    return find_sizes(image, [(rows, cols)], limit=limit)


def find_board(image: np.ndarray, rows: int, cols: int) -> BoardCorners:
    """The board of rows x cols inner corners that is found first."""
    (board,) = find_boards(image, rows, cols, limit=1)
    return board
