"""Checker corners fitted to the pixels, each with its covariance, all at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rigsim.pixels.corners import saddle
from rigsim.rig.arrays import Array, Mask

HALF_WINDOW = 5
"""Half width of a window, px: 11 x 11 pixels."""

_MIN_PIXELS = 21  # three times the parameters
_MAX_CORRELATION = 0.94  # |cos| of the angle between the edges: 20 degrees
_MAX_MOVE = 2.0  # px from where the corner was expected
_MAX_STD = 0.5  # px; worse than OpenCV's own answer
_SHARP_STD_PX = 0.001  # rms of such shifts over rendered, two times supersampled, upright boards
_CLEARLY = 1.6  # over the root of the number of corners: three standard deviations of such a median
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
class _Fitted:
    uv: Array
    inverse: Array
    variance: Array
    blur_var: Array
    edge_ratio: Array
    spread: Array
    valid: Mask
    parameters: Array


def fit_corners(
    levels: Array, floor: float, start: Array, half: int, steps: Array | None
) -> tuple[Corners, Array]:
    """Fit corners near given positions, all at once; also all parameters (N, 7) of the saddles.

    The covariance is the residuals' variance times the inverse of J^T J. The variance is at least that of
    rounding to whole grey levels, and more when the residuals gather where the position is read off (the
    picture is not quite a blurred corner) or when neighbouring ones agree (the picture was interpolated).

    Args:
        levels: grey levels (H, W).
        floor: variance that their rounding adds.
        start: where to look (N, 2), px, good to about 1.5 px.
        half: the window has 2 half + 1 pixels a side.
        steps: to the next corner along the columns and along the rows (N, 2, 2), px: keeps the window
            clear of the neighbouring squares. None: the window must hold no other corner's edges.
    """
    reach = np.full(len(start), _FIRST_BLUR)
    fitted = _fit(levels, start, half, steps, reach)
    if steps is not None and fitted.valid.any():
        # the blur is known now: where it reaches further than was assumed, the window shrinks
        blur = float(np.median(np.sqrt(fitted.blur_var[fitted.valid] + 1 / 12)))
        if blur > _FIRST_BLUR * 1.1:
            fitted = _fit(levels, start, half, steps, np.full(len(start), blur))
    valid = fitted.valid
    excess = _significant(fitted.edge_ratio[valid] * fitted.spread[valid])
    variance: Array = np.maximum(fitted.variance * excess, floor)
    cov = variance[:, None, None] * fitted.inverse + _sampling_var(fitted.blur_var[valid]) * np.eye(2)
    valid = valid & (cov[:, 0, 0] + cov[:, 1, 1] < 2 * _MAX_STD**2)
    corners = Corners(
        uv=np.where(valid[:, None], fitted.uv, np.nan),
        cov=np.where(valid[:, None, None], cov, np.nan),
        valid=valid,
        blur=np.where(valid, np.sqrt(fitted.blur_var), np.nan),
        grey_std=np.where(valid, np.sqrt(variance), np.nan),
    )
    return corners, fitted.parameters


def _sampling_var(blur_var: Array) -> float:
    """Variance (px^2) that stays unseen where edges are sharper than pixels.

    A sharp edge shows in one pixel alone, whose level depends on how the camera or the renderer averages
    within a pixel; two samples a side instead of the whole square shift it by some thousandths of a pixel,
    with no residual that tells. Blur takes this away like any frequency of two cycles a pixel.
    """
    if blur_var.size == 0:
        return 0.0
    return float(_SHARP_STD_PX**2 * np.exp(-8 * np.pi**2 * np.median(blur_var)))


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
