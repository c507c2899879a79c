"""Warps of the left image's windows into the right image, and the steps that improve them."""

from __future__ import annotations

import numpy as np

from rigsim.pixels.patches.spline import (
    REACH,
    Indices,
    RowSpline,
    derivative_noise_gain,
    error_kernels,
    phase_of,
)
from rigsim.pixels.patches.windows import Windows
from rigsim.rig.arrays import Array, Mask

_CONVERGED_PX = 2e-4
_STRETCH_LIMIT = 0.6
_MOST_GREY_NOISE = 0.75  # of the grey's variance, when gains are made larger for it
_MOST_NOISE = 0.9  # of the gradient's energy, when steps are made longer for it


class Warps:
    """The warps of N windows while they are fitted; the only state that a fit changes.

    `theta` and `residual` are those of the last step, before it was taken.
    """

    __slots__ = (
        "_solve",
        "_start",
        "kept",
        "residual",
        "shear",
        "shift",
        "stretch",
        "texture",
        "theta",
        "windows",
    )

    def __init__(self, windows: Windows, disparity: Array, noise_vars: Array) -> None:
        n, count = windows.template.shape
        self.windows = windows
        self.shift, self.stretch, self.shear = -disparity.astype(np.float64), np.ones(n), np.zeros(n)
        self.theta, self.residual = np.full((n, 5), np.nan), np.full((n, count), np.nan)
        self._solve = windows.inverse @ windows.J
        self._start = disparity
        self.allow_for(noise_vars)

    def allow_for(self, noise_vars: Array) -> None:
        """A noisy template makes the gain too small, as it makes the steps too short."""
        self.texture = _texture_share(noise_vars, self.windows.gradient_energy)
        self.kept = _kept_share(noise_vars, self.windows.grey_energy)

    @property
    def gain(self) -> Array:
        """Gain of the right image against the left one, (N,)."""
        return np.asarray((1 + self.theta[:, 3]) / self.kept)

    @property
    def affine(self) -> Array:
        """Shift, and what stretch and shear amount to at the window's edge, (N, 3), px."""
        radius = self.windows.radius
        return np.stack([self.shift, self.stretch * radius, self.shear * radius], axis=1)

    @property
    def left_over(self) -> Array:
        """What the last step's fit does not explain, (N, P)."""
        return np.asarray(self.residual - (self.theta[:, None, :] @ self.windows.J)[:, 0])

    @property
    def left_over_var(self) -> Array:
        """Its variance, (N,)."""
        left_over = self.left_over
        return np.asarray(np.einsum("np,np->n", left_over, left_over) / (left_over.shape[1] - 5))

    def improve(self, right: RowSpline, error: Array, noise: Array, most: int) -> Indices:
        """Take `most` steps, without the spline's `error` (N, P) and `noise` (N, 5); which still move."""
        windows, radius = self.windows, self.windows.radius
        shift, stretch, shear = self.shift, self.stretch, self.shear
        moving = np.flatnonzero(np.isfinite(shift))
        for _ in range(most):
            m = moving
            column = (windows.uv_left[m, 0] + shift[m])[:, None]
            warped = column + stretch[m, None] * windows.x_px + shear[m, None] * windows.y_px
            self.residual[m] = right.sample(windows.rows[m], warped) - windows.template[m] - error[m]
            step = self._solve[m] @ self.residual[m][..., None] + windows.inverse[m] @ noise[m][..., None]
            step = step[..., 0]
            self.theta[m] = step
            gain = (1 + step[:, 3]) / self.kept[m]
            with np.errstate(divide="ignore", invalid="ignore"):
                d_shift, d_stretch, d_shear = (step[:, :3] / (gain * self.texture[m])[:, None]).T
                # the warp after the inverse of the template's own
                stretch[m] /= 1 + d_stretch / radius
                shift[m] -= stretch[m] * d_shift
                shear[m] -= stretch[m] * d_shear / radius
            lost = _is_lost(shift[m] + self._start[m], stretch[m], shear[m], gain, radius)
            shift[m[lost]] = np.nan
            still = np.abs(step[:, :3]).max(axis=1) > _CONVERGED_PX * np.abs(gain) * self.texture[m]
            moving = m[still & ~lost]
            if not len(moving):
                break
        return moving

    def drop_unsettled(self, moving: Indices) -> None:
        """Give up those that are `moving` and far from the end."""
        limit = 50 * _CONVERGED_PX * self.texture[moving]
        self.shift[moving[np.abs(self.theta[moving, :3]).max(axis=1) > limit]] = np.nan


def _texture_share(noise_vars: Array, gradient_energy: Array) -> Array:
    """Share of the gradient's energy that is no noise, (N,)."""
    return np.asarray(1 - np.minimum(derivative_noise_gain() * noise_vars / gradient_energy, _MOST_NOISE))


def _kept_share(noise_vars: Array, grey_energy: Array) -> Array:
    """Share of the template's variance that is no noise, (N,)."""
    return np.asarray(1 - np.minimum(noise_vars / np.maximum(grey_energy, 1e-12), _MOST_GREY_NOISE))


def interpolation_error(windows: Windows, warps: Warps, noise_vars: Array) -> tuple[Array, Array]:
    """What the spline adds (N, P) to the template's own texture when interpolating it as it is warped.

    Also what the template's noise, which is no texture, makes of its product with the gradients, (N, 5).
    """
    kernels, with_derivative = error_kernels()
    position = (
        warps.shift[:, None] + warps.stretch[:, None] * windows.x_px + warps.shear[:, None] * windows.y_px
    )
    phase = phase_of(position)
    strip = np.lib.stride_tricks.sliding_window_view(windows.padded, 2 * REACH + 1, axis=1)
    error = np.einsum("npk,npk->np", strip[windows.rows, windows.columns], kernels[phase])
    product = noise_vars[:, None] * with_derivative[phase]
    moments = np.zeros((len(position), 5))
    for i, weight in enumerate((np.ones_like(windows.x), windows.x, windows.y)):
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
