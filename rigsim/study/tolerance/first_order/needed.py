"""What each quantity must be held to, so that 95 of 100 rigs are good with their pixel noise; first order."""

from __future__ import annotations

import math
from dataclasses import dataclass

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


@dataclass(frozen=True, slots=True, eq=False)
class HeldTo:
    """What quantities do, each off by one standard deviation, and what rigs are held to."""

    errors: Array
    """Depth error (m, q) m at the judged points."""
    even: Mask
    """Which (q,) lie evenly within a bound; the others are normal."""
    judge: Judge
    """What a rig is held to."""
    rows: tuple[Array, ...] = ()
    """Row misalignment (m, q) px at each distance; only a bound on it asks for them."""

    @property
    def row_rms(self) -> Array:
        """Largest root mean square row misalignment (q,) px over the distances; 0 where none is asked for."""
        if self.judge.required.row_px is None:
            return np.zeros(self.errors.shape[1])
        return np.asarray(np.max([np.sqrt((rows**2).mean(axis=0)) for rows in self.rows], axis=0))

    @property
    def that_move_rows(self) -> Ids:
        """Places of the quantities that a bound on rows holds."""
        return np.flatnonzero(self.row_rms > 1e-9 * self.row_rms.max()).astype(np.int32)

    @property
    def noise_allows(self) -> bool:
        """Whether a rig without any build error is good."""
        return bool(self.judge.is_good(self.judge.z[None])[0])

    @property
    def row_limit_px(self) -> float:
        """The bound on rows, px."""
        return math.inf if self.judge.required.row_px is None else self.judge.required.row_px


def needed_alone(held: HeldTo) -> Array:
    """Factors (q,) on tolerances, each of which alone then leaves 95 of 100 rigs good.

    Infinite where the quantity does nothing; 0 where noise alone is too much.
    """
    reach, found = _reach(held), needed_for_rows(held)
    for k in _that_matter(held.errors):
        ends = np.stack([held.errors[:, k], -held.errors[:, k]]) * reach[k]
        found[k] = min(found[k], _largest_factor(ends, held.judge, 1.0))
    return found


def needed_for_rows(held: HeldTo) -> Array:
    """The same factors (q,) for the bound on rows alone; infinite without one."""
    found = np.full(held.errors.shape[1], np.inf)
    by_rows = held.that_move_rows
    found[by_rows] = held.row_limit_px / (held.row_rms * _reach(held))[by_rows] if held.noise_allows else 0.0
    return found


def _reach(held: HeldTo) -> Array:
    """What 95 of 100 deviations (q,) are smaller than, in standard deviations."""
    return np.where(held.even, GOOD * math.sqrt(3), ndtri((1 + GOOD) / 2))


def needed_at_equal_shares(held: HeldTo) -> Array:
    """The same when all that matter take an equal part of the variance, all together.

    With a bound on rows, each takes an equal part of theirs too, and holds the tighter of the two.
    """
    errors, judge = held.errors, held.judge
    matter = _that_matter(errors)
    rms = np.sqrt((errors**2).mean(axis=0))
    found = np.full(errors.shape[1], np.inf)
    others = np.setdiff1d(np.arange(len(found)), matter)
    off = _deviates(held.even, np.concatenate([matter, others]))
    # a metre of root mean square from each; points lie evenly, and so do the first of them
    fields = off[:, matter] @ (errors[:_POINTS, matter] / rms[matter]).T
    found[matter] = _largest_factor(fields, judge.at_first(_POINTS), GOOD) / rms[matter]
    by_rows = held.that_move_rows
    if not len(by_rows):
        return found
    if not held.noise_allows:
        found[by_rows] = 0.0
        return found
    unit = [rows[:_POINTS, by_rows] / held.row_rms[by_rows] for rows in held.rows]
    largest = _worst_row_px(off[:, by_rows], unit)
    found[by_rows] = np.minimum(
        found[by_rows], held.row_limit_px / float(np.quantile(largest, GOOD)) / held.row_rms[by_rows]
    )
    return found * _that_keeps_both(held, off, found)


def _that_keeps_both(held: HeldTo, off: Array, factors: Array) -> float:
    """What `factors` (q,) must be smaller by, so that 95 of 100 rigs keep both bounds at once."""
    used = np.where(np.isfinite(factors), factors, 0.0)
    judge = held.judge.at_first(_POINTS)
    fields = off @ (held.errors[:_POINTS] * used).T
    largest = _worst_row_px(off, [rows[:_POINTS] * used for rows in held.rows])
    low, high = 0.0, 1.0
    for _ in range(_ROUNDS):
        middle = (low + high) / 2
        good = judge.is_good(judge.z + middle * fields) & (middle * largest <= held.row_limit_px)
        low, high = (middle, high) if good.mean() >= GOOD else (low, middle)
        if high - low < 1e-4 * high:
            break
    return low


def _worst_row_px(off: Array, rows: list[Array]) -> Array:
    """Largest root mean square row misalignment (n,) px of rigs off by `off` (n, q) over the distances."""
    return np.asarray(np.max([np.sqrt(((off @ one.T) ** 2).mean(axis=1)) for one in rows], axis=0))


def _deviates(even: Mask, order: Ids) -> Array:
    """Deviations (n, q) of rigs, in standard deviations, drawn in this `order` of the quantities."""
    rng = np.random.default_rng(0)
    turns = (rng.permuted(np.tile(np.arange(_RIGS), (len(even), 1)), axis=1).T + 0.5) / _RIGS
    found = np.empty(turns.shape)
    found[:, order] = np.where(even[order], math.sqrt(3) * (2 * turns - 1), ndtri(turns))
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
