"""What each quantity must be held to, so that 95 of 100 rigs are good with their pixel noise; first order."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import ndtri

from rigsim.rig.arrays import Array, Ids, Mask
from rigsim.statistics import rms
from rigsim.study.tolerance.judge import Judge

GOOD = 0.95
"""Share of the rigs that must be good."""
_RIGS = 8000
_POINTS = 32
_ROUNDS = 40


def needed_alone(errors: Array, even: Mask, judge: Judge) -> Array:
    """Factors (q,) on tolerances, each of which alone then leaves 95 of 100 rigs good.

    Args:
        errors: depth error (m, q) m at the judged points, each quantity off by one standard deviation.
        even: which (q,) lie evenly within a bound; the others are normal.
        judge: what a rig is held to.

    Returns:
        Infinite where the quantity does nothing; 0 where noise alone is too much.
    """
    # 95 of 100 deviations are smaller than this, in standard deviations
    reach = np.where(even, GOOD * math.sqrt(3), ndtri((1 + GOOD) / 2))
    found = np.full(errors.shape[1], np.inf)
    for k in _that_matter(errors):
        ends = np.stack([errors[:, k], -errors[:, k]]) * reach[k]
        found[k] = _largest_factor(ends, judge, 1.0)
    return found


def needed_at_equal_shares(errors: Array, even: Mask, judge: Judge) -> Array:
    """The same when all that matter take an equal part of the variance, all together."""
    matter = _that_matter(errors)
    rms = np.sqrt((errors**2).mean(axis=0))
    found = np.full(errors.shape[1], np.inf)
    rng = np.random.default_rng(0)
    turns = (rng.permuted(np.tile(np.arange(_RIGS), (len(matter), 1)), axis=1).T + 0.5) / _RIGS
    off = np.where(even[matter], math.sqrt(3) * (2 * turns - 1), ndtri(turns))
    # a metre of root mean square from each; points lie evenly, and so do the first of them
    fields = off @ (errors[:_POINTS, matter] / rms[matter]).T
    found[matter] = _largest_factor(fields, judge.at_first(_POINTS), GOOD) / rms[matter]
    return found


def _that_matter(errors: Array) -> Ids:
    rms = np.sqrt((errors**2).mean(axis=0))
    # a quantity that moves no depth, such as a vertical shift, takes no share
    return np.flatnonzero(rms > 1e-9 * rms.max()).astype(np.int32)


def _largest_factor(fields: Array, judge: Judge, share: float) -> float:
    """The largest factor on depth errors (n, m) m at which `share` of the rigs is still good."""

    def enough(factor: float) -> bool:
        return bool(judge.is_good(judge.z + factor * fields).mean() >= share)

    if not enough(0.0):
        return 0.0
    # an error of ten times the bound in the root mean square is good for nobody
    low, high = 0.0, 10 * judge.required.error_m / rms(fields)
    for _ in range(_ROUNDS):
        middle = (low + high) / 2
        low, high = (middle, high) if enough(middle) else (low, middle)
        if high - low < 1e-4 * high:
            break
    return low
