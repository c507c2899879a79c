"""Planar lenses backwards: a root of what is radial, then Newton in the plane."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache, partial
from typing import TYPE_CHECKING

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.lens import polynomial
from rigsim.rig.lens.roots import MET, QUICK_STEPS, SAFE_STEPS, growing_root, newton

if TYPE_CHECKING:
    from rigsim.rig.lens.distortion import BrownConrady
    from rigsim.rig.lens.planar import NearlyRadialLens

_BLOCK = 8192
_HALVINGS = 12
_BELOW_ONE = 1 - 1e-15
"""The fold itself is a double root: what is found there is held this much inside."""


@lru_cache(maxsize=256)
def fold_radius2(k1: float, k2: float, k3: float) -> float:
    """Squared radius at which ``r (1 + k1 r^2 + k2 r^4 + k3 r^6)`` first turns back; infinite if never."""
    # the slope is 1 + 3 k1 s + 5 k2 s^2 + 7 k3 s^3, s = r^2, here in 1/s
    roots = np.roots([1.0, 3 * k1, 5 * k2, 7 * k3])
    real = roots.real[(np.abs(roots.imag) <= 1e-9 * np.abs(roots)) & (roots.real > 1e-12)]
    return float(1 / real.max()) if real.size else np.inf


@lru_cache(maxsize=256)
def dips2(lens: BrownConrady) -> tuple[float, ...]:
    """Squared radii within the fold at which p1 and p2 may fold what k1, k2 and k3 alone would not.

    There the slope of the radial polynomial has a minimum below ``6 |p| r``, the most that p1 and p2 take
    from it. What lies further out the same way is a second sheet of the image.
    """
    k1, k2, k3 = lens.k1, lens.k2, lens.k3
    p = math.hypot(lens.p1, lens.p2)
    found = []
    for s in _quadratic_roots(21 * k3, 10 * k2, 3 * k1):
        is_minimum = 0 < s < fold_radius2(k1, k2, k3) and 10 * k2 + 42 * k3 * s > 0
        if is_minimum and 1 + s * (3 * k1 + s * (5 * k2 + s * 7 * k3)) <= 6 * p * math.sqrt(s):
            found.append(s)
    return tuple(found)


def _quadratic_roots(a: float, b: float, c: float) -> list[float]:
    """Real roots of ``a s^2 + b s + c`` without loss where a or b are tiny."""
    inside = b * b - 4 * a * c
    if inside < 0:
        return []
    q = -(b + math.copysign(math.sqrt(inside), b)) / 2
    with np.errstate(all="ignore"):
        roots = np.divide([q, c], [a, q])
    return [float(root) for root in roots if np.isfinite(root)]


def undistort(lens: NearlyRadialLens, distorted: Array) -> Array:
    """Ideal (..., 2) that `lens` maps to `distorted` (..., 2); NaN where it shows nothing there."""
    flat = np.asarray(distorted, dtype=np.float64).reshape(-1, 2)
    ideal = np.empty_like(flat)
    with np.errstate(all="ignore"):
        for start in range(0, len(flat), _BLOCK):
            block = flat[start : start + _BLOCK]
            found = _radial(lens, block)
            ideal[start : start + _BLOCK] = found if lens.is_radial else _in_plane(lens, block, found)
    return ideal.reshape(np.shape(distorted))


def undistort_rows(lenses: Sequence[BrownConrady], counts: Sequence[int], distorted: Array) -> Array:
    """As `undistort`, the rows (N, 2) in order, so many `counts` of them by each of `lenses`."""
    rows = np.repeat(np.array([lens.coefficients for lens in lenses]).reshape(-1, 5), counts, axis=0)
    coefficients: polynomial.Coefficients = tuple(rows.T)
    folds = [fold_radius2(lens.k1, lens.k2, lens.k3) for lens in lenses]
    plain = np.array([not dips2(lens) for lens in lenses], dtype=np.bool_)
    with np.errstate(all="ignore"):
        target = np.hypot(*distorted.T)
        radius, missed = newton(partial(polynomial.radial, coefficients), target, target, QUICK_STEPS)
        ideal = distorted * np.where(target > 0, radius / target, 1.0)[:, None]
        met = np.repeat(plain, counts) & (np.abs(missed) <= MET * target) & (radius >= 0)
        tangential = np.flatnonzero(rows[:, 2:4].any(axis=1))
        some: polynomial.Coefficients = tuple(rows[tangential].T)
        aim, found = distorted[tangential], ideal[tangential]
        for _ in range(QUICK_STEPS):
            found -= newton_step(polynomial.jacobian(some, found), polynomial.distort(some, found) - aim)
        residual = polynomial.distort(some, found) - aim
        met[tangential] &= _is_met(residual, aim) & polynomial.is_one_to_one(some, found)
        ideal[tangential] = found
        met &= np.sum(ideal**2, axis=1) < np.repeat(folds, counts) * _BELOW_ONE
    ends = np.cumsum(counts)
    for lens, end, count in zip(lenses, ends, counts, strict=True):
        others = np.arange(end - count, end)[~met[end - count : end]]
        if others.size:
            ideal[others] = undistort(lens, distorted[others])
    return ideal


def newton_step(J: Array, residual: Array) -> Array:
    """``J^-1`` (N, 2, 2) times `residual` (N, 2)."""
    a, b, c, d = J[:, 0, 0], J[:, 0, 1], J[:, 1, 0], J[:, 1, 1]
    u, v = residual[:, 0], residual[:, 1]
    return np.asarray(np.stack([d * u - b * v, a * v - c * u], axis=1) / (a * d - b * c)[:, None])


def _radial(lens: NearlyRadialLens, distorted: Array) -> Array:
    """The inverse of what is radial alone; beyond the fold NaN, or its edge where other terms show more."""
    x, y = distorted[:, 0], distorted[:, 1]
    target = np.sqrt(x * x + y * y)
    fold = np.sqrt(lens.fold_radius2) * _BELOW_ONE
    reach = np.inf if np.isinf(fold) else float(lens.radial(np.array([fold]))[0][0])
    unseen = ~(target <= reach * (1 + 4e-16)) | ~np.isfinite(target)
    radius = np.full_like(target, np.nan)
    radius[~unseen] = growing_root(lens.radial, target[~unseen], np.minimum(target[~unseen], fold), fold)
    scale = np.where(target > 0, radius / target, 1.0)
    if not lens.is_radial:
        # the other terms move a point a little: that far beyond the fold's image some are shown
        scale = np.where(target > reach, fold / target, scale)
        unseen = ~(target <= reach + lens.aside(fold)) | ~np.isfinite(target)
    scale[unseen] = np.nan
    return distorted * scale[:, None]


def _in_plane(lens: NearlyRadialLens, distorted: Array, start: Array) -> Array:
    """Newton's method from the radial root `start` (N, 2); NaN stays NaN."""
    ideal = start.copy()
    for _ in range(QUICK_STEPS):
        ideal -= newton_step(lens.slope(ideal), lens.distort(ideal) - distorted)
    slow = ~(_is_met(lens.distort(ideal) - distorted, distorted) & lens.shows(ideal))
    slow &= np.isfinite(start).all(axis=1)
    if slow.any():
        ideal[slow] = _damped(lens, distorted[slow], start[slow])
    return ideal


def _damped(lens: NearlyRadialLens, distorted: Array, start: Array) -> Array:
    """Newton's steps, each cut until it stays where the lens shows and comes nearer; NaN where none does."""
    found = np.full_like(distorted, np.nan)
    ideal = start.copy()
    for _ in range(SAFE_STEPS):
        outside = ~lens.shows(ideal)
        if not outside.any():
            break
        ideal[outside] *= 0.9
    active = np.arange(len(ideal))
    for _ in range(SAFE_STEPS):
        target = distorted[active]
        residual = lens.distort(ideal) - target
        met = _is_met(residual, target)
        found[active[met]] = ideal[met]
        moved, better = _cut_step(lens, ideal, residual, target)
        goes_on = better & ~met
        active, ideal = active[goes_on], moved[goes_on]
        if not active.size:
            break
    return found


def _cut_step(lens: NearlyRadialLens, ideal: Array, residual: Array, target: Array) -> tuple[Array, Mask]:
    """Points one step on, and which of them came nearer."""
    step = newton_step(lens.slope(ideal), residual)
    before = np.hypot(*residual.T)
    moved, better = ideal.copy(), np.zeros(len(ideal), dtype=np.bool_)
    for halving in range(_HALVINGS):
        share = 0.5**halving
        trial = ideal - share * step
        after = np.hypot(*(lens.distort(trial) - target).T)
        take = ~better & lens.shows(trial) & (after < (1 - share / 4) * before)
        moved[take], better = trial[take], better | take
        if better.all():
            break
    return moved, better


def _is_met(residual: Array, distorted: Array) -> Mask:
    size = np.maximum(1.0, np.abs(distorted).max(axis=1))
    return np.asarray(np.abs(residual).max(axis=1) <= 10 * MET * size)
