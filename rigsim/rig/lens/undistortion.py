"""Brown-Conrady lenses backwards: a bracketed root of the radial polynomial, then Newton in the plane."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.lens import polynomial

if TYPE_CHECKING:
    from rigsim.rig.lens.distortion import BrownConrady

_BLOCK = 8192
_QUICK_STEPS = 4
_SAFE_STEPS = 120
_HALVINGS = 12
_STILL = 4e-16
_MET = 1e-14
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


def undistort(lens: BrownConrady, distorted: Array) -> Array:
    """Ideal (..., 2) that `lens` maps to `distorted` (..., 2); NaN where it shows nothing there."""
    flat = np.asarray(distorted, dtype=np.float64).reshape(-1, 2)
    ideal = np.empty_like(flat)
    tangential = lens.p1 != 0 or lens.p2 != 0
    with np.errstate(all="ignore"):
        for start in range(0, len(flat), _BLOCK):
            block = flat[start : start + _BLOCK]
            found = _radial(lens, block, clamp=tangential)
            ideal[start : start + _BLOCK] = _in_plane(lens, block, found) if tangential else found
    return ideal.reshape(np.shape(distorted))


def undistort_rows(lenses: Sequence[BrownConrady], counts: Sequence[int], distorted: Array) -> Array:
    """As `undistort`, the rows (N, 2) in order, so many `counts` of them by each of `lenses`."""
    rows = np.repeat(np.array([lens.coefficients for lens in lenses]).reshape(-1, 5), counts, axis=0)
    coefficients: polynomial.Coefficients = tuple(rows.T)
    folds = [fold_radius2(lens.k1, lens.k2, lens.k3) for lens in lenses]
    plain = np.array([not dips2(lens) for lens in lenses], dtype=np.bool_)
    with np.errstate(all="ignore"):
        target = np.hypot(*distorted.T)
        radius, missed = polynomial.radial_steps(coefficients, target, target, _QUICK_STEPS)
        ideal = distorted * np.where(target > 0, radius / target, 1.0)[:, None]
        met = np.repeat(plain, counts) & (np.abs(missed) <= _MET * target) & (radius >= 0)
        tangential = np.flatnonzero(rows[:, 2:4].any(axis=1))
        some: polynomial.Coefficients = tuple(rows[tangential].T)
        aim, found = distorted[tangential], ideal[tangential]
        for _ in range(_QUICK_STEPS):
            found -= polynomial.newton_step(some, found, polynomial.distort(some, found) - aim)
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


def _radial(lens: BrownConrady, distorted: Array, clamp: bool) -> Array:
    """The inverse without p1 and p2; beyond the fold NaN, or its edge when `clamp`."""
    k1, k2, k3 = lens.k1, lens.k2, lens.k3
    x, y = distorted[:, 0], distorted[:, 1]
    target = np.sqrt(x * x + y * y)
    fold = np.sqrt(fold_radius2(k1, k2, k3)) * _BELOW_ONE
    reach = np.inf if np.isinf(fold) else fold * (1 + fold**2 * (k1 + fold**2 * (k2 + fold**2 * k3)))
    unseen = ~(target <= reach * (1 + 4e-16)) | ~np.isfinite(target)
    radius = np.minimum(target, fold)
    # ordinary lenses are done here, and need no bracket
    radius, missed = polynomial.radial_steps(lens.coefficients, target, radius, _QUICK_STEPS)
    slow = ~((np.abs(missed) <= _MET * target) & (radius >= 0) & (radius <= fold)) & ~unseen
    if slow.any():
        radius[slow] = _bracketed(lens, target[slow], fold)
    scale = np.where(target > 0, radius / target, 1.0)
    if clamp:
        # p1 and p2 move a point by up to 3 |p| r^2: that far beyond the fold's image some are shown
        scale = np.where(target > reach, fold / target, scale)
        unseen = ~(target <= reach + 3 * np.hypot(lens.p1, lens.p2) * fold**2) | ~np.isfinite(target)
    scale[unseen] = np.nan
    return distorted * scale[:, None]


def _bracketed(lens: BrownConrady, target: Array, fold: float) -> Array:
    """Root in [0, fold] of the radial polynomial, which grows there; Newton's steps, or halving."""
    k1, k2, k3 = lens.k1, lens.k2, lens.k3
    low, high = np.zeros_like(target), np.maximum(target, 1.0)
    if np.isfinite(fold):
        high = np.full_like(target, fold)
    else:
        for _ in range(1100):
            s = high * high
            short = high * (1 + s * (k1 + s * (k2 + s * k3))) < target
            if not short.any():
                break
            high = np.where(short, 2 * high, high)
    radius, last = np.clip(target, low, high), high
    for _ in range(_SAFE_STEPS):
        s = radius * radius
        value = radius * (1 + s * (k1 + s * (k2 + s * k3))) - target
        low, high = np.where(value < 0, radius, low), np.where(value < 0, high, radius)
        step = radius - value / (1 + s * (3 * k1 + s * (5 * k2 + s * 7 * k3)))
        # a step that is not half the last one may be part of a cycle
        good = (step >= low) & (step <= high) & (2 * np.abs(step - radius) <= last)
        moved = np.where(good, step, (low + high) / 2)
        last = np.abs(moved - radius)
        if (last <= _STILL * radius).all():
            break
        radius = moved
    return radius


def _in_plane(lens: BrownConrady, distorted: Array, start: Array) -> Array:
    """Newton's method from the radial root `start` (N, 2); NaN stays NaN."""
    ideal = start.copy()
    for _ in range(_QUICK_STEPS):
        residual = lens.distort(ideal) - distorted
        ideal -= polynomial.newton_step(lens.coefficients, ideal, residual)
    slow = ~(_is_met(lens.distort(ideal) - distorted, distorted) & lens.shows(ideal))
    slow &= np.isfinite(start).all(axis=1)
    if slow.any():
        ideal[slow] = _damped(lens, distorted[slow], start[slow])
    return ideal


def _damped(lens: BrownConrady, distorted: Array, start: Array) -> Array:
    """Newton's steps, each cut until it stays where the lens shows and comes nearer; NaN where none does."""
    found = np.full_like(distorted, np.nan)
    ideal = start.copy()
    for _ in range(_SAFE_STEPS):
        outside = ~lens.shows(ideal)
        if not outside.any():
            break
        ideal[outside] *= 0.9
    active = np.arange(len(ideal))
    for _ in range(_SAFE_STEPS):
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


def _cut_step(lens: BrownConrady, ideal: Array, residual: Array, target: Array) -> tuple[Array, Mask]:
    """Points one step on, and which of them came nearer."""
    step = polynomial.newton_step(lens.coefficients, ideal, residual)
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
    return np.asarray(np.abs(residual).max(axis=1) <= 10 * _MET * size)
