"""What matches say about each other: surfaces are smooth but for steps."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from rigsim.pixels.patches.refine import Fits
from rigsim.pixels.patches.spline import Indices
from rigsim.rig.arrays import Array, Mask

WITNESSES = 3
"""This many neighbours make a vote."""

_ASKED = 8
_AGREE_PX = 2.0
_SAME_PLANE_PX = 0.3
_SIGMAS = 3.0
_REACH_WINDOWS = 4.0
_CURVED_PX = 1.0
_APART_WINDOWS = 0.8


def borne_out(
    fits: Fits, trusted: Mask, std: Array, noise_std: Array, *, window: int
) -> tuple[Mask, Array, Array]:
    """Which of N matches none of their neighbours bears out, and the share of neighbours on a match's plane.

    A window across two surfaces is fitted well by a plane of its own, which passes through neither: only the
    matches around it can tell. The eight nearest within four windows are asked. One bears a match out when
    either match's plane, carried on to the other, meets its disparity within 2 px; it lies on the plane
    when the match's own meets it within 0.3 px, or 3 standard deviations of the two and of the slope.
    A match that is not trusted, or not borne out, says nothing.

    Returns:
        Matches (N,) with three neighbours or more and none that bears them out; and the share (N,), 0 to 1,
        of those on the plane, NaN with fewer than three; and what the surface's curvature, as the neighbours
        show it, moves a plane's disparity by in the middle of its window, (N,), px.
    """
    members = np.flatnonzero(trusted)
    outvoted, share = np.zeros(len(trusted), dtype=bool), np.full(len(trusted), np.nan)
    bend = np.zeros(len(trusted))
    if len(members) <= WITNESSES:
        return outvoted, share, bend
    distance, found = cKDTree(fits.uv_left[members]).query(
        fits.uv_left[members], k=min(_ASKED + 1, len(members)), distance_upper_bound=_REACH_WINDOWS * window
    )
    near = np.asarray(found)[:, 1:]
    there = near < len(members)
    b: Indices = members[np.where(there, near, 0)]
    a: Indices = members[:, None]
    step = fits.uv_left[b] - fits.uv_left[a]
    departure = _departure(fits, a, b, step)
    off, back = np.abs(departure), np.abs(_departure(fits, b, a, -step))
    asked = there.sum(axis=1)
    supports = there & (np.minimum(off, back) < _AGREE_PX)
    outvoted[members] = (asked >= WITNESSES) & ~supports.any(axis=1)

    scale = (noise_std[members] / fits.noise_std[members]) ** 2
    slope_var = np.einsum("nki,nij,nkj->nk", step, fits.slope_var[members], step) * scale[:, None]
    off_std = np.sqrt(std[a] ** 2 + std[b] ** 2 + slope_var)
    says = there & ~outvoted[b]
    on_plane = says & (off < np.maximum(_SAME_PLANE_PX, _SIGMAS * off_std))
    heard = says.sum(axis=1)
    share[members] = np.where(heard >= WITNESSES, on_plane.sum(axis=1) / np.maximum(heard, 1), np.nan)
    curved = says & (off < _CURVED_PX) & (np.asarray(distance)[:, 1:] > _APART_WINDOWS * window)
    bend[members] = _bend(departure, step, curved, window)
    return outvoted, share, bend


def _bend(departure: Array, step: Array, says: Mask, window: int) -> Array:
    """Error (N,) px of planes fitted to paraboloids, from K neighbours' departures (N, K) px.

    Of ``k (x^2 + y^2) / 2`` a plane takes the mean over its window, ``k m`` with m the mean of x^2; a step
    away the paraboloid departs from that plane by ``k (step^2 / 2 - m)``.
    """
    mean_square = (window**2 - 1) / 12
    square = np.sum(step**2, axis=-1)
    growth = np.where(says, square / 2 - mean_square, 0.0)
    weight = np.where(says, 1 / np.maximum(square, 1.0), 0.0)  # the slope's noise grows with the distance
    bent = np.sum(weight * departure * growth, axis=1) / np.maximum(np.sum(weight * growth**2, axis=1), 1e-9)
    return np.where(says.sum(axis=1) >= WITNESSES, mean_square * bent, 0.0)


def _departure(fits: Fits, a: Indices, b: Indices, step: Array) -> Array:
    """How far the disparity of `b`, `step` (..., 2) px further on, departs from the plane of `a`, px."""
    predicted = fits.disparity[a] - fits.stretch[a] * step[..., 0] - fits.shear[a] * step[..., 1]
    return np.asarray(fits.disparity[b] - predicted)
