"""Which fits are trusted, and how far."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.pixels.patches.neighbours import borne_out
from rigsim.pixels.patches.refine import Fits
from rigsim.pixels.patches.spline import derivative_noise_gain
from rigsim.rig.arrays import Array, Mask

_WORST_STD_PX = 0.5
_NOISE_EXCESS = 4.0  # a residual this many times the noise's variance ...
_UNEXPLAINED = 0.05  # ... and this share of the squared gradient is another surface, not noise
_MOST_NOISE_SHARE = 0.6  # of the gradient's energy: beyond, a match's accuracy is a guess
_LEAST_ON_PLANE = 0.2  # share of neighbours on a match's own plane; below it, the plane spans two surfaces
_OFF_PLANE_FACTOR = 1.3  # how much less to trust a match none of whose neighbours is on its plane
_ONE_WAY = 1.5  # what is bent one way only, as a branch, shows less of its bend to neighbours all around
_UNKNOWN_FACTOR = 2.0  # and one without neighbours
_EXCESS_FROM = 1.15  # a residual's variance scatters by a tenth; beyond this it is texture that does not fit,
_EXCESS_STD = 1.5  # which is no white noise: it adds up to so many times what the noise does
_JACKKNIFE_NOISE = 2.0  # of nine blocks the variance scatters by half: this much may be chance
_CURVATURE_NOISE = 4.0
_MODEL_SHARE = 0.4  # of what leaving out and bending move the answer by; fitted to the bundled scenes' truth
_INTERPOLATION_PX = 5e-4
_INTERPOLATION_SHARE = 0.1  # of the spline's error that its correction leaves
_ALIASED_SHARE = 1.0  # and what aliasing makes of the same fine texture, where half of the fits leave over
_ALIASED = (1.1, 0.1)  # a tenth more than noise, or more: of noise alone it would be a twentieth
ENOUGH = 20
"""Fits of which a quantile tells something."""


@dataclass(frozen=True, slots=True, eq=False)
class Trust:
    """Which fits are trusted, (N,), and the standard deviation of their disparities, (N,) each, px."""

    trusted: Mask
    std: Array
    noise_std: Array


def trust(fits: Fits, noise_var: float, window: int) -> Trust:
    """Those that show one surface, are not lost in noise, and lie as their neighbours do."""
    std, noise_std = predicted_std(fits, noise_var)
    same_surface = (fits.noise_var < _NOISE_EXCESS * noise_var) | (
        fits.noise_var < _UNEXPLAINED * fits.gradient_energy
    )
    trusted = np.isfinite(fits.disparity) & same_surface & (std < _WORST_STD_PX)
    trusted &= noise_share(fits, noise_var) < _MOST_NOISE_SHARE
    outvoted, on_plane, bend = borne_out(fits, trusted, std, noise_std, window=window)
    trusted &= ~outvoted & ~(on_plane < _LEAST_ON_PLANE)
    std = np.hypot(std, _ONE_WAY * bend)
    std *= np.where(np.isnan(on_plane), _UNKNOWN_FACTOR, 1 + _OFF_PLANE_FACTOR * (1 - on_plane))
    return Trust(trusted, std, noise_std)


def predicted_std(fits: Fits, noise_var: float) -> tuple[Array, Array]:
    """Standard deviation of the disparities, and the part of it that noise explains, (N,) each, px.

    Args:
        fits: the fits.
        noise_var: least variance of one image's noise, grey^2; a fit that leaves more over has more.
    """
    local_var = np.maximum(fits.noise_var, noise_var)
    residual_std = np.sqrt(local_var * fits.noise_weight)
    # the template's gradient is noisy too: what it adds to the energy carries no information
    share = np.minimum(noise_share(fits, noise_var), 0.9)
    noise_std = fits.noise_std * residual_std / (1 - share)
    bend_std = fits.curvature_noise_std * residual_std
    parts = np.maximum(fits.jackknife_std**2 - _JACKKNIFE_NOISE * noise_std**2, 0)
    bend = np.maximum(fits.curvature_px**2 - _CURVATURE_NOISE * bend_std**2, 0)
    excess = np.clip(fits.noise_var / noise_var - _EXCESS_FROM, 0, 1)
    misfit = excess * (_EXCESS_STD * fits.noise_std) ** 2 * noise_var * fits.noise_weight
    known = fits.noise_var[np.isfinite(fits.noise_var)]
    typical = float(np.median(known)) / noise_var if len(known) >= ENOUGH and noise_var > 0 else 1.0
    aliased = float(np.clip((typical - _ALIASED[0]) / _ALIASED[1], 0, 1))
    fine = (_INTERPOLATION_SHARE + _ALIASED_SHARE * aliased) * fits.interpolation_px
    spline = _INTERPOLATION_PX**2 + fine**2
    return np.sqrt(noise_std**2 + _MODEL_SHARE * (parts + bend) + misfit + spline), noise_std


def noise_share(fits: Fits, noise_var: Array | float) -> Array:
    """Share of the gradient's energy that is noise of variance `noise_var` grey^2, (N,)."""
    return np.asarray(derivative_noise_gain() * noise_var / fits.gradient_energy)
