"""The picture of one checker corner, and its least-squares fit to many windows at once.

A corner is ``offset + contrast * <sign(n1 p) sign(n2 p)>``: two straight edges through one point, blurred
by a Gaussian of standard deviation ``blur`` and averaged over the pixel's square. Seven parameters:
offset, contrast, u, v, the angles of the two normals, blur^2. Perspective keeps straight edges straight,
so nothing is lost by a tilted board.

Along its normal an edge is the error function convolved with the square's projection, two boxes of widths
``|cos|`` and ``|sin|``: a second difference of the error function's second antiderivative G. The mean of
the product of the two edges differs from the product of their means near the corner, as quadrant
probabilities of a bivariate normal with correlation ``n1 n2`` differ from independent ones:
``dP/drho = density`` (Plackett 1954), integrated by Gauss-Legendre.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import erf

from rigsim.rig.arrays import Array, Mask

PARAMETERS = 7
OFFSET, CONTRAST, U, V, ANGLE_1, ANGLE_2, BLUR_VAR = range(PARAMETERS)

_PIXEL_VAR = 1 / 12  # of a unit square, along any direction
_MIN_BLUR_VAR = 1e-6
_MIN_WIDTH = 1e-3  # px; a narrower box changes nothing and divides by zero
_NODES = (0.5 - 0.5 / np.sqrt(3), 0.5 + 0.5 / np.sqrt(3))
_HELD = 1e24  # curvature of the sum of squares along a parameter that is held fixed
_GAIN = 0.01  # a step that lowers the cost by more than this share is not the last
_SLACK = 1e-4  # the derivatives leave out the corner's excess: the last steps need not go downhill
_CHUNK = 64  # windows at a time: their arrays stay in the processor's cache


@dataclass(frozen=True, slots=True)
class SaddleFit:
    """What was fitted to N windows."""

    parameters: Array
    """(N, 7); u and v from the window's middle pixel, px; angles rad; blur^2 px^2."""
    normal_inverse: Array
    """Inverse of J^T J (N, 7, 7): times the grey variance it is the parameters' covariance."""
    residual_square: Array
    """Sum of squared residuals (N,), grey^2."""
    pixels: Array
    """How many pixels took part (N,)."""
    edge_ratio: Array
    """Mean squared residual where the position is read off, over that of the whole window (N,); 1 when
    the residuals are plain noise."""
    spread: Array
    """Sum of the residuals' correlations with the eight pixels around and themselves (N,): 1 for white
    noise, more after interpolation, which hides noise at high frequencies and keeps it at low ones."""
    converged: Mask
    """Whether the last step was negligible (N,)."""


def model(parameters: Array, x: Array, y: Array) -> Array:
    """Grey levels (N, P) of corners (N, 7) at pixels x, y (P,) from the window's middle."""
    value, _ = _evaluate(parameters, x, y, exact=True, jacobian=False)
    return value


def guess(windows: Array, weights: Array) -> Array:
    """Parameters (N, 7) to start from: the saddle of the best quadratic surface.

    Args:
        windows: Grey levels (N, S, S), S odd.
        weights: Which pixels count, (N, S, S).
    """
    x, y = pixel_grid(windows.shape[1])
    half = windows.shape[1] // 2
    bell = np.exp(-(x * x + y * y) / (2 * (0.45 * half) ** 2))
    design = np.stack([np.ones_like(x), x, y, 0.5 * x * x, x * y, 0.5 * y * y], axis=1)
    flat = windows.reshape(len(windows), -1)
    count = weights.reshape(len(windows), -1)
    pinv = np.linalg.pinv(design * bell[:, None]) * bell
    mean = np.sum(flat * count, axis=1) / count.sum(axis=1)
    _, gx, gy, hxx, hxy, hyy = pinv @ np.where(count > 0, flat, mean[:, None]).T
    determinant = hxx * hyy - hxy * hxy
    with np.errstate(divide="ignore", invalid="ignore"):
        u, v = -(hyy * gx - hxy * gy) / determinant, -(hxx * gy - hxy * gx) / determinant
    near = (determinant < 0) & (np.hypot(u, v) < 0.5 * half)
    # the surface is level along an edge: d^T H d = 0 at half the angle of H's axis +- the opening
    axis = 0.5 * np.arctan2(2 * hxy, hxx - hyy)
    trace, spread = hxx + hyy, np.hypot(hxx - hyy, 2 * hxy)
    opening = 0.5 * np.arccos(np.clip(-trace / np.maximum(spread, 1e-12), -0.95, 0.95))
    parameters = np.empty((len(windows), PARAMETERS))
    parameters[:, OFFSET] = mean
    deviation = np.sqrt(np.sum(count * (flat - mean[:, None]) ** 2, axis=1) / count.sum(axis=1))
    # between the two normals the surface bends with +-: positive contrast makes it bend upwards along `axis`
    parameters[:, CONTRAST] = 1.1 * deviation
    parameters[:, U], parameters[:, V] = np.where(near, u, 0.0), np.where(near, v, 0.0)
    parameters[:, ANGLE_1] = axis + opening - np.pi / 2
    parameters[:, ANGLE_2] = axis - opening + np.pi / 2
    parameters[:, BLUR_VAR] = 0.5
    return parameters


def fit(
    windows: Array,
    weights: Array,
    *,
    iterations: int = 12,
    tolerance_px: float = 3e-4,
    exact: bool = True,
) -> SaddleFit:
    """Levenberg-Marquardt on all windows at once, first with the pixel's square as part of the blur, then
    exactly.

    Args:
        windows: Grey levels (N, S, S), S odd.
        weights: 1 where a pixel counts, 0 where it does not, (N, S, S).
        iterations: At most so many steps of each kind.
        tolerance_px: A step in u and v below it ends the fit.
        exact: False leaves out the second half, which is worth up to a few hundredths of a pixel.
    """
    parts = [
        _fit_chunk(windows[i : i + _CHUNK], weights[i : i + _CHUNK], iterations, tolerance_px, exact)
        for i in range(0, len(windows), _CHUNK)
    ]
    if not parts:
        empty = np.zeros(0)
        return SaddleFit(
            np.zeros((0, PARAMETERS)),
            np.zeros((0, PARAMETERS, PARAMETERS)),
            empty,
            empty,
            empty,
            empty,
            empty > 0,
        )
    return SaddleFit(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def pixel_grid(size: int) -> tuple[Array, Array]:
    """Coordinates x, y (size^2,) of a window's pixels from its middle one, row by row."""
    axis = np.arange(size, dtype=np.float64) - size // 2
    x, y = np.meshgrid(axis, axis)
    return x.ravel(), y.ravel()


def _fit_chunk(
    windows: Array, weights: Array, iterations: int, tolerance_px: float, exact: bool
) -> tuple[Array, Array, Array, Array, Array, Array, Mask]:
    n, size = len(windows), windows.shape[1]
    x, y = pixel_grid(size)
    weight = weights.reshape(n, -1)
    level = np.where(weight > 0, windows.reshape(n, -1), 0.0)
    best = guess(windows, weights)
    step = np.full(n, np.inf)
    coarse = (False, 30 * tolerance_px if exact else tolerance_px, 1e-3)
    for boxed, limit, start in (coarse, (True, tolerance_px, 1e-7))[: 1 + exact]:
        damping = np.full(n, start)
        residual, J = _residual(best, x, y, level, weight, boxed)
        cost = np.einsum("np,np->n", residual, residual)
        step = np.full(n, np.inf)
        active = np.arange(n)
        for _ in range(iterations):
            trial = best[active] + _steps(J[active], residual[active], damping[active])
            trial[:, BLUR_VAR] = np.clip(trial[:, BLUR_VAR], _MIN_BLUR_VAR, size**2 / 4)
            trial_residual, trial_J = _residual(trial, x, y, level[active], weight[active], boxed)
            trial_cost = np.einsum("np,np->n", trial_residual, trial_residual)
            better = trial_cost <= cost[active] * (1 + _SLACK)
            step[active] = np.hypot(trial[:, U] - best[active, U], trial[:, V] - best[active, V])
            gaining = cost[active] - trial_cost > _GAIN * cost[active]
            damping[active] = np.where(better, 0.1, 10) * damping[active]
            won = active[better]
            best[won], residual[won], J[won] = trial[better], trial_residual[better], trial_J[better]
            cost[won] = trial_cost[better]
            active = active[((step[active] > limit) | gaining) & (damping[active] < 1e6)]
            if active.size == 0:
                break
    # an edge as sharp as the model allows leaves its blur no room to vary
    J[best[:, BLUR_VAR] <= _MIN_BLUR_VAR, BLUR_VAR] = 0.0
    inverse = _inverse(_normal(J))
    leverage = np.einsum("nip,nip->np", J, inverse @ J)
    information = np.einsum("nip,nip->np", J[:, U : V + 1], J[:, U : V + 1])
    count = weight.sum(axis=1)
    clean = residual**2 / np.maximum(1 - leverage, 0.05)
    with np.errstate(divide="ignore", invalid="ignore"):
        edge = np.sum(information * clean, axis=1) / np.sum(information, axis=1)
        ratio = edge / (np.sum(clean * weight, axis=1) / count)
    return best, inverse, cost, count, ratio, _spread(residual, J, inverse, count), step <= 5 * tolerance_px


def _spread(residual: Array, J: Array, inverse: Array, count: Array) -> Array:
    """r^T B r / r^T r over what white noise would give, B summing 3 x 3 pixels; the fit takes its share of
    both: trace(B - B J^T (J J^T)^-1 J) and P - 7."""
    observed = np.einsum("np,np->n", residual, _box_sum(residual))
    taken = np.einsum("nij,nij->n", inverse, _box_sum(J) @ J.transpose(0, 2, 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        variance = np.einsum("np,np->n", residual, residual) / (count - PARAMETERS)
        return np.asarray(observed / (count - taken) / variance)


def _box_sum(values: Array) -> Array:
    """Sums over 3 x 3 pixels of windows (..., S^2), with zeros around."""
    size = round(values.shape[-1] ** 0.5)
    window = values.reshape(*values.shape[:-1], size, size)
    across = window.copy()
    across[..., 1:] += window[..., :-1]
    across[..., :-1] += window[..., 1:]
    total = across.copy()
    total[..., 1:, :] += across[..., :-1, :]
    total[..., :-1, :] += across[..., 1:, :]
    return total.reshape(values.shape)


def _residual(
    parameters: Array, x: Array, y: Array, level: Array, weight: Array, boxed: bool
) -> tuple[Array, Array]:
    value, J = _evaluate(parameters, x, y, exact=boxed, jacobian=True)
    J *= weight[:, None, :]
    return (level - value) * weight, J


def _normal(J: Array) -> Array:
    return np.asarray(J @ J.transpose(0, 2, 1))


def _steps(J: Array, residual: Array, damping: Array) -> Array:
    A = _normal(J)
    diagonal = np.einsum("nii->ni", A)
    floor = 1e-9 * diagonal.max(axis=1, keepdims=True) + 1e-12
    diagonal += damping[:, None] * diagonal + floor
    b = J @ residual[..., None]
    return np.asarray(np.linalg.solve(A, b)[..., 0])


def _inverse(A: Array) -> Array:
    """Inverse (N, 7, 7); NaN where a window leaves a parameter open."""
    diagonal = np.einsum("nii->ni", A)
    diagonal[diagonal == 0] = _HELD
    scale = np.sqrt(diagonal)
    unit = A / (scale[:, :, None] * scale[:, None, :])
    np.einsum("nii->ni", unit)[:] += 1e-12  # a singular matrix becomes a huge inverse instead of an error
    inverse = np.linalg.inv(unit)
    inverse[~(np.abs(inverse).max(axis=(1, 2)) < 1e9)] = np.nan
    return np.asarray(inverse / (scale[:, :, None] * scale[:, None, :]))


def _evaluate(parameters: Array, x: Array, y: Array, *, exact: bool, jacobian: bool) -> tuple[Array, Array]:
    """Grey levels (N, P) and, when asked, their derivatives (N, 7, P)."""
    p = parameters[:, None, :]
    dx, dy = x - p[..., U], y - p[..., V]
    edges = []
    for angle in (p[..., ANGLE_1], p[..., ANGLE_2]):
        c, s = np.cos(angle), np.sin(angle)
        t = dx * c + dy * s
        profile = _box_edge(t, c, s, p[..., BLUR_VAR]) if exact else _gauss_edge(t, p[..., BLUR_VAR])
        edges.append((c, s, t, *profile))
    (c1, s1, t1, e1, slope_1, bend_1), (c2, s2, t2, e2, slope_2, bend_2) = edges
    shape = e1 * e2
    if exact:
        shape += _corner_excess(t1, t2, c1 * c2 + s1 * s2, p[..., BLUR_VAR] + _PIXEL_VAR)
    value = p[..., OFFSET] + p[..., CONTRAST] * shape
    if not jacobian:
        return value, np.zeros((len(value), 0, x.size))
    J = np.empty((len(value), PARAMETERS, x.size))
    contrast = p[..., CONTRAST]
    by_t1, by_t2 = contrast * slope_1 * e2, contrast * slope_2 * e1
    J[:, OFFSET] = 1.0
    J[:, CONTRAST] = shape
    J[:, U] = -(c1 * by_t1 + c2 * by_t2)
    J[:, V] = -(s1 * by_t1 + s2 * by_t2)
    J[:, ANGLE_1] = by_t1 * (dy * c1 - dx * s1)
    J[:, ANGLE_2] = by_t2 * (dy * c2 - dx * s2)
    J[:, BLUR_VAR] = contrast * (bend_1 * e2 + bend_2 * e1)
    return value, J


def _gauss_edge(t: Array, blur_var: Array) -> tuple[Array, Array, Array]:
    """An edge whose pixel square is taken for more blur: value, d/dt and d/d(blur^2)."""
    var = blur_var + _PIXEL_VAR
    std = np.sqrt(var)
    slope = np.sqrt(2 / np.pi) / std * np.exp(-(t * t) / (2 * var))
    return erf(t / (np.sqrt(2) * std)), slope, -0.5 * t / var * slope


def _box_edge(t: Array, c: Array, s: Array, blur_var: Array) -> tuple[Array, Array, Array]:
    """An edge averaged over the pixel's square: value, d/dt and d/d(blur^2).

    G = (t^2 + b^2)/2 erf(t/(sqrt 2 b)) + sqrt(2/pi) b t/2 exp(-t^2/2b^2) has G'' = erf; by the heat
    equation d/d(b^2) is half of d^2/dt^2.
    """
    wide, narrow = np.maximum(np.abs(c), _MIN_WIDTH), np.maximum(np.abs(s), _MIN_WIDTH)
    blur = np.sqrt(blur_var)
    area = wide * narrow
    scale, falloff, height = 1 / (np.sqrt(2) * blur), -0.5 / blur_var, np.sqrt(2 / np.pi) * blur
    value, slope, bend = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
    outer, inner = (wide + narrow) / 2, (wide - narrow) / 2
    for shift, add in ((outer, np.add), (inner, np.subtract), (-inner, np.subtract), (-outer, np.add)):
        z = t + shift
        step = erf(z * scale)
        first = z * z
        first *= falloff
        np.exp(first, out=first)
        first *= height
        first += z * step
        add(slope, first, out=slope)
        add(bend, step, out=bend)
        # G = (z F + b^2 erf) / 2 with F = z erf + bell
        first *= z
        step *= blur_var
        first += step
        add(value, first, out=value)
    value *= 0.5 / area
    slope *= 1 / area
    bend *= 0.5 / area
    return value, slope, bend


def _corner_excess(t1: Array, t2: Array, rho: Array, var: Array) -> Array:
    """Mean of the product minus product of the means: 4 times the integral of the density over rho."""
    excess = np.zeros_like(t1)
    for node in _NODES:
        r = rho * node
        rest = 1 - r * r
        exponent = (t1 * t1 - 2 * r * t1 * t2 + t2 * t2) / (-2 * var * rest)
        excess += np.exp(exponent) / np.sqrt(rest)
    return np.asarray(excess * rho / np.pi)
