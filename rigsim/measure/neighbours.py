"""What matches say about each other: surfaces are smooth but for steps."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from rigsim.measure.refine import Fits
from rigsim.rig.arrays import Array, Mask

WITNESSES = 3
"""This many neighbours make a vote."""

_ASKED = 8
_AGREE_PX = 2.0
_SAME_PLANE_PX = 0.3
_SIGMAS = 3.0


def borne_out(fits: Fits, trusted: Mask, std: Array, noise_std: Array, reach_px: float) -> tuple[Mask, Array]:
    """Which of N matches none of their neighbours bears out, and the share of neighbours on a match's plane.

    A window across two surfaces is fitted well by a plane of its own, which passes through neither: only the
    matches around it can tell. The eight nearest within `reach_px` are asked. One bears a match out when
    either match's plane, carried on to the other, meets its disparity within 2 px; it lies on the plane
    when the match's own meets it within 0.3 px, or 3 standard deviations of the two and of the slope.
    A match that is not trusted, or not borne out, says nothing.

    Returns:
        Matches (N,) with three neighbours or more and none that bears them out; and the share (N,), 0 to 1,
        of those on the plane, NaN with fewer than three.
    """
    members = np.flatnonzero(trusted)
    outvoted, share = np.zeros(len(trusted), dtype=bool), np.full(len(trusted), np.nan)
    if len(members) <= WITNESSES:
        return outvoted, share
    _, found = cKDTree(fits.uv_left[members]).query(
        fits.uv_left[members], k=min(_ASKED + 1, len(members)), distance_upper_bound=reach_px
    )
    near = np.asarray(found)[:, 1:]
    there = near < len(members)
    b = members[np.where(there, near, 0)]
    a = members[:, None]
    step = fits.uv_left[b] - fits.uv_left[a]
    off, back = _departure(fits, a, b, step), _departure(fits, b, a, -step)
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
    return outvoted, share


def _departure(fits: Fits, a: Array, b: Array, step: Array) -> Array:
    """How far the disparity of `b`, `step` (..., 2) px further on, is from the plane of `a`, px."""
    predicted = fits.disparity[a] - fits.stretch[a] * step[..., 0] - fits.shear[a] * step[..., 1]
    return np.asarray(np.abs(fits.disparity[b] - predicted))
