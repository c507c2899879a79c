"""Checker-board corners: found with no prior but the board's rows and columns, then fitted to the pixels.

OpenCV says where a board is, to a fraction of a pixel; `rigsim.measure.saddle` says where its corners
are, near the Cramer-Rao bound, with a covariance each.

Order: row-major, `cols` along the board's first axis. Columns run to the right in the image as far as the
board allows (of the two, or for a square board four, ways to turn the grid onto itself, the one whose
columns point most along +u), and rows are a quarter turn clockwise from them as seen: downwards. So both
images of a rig that is not rolled against itself get the same order; `rigsim.measure.pairing` makes sure.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidImage, MeasurementFailed
from rigsim.measure import saddle
from rigsim.measure.images import AnyImage, grey, quantization_var
from rigsim.measure.opencv import load_cv2
from rigsim.rig.arrays import Array, Mask

_HALF_WINDOW = 5
_MIN_PIXELS = 21  # three times the parameters
_MAX_CORRELATION = 0.94  # |cos| of the angle between the edges: 20 degrees
_MAX_MOVE = 2.0  # px from where the corner was expected
_MAX_STD = 0.5  # px; worse than OpenCV's own answer
_CLEARLY = 1.6  # over the root of the number of corners: three standard deviations of such a median
_MIN_SHARE = 0.5  # of a board's corners must be fitted, or it is taken for a false alarm
_SMALLEST_CANVAS = 480  # px; a smaller picture is not searched
_CLEARANCE = 3.0  # widths of the blur that a pixel keeps from the next square's edges
_FIRST_BLUR = 0.65  # px, the pixel's square included, until the fit says better


@dataclass(frozen=True, slots=True)
class Corners:
    """Fitted positions; one row a corner."""

    uv: Array
    """Position (N, 2), px; NaN where the fit failed."""
    cov: Array
    """Covariance (N, 2, 2), px^2; NaN where the fit failed."""
    valid: Mask
    """Whether the pixels look like a corner and the fit settled, (N,)."""
    blur: Array
    """Width of the Gaussian blur (N,), px, the pixel's own square not counted; NaN where the fit failed."""
    grey_std: Array
    """Noise of the pixels around the corner (N,), grey levels; NaN where the fit failed."""


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


def refine_corners(
    image: AnyImage,
    uv_initial: npt.ArrayLike,
    *,
    half_window: int = _HALF_WINDOW,
    steps: Array | None = None,
    name: str = "image",
) -> Corners:
    """Fit corners near given positions, all at once.

    The covariance is the residuals' variance times the inverse of J^T J. The variance is at least that of
    rounding to whole grey levels, and more when the residuals gather where the position is read off (the
    picture is not quite a blurred corner) or when neighbouring ones agree (the picture was interpolated).

    Args:
        image: (H, W) or (H, W, 3).
        uv_initial: Where to look (N, 2), px, good to about 1.5 px.
        half_window: The window has 2 half_window + 1 pixels a side.
        steps: To the next corner along the columns and along the rows (N, 2, 2), px: keeps the window
            clear of the neighbouring squares. None: the window must hold no other corner's edges.
        name: What to call the image in an error.

    Raises:
        InvalidImage: see `rigsim.measure.images.grey`.
    """
    if half_window < 2:
        raise InvalidImage(f"corner window of half width {half_window} px: must be >= 2")
    start = np.asarray(uv_initial, dtype=np.float64).reshape(-1, 2)
    return _refine(grey(image, name), quantization_var(image), start, half_window, steps)[0]


def find_board(image: AnyImage, rows: int, cols: int, *, name: str = "image") -> BoardCorners:
    """The board of rows x cols inner corners that is found first.

    Raises:
        InvalidImage: the picture or the board's size cannot be used.
        MeasurementFailed: no such board is in the picture, or OpenCV is not installed.
    """
    boards = find_boards(image, rows, cols, name=name, limit=1)
    if not boards:
        raise MeasurementFailed(not_found(name, rows, cols))
    return boards[0]


def find_boards(
    image: AnyImage, rows: int, cols: int, *, name: str = "image", limit: int = 32
) -> tuple[BoardCorners, ...]:
    """All boards of rows x cols inner corners, at most `limit`, from left to right; none is no error.

    Raises:
        InvalidImage: the picture or the board's size cannot be used.
        MeasurementFailed: OpenCV is not installed.
    """
    for axis, count in (("rows", rows), ("columns", cols)):
        if count < 3:
            raise InvalidImage(f"board of {count} {axis} of inner corners: must be >= 3")
    cv2 = load_cv2()
    levels, floor = grey(image, name), quantization_var(image)
    low, high = np.percentile(levels, (1, 99))
    canvas = np.clip((levels - low) * (255 / max(high - low, 1e-12)), 0, 255).astype(np.uint8)
    boards: list[BoardCorners] = []
    for scale, flags in _passes(cv2, max(levels.shape)):
        # twice as many tries as boards: a false alarm is blotted out like a board
        for _ in range(2 * limit):
            if len(boards) == limit:
                break
            small = cv2.resize(canvas, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
            found, corners = cv2.findChessboardCornersSB(small, (cols, rows), flags=flags)
            if not found:
                break
            detected = (np.asarray(corners, dtype=np.float64).reshape(rows, cols, 2) + 0.5) / scale - 0.5
            grid = canonical(detected)
            board = _refine_board(levels, floor, grid)
            if board is not None:
                boards.append(board)
            _blot_out(cv2, canvas, grid)
    return tuple(sorted(boards, key=lambda board: float(np.nanmean(board.uv[:, 0]))))


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


def not_found(name: str, rows: int, cols: int) -> str:
    """What to say when a picture holds no such board."""
    return (
        f"{name}: no checker board of {rows} x {cols} inner corners found: it must be wholly visible, with a "
        "bright margin; rows and columns count inner corners, not squares"
    )


def _passes(cv2: Any, size: int) -> list[tuple[float, int]]:
    """Scales and flags to search with: large boards in a small picture first, since that is quick."""
    quick = cv2.CALIB_CB_NORMALIZE_IMAGE
    coarse = [(scale, quick) for scale in (0.25, 0.5) if size * scale >= _SMALLEST_CANVAS]
    return [*coarse, (1.0, quick), (1.0, quick | cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_ACCURACY)]


@dataclass(frozen=True, slots=True)
class _Fitted:
    uv: Array
    inverse: Array
    variance: Array
    blur_var: Array
    edge_ratio: Array
    spread: Array
    valid: Mask
    parameters: Array


def _refine(
    levels: Array, floor: float, start: Array, half: int, steps: Array | None
) -> tuple[Corners, Array]:
    """Corners, and all their parameters (N, 7)."""
    reach = np.full(len(start), _FIRST_BLUR)
    fitted = _fit(levels, start, half, steps, reach)
    if steps is not None and fitted.valid.any():
        # the blur is known now: where it reaches further than was assumed, the window shrinks
        blur = float(np.median(np.sqrt(fitted.blur_var[fitted.valid] + 1 / 12)))
        if blur > _FIRST_BLUR * 1.1:
            fitted = _fit(levels, start, half, steps, np.full(len(start), blur))
    valid = fitted.valid
    excess = _significant(fitted.edge_ratio[valid]) * _significant(fitted.spread[valid])
    variance: Array = np.maximum(fitted.variance * excess, floor)
    cov = variance[:, None, None] * fitted.inverse
    valid = valid & (cov[:, 0, 0] + cov[:, 1, 1] < 2 * _MAX_STD**2)
    corners = Corners(
        uv=np.where(valid[:, None], fitted.uv, np.nan),
        cov=np.where(valid[:, None, None], cov, np.nan),
        valid=valid,
        blur=np.where(valid, np.sqrt(fitted.blur_var), np.nan),
        grey_std=np.where(valid, np.sqrt(variance), np.nan),
    )
    return corners, fitted.parameters


def _significant(ratios: Array) -> float:
    """The median of ratios whose mean is 1 for white noise; 1 unless it is clearly more."""
    if ratios.size == 0:
        return 1.0
    ratio = float(np.median(ratios))
    return ratio if ratio > 1 + _CLEARLY / np.sqrt(ratios.size) else 1.0


def _fit(levels: Array, start: Array, half: int, steps: Array | None, reach: Array) -> _Fitted:
    sound: Mask = np.asarray(np.isfinite(start).all(axis=1))
    middle = np.where(sound[:, None], np.round(start), 0.0).astype(np.intp)
    windows, weights = _windows(levels, middle, half)
    if steps is not None:
        weights = weights * _clear_of_neighbours(middle - start, half, steps, reach)
    sound &= weights.sum(axis=(1, 2)) >= _MIN_PIXELS
    # the quadratic surface and the fit need some pixels; those of a hopeless corner are made up and dropped
    weights[~sound] = 1.0
    fit = saddle.fit(windows, weights)
    p = fit.parameters
    move = np.hypot(*(p[:, saddle.U : saddle.V + 1] + middle - start).T)
    free = fit.pixels - saddle.PARAMETERS
    # E[1/chi^2] is 1/(n - 2): with two fewer, squared errors over this variance average to one
    variance = fit.residual_square / np.maximum(free - 2, 1)
    lean = np.cos(p[:, saddle.ANGLE_1] - p[:, saddle.ANGLE_2])
    valid = (
        sound
        & fit.converged
        & (move < _MAX_MOVE)
        & (np.abs(lean) < _MAX_CORRELATION)
        & (np.abs(p[:, saddle.CONTRAST]) > 2 * np.sqrt(variance))
        & np.isfinite(fit.normal_inverse).all(axis=(1, 2))
    )
    place = slice(saddle.U, saddle.V + 1)
    return _Fitted(
        uv=p[:, place] + middle,
        inverse=fit.normal_inverse[:, place, place],
        variance=variance,
        blur_var=p[:, saddle.BLUR_VAR],
        edge_ratio=fit.edge_ratio,
        spread=fit.spread,
        valid=valid,
        parameters=p,
    )


def _windows(levels: Array, middle: npt.NDArray[np.intp], half: int) -> tuple[Array, Array]:
    """Pixels (N, S, S) around whole-pixel positions (N, 2), and 1 where there is a pixel, else 0."""
    offset = np.arange(-half, half + 1)
    v = middle[:, 1, None, None] + offset[None, :, None]
    u = middle[:, 0, None, None] + offset[None, None, :]
    height, width = levels.shape
    inside = (v >= 0) & (v < height) & (u >= 0) & (u < width)
    windows = levels[np.clip(v, 0, height - 1), np.clip(u, 0, width - 1)]
    return windows, inside.astype(np.float64)


def _clear_of_neighbours(shift: Array, half: int, steps: Array, reach: Array) -> Array:
    """1 where a pixel (N, S, S) lies within the four squares that meet at its corner, away from their
    outer edges by `_CLEARANCE` times `reach`, else 0."""
    x, y = saddle.pixel_grid(2 * half + 1)
    # rows of the inverse are the gradients of the two lattice coordinates
    gradient = np.linalg.inv(np.swapaxes(steps, 1, 2))
    px, py = x + shift[:, :1], y + shift[:, 1:]
    clear = np.ones((len(steps), x.size))
    for i in range(2):
        coordinate = gradient[:, i, :1] * px + gradient[:, i, 1:] * py
        margin = _CLEARANCE * reach * np.hypot(gradient[:, i, 0], gradient[:, i, 1])
        clear *= np.abs(coordinate) < 1 - margin[:, None]
    return clear.reshape(len(steps), 2 * half + 1, 2 * half + 1)


def _lattice_steps(grid: Array) -> Array:
    """To the next corner along columns and rows (rows * cols, 2, 2), px."""
    return np.stack([np.gradient(grid, axis=1), np.gradient(grid, axis=0)], axis=-2).reshape(-1, 2, 2)


def _refine_board(levels: Array, floor: float, grid: Array) -> BoardCorners | None:
    """Fit a detected grid; None when its squares do not alternate like a checker board's."""
    rows, cols = grid.shape[:2]
    steps = _lattice_steps(grid)
    corners, p = _refine(levels, floor, grid.reshape(-1, 2), _HALF_WINDOW, steps)
    inwards = steps.sum(axis=1)
    sign = np.sign(p[:, saddle.CONTRAST])
    for angle in (p[:, saddle.ANGLE_1], p[:, saddle.ANGLE_2]):
        sign *= np.sign(inwards[:, 0] * np.cos(angle) + inwards[:, 1] * np.sin(angle))
    row, col = np.divmod(np.arange(rows * cols), cols)
    sign *= 1 - 2 * ((row + col) % 2)
    balance = float(np.sum(sign * corners.valid))
    polarity = 1 if balance > 0 else -1
    valid = corners.valid & (sign == polarity)
    if np.count_nonzero(valid) < _MIN_SHARE * rows * cols:
        return None
    uv, cov = corners.uv.copy(), corners.cov.copy()
    uv[~valid], cov[~valid] = np.nan, np.nan
    return BoardCorners(rows, cols, uv, cov, valid, polarity)


def _blot_out(cv2: Any, canvas: npt.NDArray[np.uint8], grid: Array) -> None:
    """Paint over a board that was found, its outer squares included, so that the next one is seen."""
    along, down = np.gradient(grid, axis=1), np.gradient(grid, axis=0)
    rim = np.array(
        [
            grid[r, c] + 1.2 * ((1 if c else -1) * along[r, c] + (1 if r else -1) * down[r, c])
            for r, c in ((0, 0), (0, -1), (-1, -1), (-1, 0))
        ]
    )
    outline = np.round(rim).astype(np.int32)
    cv2.fillConvexPoly(canvas, outline, int(np.median(canvas)))
