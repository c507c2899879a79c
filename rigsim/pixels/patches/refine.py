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
    noise_gain,
)
from rigsim.pixels.patches.warps import Warps, interpolation_error
from rigsim.pixels.patches.windows import RIDGE, Windows
from rigsim.rig.arrays import Array

CHUNK = 128
"""Patches worked on together: their arrays stay in the cache."""

_ITERATIONS = 15
_BLOCKS = 3  # the window is cut into 3 x 3 blocks for the jackknife


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


def fit_patches(
    left: Array,
    left_gradient: Array,
    right: RowSpline,
    uv_left: Indices,
    disparity: Array,
    *,
    radius: int,
    noise_var: float = 0.0,
) -> Fits:
    """Fit square windows about whole pixels `uv_left` (N, 2), starting at `disparity` (N,), px.

    The windows must lie on the left image. `noise_var` is the variance of its noise, grey^2: steps that
    took the noise's gradient for the texture's would be too short, and end near where they began.
    """
    padded = np.pad(left, ((0, 0), (REACH, REACH)), mode="reflect")
    parts = [
        _fit(
            Windows.cut(padded, left_gradient, uv_left[i : i + CHUNK], radius),
            right,
            disparity[i : i + CHUNK],
            noise_var,
        )
        for i in range(0, max(len(uv_left), 1), CHUNK)
    ]
    return Fits(*(np.concatenate([getattr(part, item.name) for part in parts]) for item in fields(Fits)))


def _fit(windows: Windows, right: RowSpline, disparity: Array, noise_var: float) -> Fits:
    n, count = windows.template.shape
    noise_vars = np.full(n, noise_var)
    warps = Warps(windows, disparity, noise_vars)
    # first as if the spline were exact ...
    warps.drop_unsettled(warps.improve(right, np.zeros((n, count)), np.zeros((n, 5)), _ITERATIONS))
    plain = warps.affine
    # fine texture passes for noise, until it is seen to fit
    own = warps.left_over_var / (1 + (1 + warps.theta[:, 3]) ** 2)
    noise_vars = np.minimum(noise_vars, np.nan_to_num(own, nan=noise_var))
    warps.allow_for(noise_vars)
    # ... then twice more without what it gets wrong of this very texture
    for _ in range(2):
        error, noise = interpolation_error(windows, warps, noise_vars)
        gain = warps.gain[:, None]
        warps.improve(right, error * gain, noise * gain, 1)
    return _fits(windows, warps, warps.affine - plain)


def _fits(windows: Windows, warps: Warps, moved: Array) -> Fits:
    """What the fitted warps say; `moved` (N, 3) is what the spline's own error moved them by."""
    radius, inverse, shift = windows.radius, windows.inverse, warps.shift
    gain = np.where(np.isfinite(shift), warps.gain, np.nan)
    noise_weight = 1 + gain**2 * warps.kept
    moments = (windows.J @ warps.residual[..., None])[..., 0]
    residual_var = warps.left_over_var

    covariance = inverse[:, :3, :3] / gain[:, None, None] ** 2
    best = _best_offset(inverse)
    at = np.concatenate([np.ones((len(best), 1)), best], axis=1)
    variance = np.einsum("ni,nij,nj->n", at, covariance, at)
    best_px = np.round(best * radius)
    disparity_best = -(shift + (warps.stretch - 1) * best_px[:, 0] + warps.shear * best_px[:, 1])
    curvature, curvature_std = _curvature(windows, warps.left_over, at)
    phase = np.where(np.isfinite(shift), shift, 0.0) % 1.0
    return Fits(
        uv_left=windows.uv_left + best_px,
        disparity=disparity_best,
        noise_std=np.sqrt(variance),
        jackknife_std=_jackknife_std(windows, warps.residual, moments, at) / np.abs(gain),
        curvature_px=-curvature / gain,
        curvature_noise_std=curvature_std / np.abs(gain),
        residual_var=residual_var,
        noise_var=residual_var / (noise_weight * noise_gain(phase)),
        noise_weight=noise_weight,
        interpolation_px=-np.einsum("ni,ni->n", moved, at),
        slope_var=covariance[:, 1:, 1:] / radius**2,
        gradient_energy=windows.gradient_energy,
        gain=gain,
        stretch=warps.stretch - 1,
        shear=warps.shear,
    )


def _best_offset(inverse: Array) -> Array:
    """Offset (N, 2) in window radii, of the whole pixel where shift + stretch x + shear y varies least.

    There the affine parameters cost nothing: the disparity is known as well as if they were given.
    """
    return np.clip(-np.linalg.solve(inverse[:, 1:3, 1:3], inverse[:, 1:3, :1])[..., 0], -1, 1)


def _curvature(windows: Windows, residual: Array, at: Array) -> tuple[Array, Array]:
    """Shift (N,) at `at` (N, 3) that second-order terms would add, px, and its std per grey."""
    x, y, J = windows.x, windows.y, windows.J
    K = windows.gradient[:, None, :] * np.stack([x * x, x * y, y * y])
    mixed = windows.inverse @ J @ K.transpose(0, 2, 1)
    K -= mixed.transpose(0, 2, 1) @ J
    normal = K @ K.transpose(0, 2, 1)
    normal += RIDGE * (1 + np.trace(normal, axis1=1, axis2=2)[:, None, None]) * np.eye(3)
    terms = np.stack([at[:, 1] ** 2, at[:, 1] * at[:, 2], at[:, 2] ** 2], axis=1)
    terms -= np.einsum("nij,ni->nj", mixed[:, :3], at)
    weights = np.linalg.solve(normal, terms[..., None])[..., 0]
    shift = np.einsum("ni,nip,np->n", weights, K, residual, optimize=True)
    return shift, np.sqrt(np.einsum("ni,ni->n", weights, terms))


def _jackknife_std(windows: Windows, residual: Array, moments: Array, at: Array) -> Array:
    """Standard deviation (N,) of the disparity at `at` (N, 3) when a block of the window is left out."""
    side = 2 * windows.radius + 1
    n = len(at)
    J = windows.J.reshape(n, 5, side, side)
    residual = residual.reshape(n, side, side)
    cuts = np.linspace(0, side, _BLOCKS + 1).round().astype(int)
    estimates = []
    for top, bottom in itertools.pairwise(cuts):
        for start, stop in itertools.pairwise(cuts):
            block = J[:, :, top:bottom, start:stop].reshape(n, 5, -1)
            e = residual[:, top:bottom, start:stop].reshape(n, -1, 1)
            rest = windows.normal - block @ block.transpose(0, 2, 1)
            step = np.linalg.solve(rest, moments[..., None] - block @ e)[:, :3, 0]
            estimates.append(np.einsum("ni,ni->n", step, at))
    spread = np.array(estimates)
    blocks = len(spread)
    return np.asarray(np.sqrt((blocks - 1) / blocks * np.sum((spread - spread.mean(axis=0)) ** 2, axis=0)))
