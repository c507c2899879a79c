"""Patches of the left image fitted to the right one, to a small part of a pixel.

Inverse-compositional Gauss-Newton (Baker & Matthews, "Lucas-Kanade 20 years on", IJCV 2004) with a warp
of first order along the row, which is exact for slanted planes, and a gain and an offset of grey::

    right(u + shift + (1 + stretch) x + shear y, v + y) = gain left(u + x, v + y) + offset

The gradient is the left image's alone. Its noise is uncorrelated with the residual of a symmetric
derivative, so the estimate has no bias towards half pixels, as a gradient of the interpolated
right image would give it.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, fields

import numpy as np

from rigsim.pixels.patches.spline import (
    REACH,
    Indices,
    RowSpline,
    derivative_noise_gain,
    error_kernels,
    noise_gain,
    phase_of,
)
from rigsim.rig.arrays import Array, Mask

CHUNK = 128
"""Patches worked on together: their arrays stay in the cache."""

_BLOCKS = 3  # the window is cut into 3 x 3 blocks for the jackknife
_CONVERGED_PX = 2e-4
_STRETCH_LIMIT = 0.6
_RIDGE = 1e-10
_MOST_GREY_NOISE = 0.75  # of the grey's variance, when gains are made larger for it
_MOST_NOISE = 0.9  # of the gradient's energy, when steps are made longer for it


@dataclass(frozen=True, slots=True, eq=False)
class Fits:
    """What the fit of N patches found; NaN where it did not converge."""

    uv_left: Array
    """The pixel of each patch where its disparity is known best, (N, 2), whole px."""
    disparity: Array
    """``u_left - u_right`` at that pixel, (N,), px."""
    noise_std: Array
    """Standard deviation of the disparity for a residual of one grey level, (N,), px/grey."""
    jackknife_std: Array
    """Standard deviation of the disparity by leaving out one ninth of the window at a time, (N,), px."""
    curvature_px: Array
    """What the disparity would change by if the warp were of second order, (N,), px."""
    curvature_noise_std: Array
    """Standard deviation of `curvature_px` for a residual of one grey level, (N,), px/grey."""
    residual_var: Array
    """Variance of the residual, (N,), grey^2."""
    noise_var: Array
    """Variance of one image's noise that would explain the residual, (N,), grey^2."""
    noise_weight: Array
    """Variance of the residual that a unit of both images' noise makes, (N,)."""
    interpolation_px: Array
    """What the disparity was corrected by for the spline's own error, (N,), px."""
    slope_var: Array
    """Covariance of `stretch` and `shear` for a residual of one grey level, (N, 2, 2), grey^-2."""
    gradient_energy: Array
    """Mean squared gradient along the row, noise included, (N,), grey^2/px^2."""
    gain: Array
    """Gain of the right image against the left one, (N,)."""
    stretch: Array
    """Growth of the right patch along the row, (N,)."""
    shear: Array
    """Shift of the right patch a row further down, (N,), px/px."""


def window_offsets(radius: int) -> tuple[Indices, Indices]:
    """Column and row offsets of a square window's pixels, each ((2 radius + 1)^2,)."""
    y, x = np.mgrid[-radius : radius + 1, -radius : radius + 1]
    return x.ravel().astype(np.intp), y.ravel().astype(np.intp)


def fit_patches(
    left: Array,
    left_gradient: Array,
    right: RowSpline,
    uv_left: Indices,
    disparity: Array,
    *,
    radius: int,
    noise_var: float = 0.0,
    iterations: int = 15,
) -> Fits:
    """Fit square windows about whole pixels `uv_left` (N, 2), starting at `disparity` (N,), px.

    The windows must lie on the left image. `noise_var` is the variance of its noise, grey^2: steps that
    took the noise's gradient for the texture's would be too short, and end near where they began.
    """
    padded = np.pad(left, ((0, 0), (REACH, REACH)), mode="reflect")
    parts = [
        _fit(
            padded,
            left_gradient,
            right,
            uv_left[i : i + CHUNK],
            disparity[i : i + CHUNK],
            radius,
            iterations,
            noise_var,
        )
        for i in range(0, max(len(uv_left), 1), CHUNK)
    ]
    return Fits(*(np.concatenate([getattr(part, item.name) for part in parts]) for item in fields(Fits)))


def _fit(
    padded: Array,
    left_gradient: Array,
    right: RowSpline,
    uv_left: Indices,
    disparity: Array,
    radius: int,
    iterations: int,
    noise_var: float,
) -> Fits:
    x_px, y_px = window_offsets(radius)
    rows = uv_left[:, 1:] + y_px
    columns = uv_left[:, :1] + x_px
    x, y = x_px / radius, y_px / radius  # the affine parameters are px at the window's edge
    template, gradient = padded[rows, columns + REACH], left_gradient[rows, columns]
    centred = template - template.mean(axis=1, keepdims=True)
    J = np.stack([gradient, gradient * x, gradient * y, centred, np.ones_like(centred)], axis=1)
    normal = J @ J.transpose(0, 2, 1)
    # a flat patch gives a huge variance, not an exception
    normal += _RIDGE * (1 + np.trace(normal, axis1=1, axis2=2)[:, None, None]) * np.eye(5)
    inverse = np.linalg.inv(normal)
    solve = inverse @ J
    gradient_energy = np.mean(gradient**2, axis=1)
    n, count = len(uv_left), len(x)
    shift, stretch, shear = -disparity.astype(np.float64), np.ones(n), np.zeros(n)
    theta, residual = np.full((n, 5), np.nan), np.full((n, count), np.nan)
    error, noise = np.zeros((n, count)), np.zeros((n, 5))
    plain = np.zeros((n, 3))
    noise_vars = np.full(n, noise_var)
    texture = _texture_share(noise_vars, gradient_energy)
    # a noisy template makes the gain too small, as it makes the steps too short
    grey_energy = np.mean(centred**2, axis=1)
    kept = _kept_share(noise_vars, grey_energy)
    # first as if the spline were exact, then twice more without what it gets wrong of this very texture
    for turn, most in enumerate((iterations, 1, 1)):
        if turn:
            position = shift[:, None] + stretch[:, None] * x_px + shear[:, None] * y_px
            error, noise = _interpolation_error(padded, rows, columns, position, noise_vars, x, y)
            gain = (1 + theta[:, 3]) / kept
            error *= gain[:, None]
            noise *= gain[:, None]
        moving = np.flatnonzero(np.isfinite(shift))
        for _ in range(most):
            m = moving
            warped = (uv_left[m, 0] + shift[m])[:, None] + stretch[m, None] * x_px + shear[m, None] * y_px
            residual[m] = right.sample(rows[m], warped) - template[m] - error[m]
            step = (solve[m] @ residual[m][..., None] + inverse[m] @ noise[m][..., None])[..., 0]
            theta[m] = step
            gain = (1 + step[:, 3]) / kept[m]
            with np.errstate(divide="ignore", invalid="ignore"):
                d_shift, d_stretch, d_shear = (step[:, :3] / (gain * texture[m])[:, None]).T
                # the warp after the inverse of the template's own
                stretch[m] /= 1 + d_stretch / radius
                shift[m] -= stretch[m] * d_shift
                shear[m] -= stretch[m] * d_shear / radius
            lost = _is_lost(shift[m] + disparity[m], stretch[m], shear[m], gain, radius)
            shift[m[lost]] = np.nan
            still = np.abs(step[:, :3]).max(axis=1) > _CONVERGED_PX * np.abs(gain) * texture[m]
            moving = m[still & ~lost]
            if not len(moving):
                break
        if not turn:
            limit = 50 * _CONVERGED_PX * texture[moving]
            shift[moving[np.abs(theta[moving, :3]).max(axis=1) > limit]] = np.nan
            plain = np.stack([shift, stretch * radius, shear * radius], axis=1)
            # fine texture passes for noise, until it is seen to fit
            left_over = residual - (theta[:, None, :] @ J)[:, 0]
            own = np.einsum("np,np->n", left_over, left_over) / (count - 5) / (1 + (1 + theta[:, 3]) ** 2)
            noise_vars = np.minimum(noise_vars, np.nan_to_num(own, nan=noise_var))
            texture = _texture_share(noise_vars, gradient_energy)
            kept = _kept_share(noise_vars, grey_energy)

    gain = np.where(np.isfinite(shift), (1 + theta[:, 3]) / kept, np.nan)
    noise_weight = 1 + gain**2 * kept
    moments = (J @ residual[..., None])[..., 0]
    left_over = residual - (theta[:, None, :] @ J)[:, 0]
    residual_var = np.einsum("np,np->n", left_over, left_over) / (count - 5)

    covariance = inverse[:, :3, :3] / gain[:, None, None] ** 2
    best = _best_offset(inverse)
    at = np.concatenate([np.ones((n, 1)), best], axis=1)
    variance = np.einsum("ni,nij,nj->n", at, covariance, at)
    best_px = np.round(best * radius)
    disparity_best = -(shift + (stretch - 1) * best_px[:, 0] + shear * best_px[:, 1])
    moved = np.stack([shift, stretch * radius, shear * radius], axis=1) - plain
    curvature, curvature_std = _curvature(J, gradient, left_over, inverse, at, x, y)
    phase = np.where(np.isfinite(shift), shift, 0.0) % 1.0
    return Fits(
        uv_left=uv_left + best_px,
        disparity=disparity_best,
        noise_std=np.sqrt(variance),
        jackknife_std=_jackknife_std(J, residual, normal, moments, radius, at) / np.abs(gain),
        curvature_px=-curvature / gain,
        curvature_noise_std=curvature_std / np.abs(gain),
        residual_var=residual_var,
        noise_var=residual_var / (noise_weight * noise_gain(phase)),
        noise_weight=noise_weight,
        interpolation_px=-np.einsum("ni,ni->n", moved, at),
        slope_var=covariance[:, 1:, 1:] / radius**2,
        gradient_energy=gradient_energy,
        gain=gain,
        stretch=stretch - 1,
        shear=shear,
    )


def _texture_share(noise_vars: Array, gradient_energy: Array) -> Array:
    """Share of the gradient's energy that is no noise, (N,)."""
    return np.asarray(1 - np.minimum(derivative_noise_gain() * noise_vars / gradient_energy, _MOST_NOISE))


def _kept_share(noise_vars: Array, grey_energy: Array) -> Array:
    """Share of the template's variance that is no noise, (N,)."""
    return np.asarray(1 - np.minimum(noise_vars / np.maximum(grey_energy, 1e-12), _MOST_GREY_NOISE))


def _interpolation_error(
    padded: Array, rows: Indices, columns: Indices, position: Array, noise_vars: Array, x: Array, y: Array
) -> tuple[Array, Array]:
    """What the spline adds (N, P) to the template's own texture when it interpolates it at `position` (N, P).

    Also what the template's noise, which is no texture, makes of its product with the gradients, (N, 5).
    """
    kernels, with_derivative = error_kernels()
    phase = phase_of(position)
    strip = np.lib.stride_tricks.sliding_window_view(padded, 2 * REACH + 1, axis=1)
    error = np.einsum("npk,npk->np", strip[rows, columns], kernels[phase])
    product = noise_vars[:, None] * with_derivative[phase]
    moments = np.zeros((len(position), 5))
    for i, weight in enumerate((np.ones_like(x), x, y)):
        moments[:, i] = (product * weight).sum(axis=1)
    return error, moments


def _is_lost(moved: Array, stretch: Array, shear: Array, gain: Array, radius: int) -> Mask:
    """Whether a fit left the neighbourhood its start vouches for, or the image (NaN)."""
    near = (
        (np.abs(moved) < max(2.0, radius / 3))
        & (np.abs(stretch - 1) < _STRETCH_LIMIT)
        & (np.abs(shear) < _STRETCH_LIMIT)
        & (gain > 0.25)
        & (gain < 4)
    )
    return ~near


def _best_offset(inverse: Array) -> Array:
    """Offset (N, 2) in window radii, of the whole pixel where shift + stretch x + shear y varies least.

    There the affine parameters cost nothing: the disparity is known as well as if they were given.
    """
    return np.clip(-np.linalg.solve(inverse[:, 1:3, 1:3], inverse[:, 1:3, :1])[..., 0], -1, 1)


def _curvature(
    J: Array, gradient: Array, residual: Array, inverse: Array, at: Array, x: Array, y: Array
) -> tuple[Array, Array]:
    """Shift (N,) at `at` (N, 3) that second-order terms would add, px, and its std per grey."""
    K = gradient[:, None, :] * np.stack([x * x, x * y, y * y])
    mixed = inverse @ J @ K.transpose(0, 2, 1)
    K -= mixed.transpose(0, 2, 1) @ J
    normal = K @ K.transpose(0, 2, 1)
    normal += _RIDGE * (1 + np.trace(normal, axis1=1, axis2=2)[:, None, None]) * np.eye(3)
    terms = np.stack([at[:, 1] ** 2, at[:, 1] * at[:, 2], at[:, 2] ** 2], axis=1)
    terms -= np.einsum("nij,ni->nj", mixed[:, :3], at)
    weights = np.linalg.solve(normal, terms[..., None])[..., 0]
    shift = np.einsum("ni,nip,np->n", weights, K, residual, optimize=True)
    return shift, np.sqrt(np.einsum("ni,ni->n", weights, terms))


def _jackknife_std(J: Array, residual: Array, normal: Array, moments: Array, radius: int, at: Array) -> Array:
    """Standard deviation (N,) of the disparity at `at` (N, 3) when a block of the window is left out."""
    side = 2 * radius + 1
    n = len(J)
    J = J.reshape(n, 5, side, side)
    residual = residual.reshape(n, side, side)
    cuts = np.linspace(0, side, _BLOCKS + 1).round().astype(int)
    estimates = []
    for top, bottom in itertools.pairwise(cuts):
        for start, stop in itertools.pairwise(cuts):
            block = J[:, :, top:bottom, start:stop].reshape(n, 5, -1)
            e = residual[:, top:bottom, start:stop].reshape(n, -1, 1)
            rest = normal - block @ block.transpose(0, 2, 1)
            step = np.linalg.solve(rest, moments[..., None] - block @ e)[:, :3, 0]
            estimates.append(np.einsum("ni,ni->n", step, at))
    spread = np.array(estimates)
    blocks = len(spread)
    return np.asarray(np.sqrt((blocks - 1) / blocks * np.sum((spread - spread.mean(axis=0)) ** 2, axis=0)))
