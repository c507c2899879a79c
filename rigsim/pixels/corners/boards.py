"""Checker boards, found with no prior but their rows and columns.

`rigsim.pixels.corners.lattice` finds boards of any size in clutter; where it finds none, OpenCV looks again.
Then `rigsim.pixels.corners.corners` fits every corner.

Order: row-major, `cols` along the board's first axis. Columns run to the right in the image as far as the
board allows (of the two, or for a square board four, ways to turn the grid onto itself, the one whose
columns point most along +u), and rows are a quarter turn clockwise from them as seen: downwards. So both
images of a rig that is not rolled against itself get the same order;
`rigsim.pixels.corners.pairing` makes sure.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidImage
from rigsim.pixels.corners import saddle
from rigsim.pixels.corners.corners import HALF_WINDOW, Corners, fit_corners
from rigsim.pixels.corners.lattice import fill, find_grids
from rigsim.pixels.images import grey, quantization_var
from rigsim.pixels.opencv import load_cv2
from rigsim.rig.arrays import AnyImage, Array, Mask
from rigsim.statistics import inner_range

_MIN_SHARE = 0.5  # of a board's corners must be fitted, or it is taken for a false alarm
_LEAST_CONTRAST = 1e-6  # grey; keeps the logarithm finite where a fit found nothing
_MAX_LOG_CONTRAST = 0.5
_MAX_MISFIT = 2.0  # over the board's median
_MAX_MOVE = 0.7  # px, from where the grid was seen
_SMALLEST_CANVAS = 480  # px; a smaller picture is not searched


@dataclass(frozen=True, slots=True)
class BoardCorners:
    """Inner corners of one board, row-major."""

    rows: int
    """Rows of inner corners."""
    cols: int
    """Columns of inner corners."""
    uv: Array
    """Position (rows * cols, 2), px; NaN where the fit failed."""
    cov: Array
    """Covariance (rows * cols, 2, 2), px^2."""
    valid: Mask
    """Whether the corner was fitted, (rows * cols,)."""
    polarity: int
    """1 when the square between the first corner and the one diagonally after it is bright, -1 when dark."""


def find_sizes(
    image: AnyImage, sizes: Sequence[tuple[int, int]], *, name: str = "image", limit: int = 32
) -> tuple[BoardCorners, ...]:
    """All boards of these sizes, (rows, cols) of inner corners, at most `limit`, from left to right.

    None is no error.

    Raises:
        InvalidImage: the picture or a board's size cannot be used.
        MeasurementFailed: no board was found at first sight, and OpenCV, which would look again, is not
            installed.
    """
    for rows, cols in sizes:
        for axis, count in (("rows", rows), ("columns", cols)):
            if count < 3:
                raise InvalidImage(f"board of {count} {axis} of inner corners: must be >= 3")
    levels, floor = grey(image, name), quantization_var(image)
    wanted = set(sizes)
    boards: list[BoardCorners] = []
    for grid in find_grids(levels):
        shape = (grid.shape[0], grid.shape[1])
        if shape not in wanted:
            grid, shape = np.swapaxes(grid, 0, 1), shape[::-1]
        if shape in wanted:
            boards += _refined(levels, floor, fill(grid))
    if not boards:
        for rows, cols in sizes:
            boards += _second_look(levels, floor, rows, cols, limit)
    return tuple(sorted(boards, key=lambda board: float(np.nanmean(board.uv[:, 0])))[:limit])


def refit(image: AnyImage, board: BoardCorners, *, name: str = "image") -> Array:
    """The corners (rows * cols, 2) px of a board that was found, fitted in another picture of the same view.

    NaN where they were not fitted in the first, or are not in this one.

    Raises:
        InvalidImage: the picture cannot be used.
    """
    steps = _lattice_steps(board.uv.reshape(board.rows, board.cols, 2))
    known = board.valid & np.isfinite(steps).all(axis=(1, 2))
    uv = np.full_like(board.uv, np.nan)
    fitted, _ = fit_corners(
        grey(image, name), quantization_var(image), board.uv[known], HALF_WINDOW, steps[known]
    )
    uv[known] = fitted.uv
    return uv


def nearest_order(board: BoardCorners, near: Array) -> npt.NDArray[np.intp]:
    """How a board's corners are to be taken, (rows * cols,), to lie nearest to some places (rows * cols, 2).

    One of the ways to turn its grid onto itself.
    """
    places = np.arange(len(board.uv), dtype=np.float64).reshape(board.rows, board.cols)
    orders = [turned.ravel().astype(np.intp) for turned in turns(places)]
    return min(orders, key=lambda order: float(np.nanmean((board.uv[order] - near) ** 2)))


def canonical(grid: Array) -> Array:
    """The same corners (rows, cols, 2), turned so that columns point right as far as they can."""
    along, down = lattice_directions(grid)
    if along[0] * down[1] - along[1] * down[0] < 0:
        grid = grid[:, ::-1]
    return max(turns(grid), key=lambda turned: float(lattice_directions(turned)[0][0]))


def turns(grid: Array) -> list[Array]:
    """Every way (2, or 4 for a square) to turn a grid (rows, cols, 2) onto its own shape."""
    quarters = range(4) if grid.shape[0] == grid.shape[1] else (0, 2)
    return [np.asarray(np.rot90(grid, k)) for k in quarters]


def lattice_directions(grid: Array) -> tuple[Array, Array]:
    """Mean unit directions (2,) along the columns and along the rows of a grid (rows, cols, 2)."""
    along = (grid[:, -1] - grid[:, 0]).mean(axis=0)
    down = (grid[-1] - grid[0]).mean(axis=0)
    return along / np.linalg.norm(along), down / np.linalg.norm(down)


def not_found(name: str, sizes: Sequence[tuple[int, int]]) -> str:
    """What to say when a picture holds no such board."""
    wanted = " or ".join(f"{rows} x {cols}" for rows, cols in sizes)
    return (
        f"{name}: no checker board of {wanted} inner corners found: it must be visible as a whole, with "
        "squares of at least 6 px; rows and columns count inner corners, not squares"
    )


def _second_look(levels: Array, floor: float, rows: int, cols: int, limit: int) -> list[BoardCorners]:
    """What OpenCV finds: it copes with blur and noise that leave no single corner recognisable."""
    cv2 = load_cv2()
    low, high = inner_range(levels)
    canvas = np.clip((levels - low) * (255 / max(high - low, 1e-12)), 0, 255).astype(np.uint8)
    quick = cv2.CALIB_CB_NORMALIZE_IMAGE
    boards: list[BoardCorners] = []
    for scale in (0.25, 0.5, 1.0):
        if scale < 1 and max(levels.shape) * scale < _SMALLEST_CANVAS:
            continue
        flags = quick if scale < 1 else quick | cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_ACCURACY
        # twice as many tries as boards: a false alarm is painted over like a board
        for _ in range(2 * limit):
            small = cv2.resize(canvas, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
            found, corners = cv2.findChessboardCornersSB(small, (cols, rows), flags=flags)
            if not found:
                break
            grid = (np.asarray(corners, dtype=np.float64).reshape(rows, cols, 2) + 0.5) / scale - 0.5
            boards += _refined(levels, floor, grid)
            cv2.fillConvexPoly(canvas, _outline(grid), int(np.median(canvas)))
    return boards


def _alike(corners: Corners, parameters: Array, grid: Array) -> Mask:
    """Which corners look like the rest of their board: where it was expected, as bright, and fitted as
    well. Something in front of a corner moves it, and gives it away."""
    good = corners.valid
    if not good.any():
        return good
    contrast = np.maximum(np.abs(parameters[:, saddle.CONTRAST]), _LEAST_CONTRAST)
    usual = np.median(contrast[good])
    misfit = np.nan_to_num(corners.grey_std / contrast, nan=np.inf)
    move = np.nan_to_num(np.linalg.norm(corners.uv - grid.reshape(-1, 2), axis=1), nan=np.inf)
    return np.asarray(
        (np.abs(np.log(contrast / usual)) < _MAX_LOG_CONTRAST)
        & (misfit < _MAX_MISFIT * np.median(misfit[good]) + 0.02)
        & (move < _MAX_MOVE)
    )


def _lattice_steps(grid: Array) -> Array:
    """To the next corner along columns and rows (rows * cols, 2, 2), px."""
    return np.stack([np.gradient(grid, axis=1), np.gradient(grid, axis=0)], axis=-2).reshape(-1, 2, 2)


def _refined(levels: Array, floor: float, grid: Array) -> list[BoardCorners]:
    """The board fitted to a detected grid; none when its squares do not alternate like a checker board's."""
    grid = canonical(grid)
    rows, cols = grid.shape[:2]
    steps = _lattice_steps(grid)
    corners, p = fit_corners(levels, floor, grid.reshape(-1, 2), HALF_WINDOW, steps)
    inwards = steps.sum(axis=1)
    sign = np.sign(p[:, saddle.CONTRAST])
    for angle in (p[:, saddle.ANGLE_1], p[:, saddle.ANGLE_2]):
        sign *= np.sign(inwards[:, 0] * np.cos(angle) + inwards[:, 1] * np.sin(angle))
    row, col = np.divmod(np.arange(rows * cols), cols)
    sign *= 1 - 2 * ((row + col) % 2)
    balance = float(np.sum(sign * corners.valid))
    polarity = 1 if balance > 0 else -1
    valid = corners.valid & (sign == polarity) & _alike(corners, p, grid)
    if np.count_nonzero(valid) < _MIN_SHARE * rows * cols:
        return []
    uv, cov = corners.uv.copy(), corners.cov.copy()
    uv[~valid], cov[~valid] = np.nan, np.nan
    return [BoardCorners(rows, cols, uv, cov, valid, polarity)]


def _outline(grid: Array) -> npt.NDArray[np.int32]:
    """Corners (4, 2) px of a board with its outer squares and some margin."""
    along, down = np.gradient(grid, axis=1), np.gradient(grid, axis=0)
    rim = [
        grid[r, c] + 1.2 * ((1 if c else -1) * along[r, c] + (1 if r else -1) * down[r, c])
        for r, c in ((0, 0), (0, -1), (-1, -1), (-1, 0))
    ]
    return np.round(np.array(rim)).astype(np.int32)
