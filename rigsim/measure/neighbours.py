"""What matches say about each other: surfaces are smooth but for steps."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from rigsim.measure.refine import Fits
from rigsim.measure.spline import Indices
from rigsim.rig.arrays import Array, Mask

_AGREE_PX = 2.0
_STEP_PX = 1.0
_WITNESSES = 3  # this many neighbours without one that agrees outvote a match


def outvoted_and_at_step(fits: Fits, trusted: Mask, reach_px: float) -> tuple[Mask, Mask]:
    """Which of N matches none of their neighbours bears out, and which lie near a step in disparity.

    A neighbour within `reach_px` agrees when either match's plane, carried on to the other, meets
    its disparity within 2 px; a step is a neighbour more than 1 px off a match's own plane. Matches
    that are not trusted, or outvoted, say nothing.
    """
    members = np.flatnonzero(trusted)
    outvoted, at_step = np.zeros(len(trusted), dtype=bool), np.zeros(len(trusted), dtype=bool)
    if len(members) < 2:
        return outvoted, at_step
    pairs = cKDTree(fits.uv_left[members]).query_pairs(reach_px, output_type="ndarray")
    a, b = members[np.concatenate([pairs, pairs[:, ::-1]])].T
    departure = _departure(fits, a, b)
    agrees = np.minimum(departure, _departure(fits, b, a)) < _AGREE_PX
    neighbours = np.bincount(a, minlength=len(trusted))
    supporters = np.bincount(a[agrees], minlength=len(trusted))
    outvoted = (neighbours >= _WITNESSES) & (supporters == 0)
    step = (departure > _STEP_PX) & ~outvoted[b]
    at_step[a[step]] = True
    return outvoted, at_step


def _departure(fits: Fits, a: Indices, b: Indices) -> Array:
    """How far the disparity of `b` is from the plane of `a`, px."""
    step = fits.uv_left[b] - fits.uv_left[a]
    predicted = fits.disparity[a] - fits.stretch[a] * step[:, 0] - fits.shear[a] * step[:, 1]
    return np.asarray(np.abs(fits.disparity[b] - predicted))
