"""What each quantity must be held to, so that 95 of 100 rigs are good with their pixel noise; first order."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from rigsim import statistics
from rigsim.rig.arrays import Array, Ids, Mask
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
    """Depth error (m, k) m of each of k independent numbers at the judged points."""
    even: Mask
    """Which (k,) lie evenly within a bound; the others are normal."""
    judge: Judge
    """What a rig is held to."""
    rows: tuple[Array, ...] = ()
    """Row misalignment (m, k) px at each distance; only a bound on it asks for them."""
    own: tuple[slice, ...] = ()
    """Which independent numbers each quantity is drawn by; one each where it is empty."""

    @property
    def groups(self) -> tuple[slice, ...]:
        """The same for every one of q quantities."""
        return self.own or tuple(slice(place, place + 1) for place in range(len(self.even)))

    @property
    def rms(self) -> Array:
        """Root mean square depth error (q,) m of each quantity."""
        return self._root(self.errors)

    def _root(self, errors: Array) -> Array:
        squares = (errors**2).mean(axis=0)
        return np.sqrt([squares[group].sum() for group in self.groups])

    def numbers(self, quantities: Ids) -> Ids:
        """Places of the independent numbers of some quantities, in their order."""
        every = np.arange(len(self.even), dtype=np.int32)
        return np.concatenate([every[:0], *(every[self.groups[place]] for place in quantities)])

    def spread(self, per_quantity: Array, quantities: Ids) -> Array:
        """A value of each of some quantities for each of their numbers."""
        return np.repeat(
            per_quantity, [len(self.numbers(quantities[i : i + 1])) for i in range(len(quantities))]
        )

    @property
    def row_rms(self) -> Array:
        """Largest root mean square row misalignment (q,) px over the distances; 0 where none is asked for."""
        if self.judge.required.row_px is None:
            return np.zeros(len(self.groups))
        return np.asarray(np.max([self._root(rows) for rows in self.rows], axis=0))

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
    found = needed_for_rows(held)
    for k in _that_matter(held.rms):
        numbers = held.numbers(np.array([k], dtype=np.int32))
        if len(numbers) == 1:
            one = held.errors[:, numbers[0]]
            ends = np.stack([one, -one]) * _reach(held.even[numbers[0]])
            factor = _largest_factor(ends, held.judge, 1.0)
        else:
            off = _deviates(held.even[numbers], np.arange(len(numbers), dtype=np.int32))
            fields = off @ held.errors[:_POINTS, numbers].T
            factor = _largest_factor(fields, held.judge.at_first(_POINTS), GOOD)
        found[k] = min(found[k], factor)
    return found


def needed_for_rows(held: HeldTo) -> Array:
    """The same factors (q,) for the bound on rows alone; infinite without one."""
    found = np.full(len(held.groups), np.inf)
    for k in held.that_move_rows:
        if not held.noise_allows:
            found[k] = 0.0
            continue
        numbers = held.numbers(np.array([k], dtype=np.int32))
        largest = held.row_rms[k] * _reach(held.even[numbers[0]])
        if len(numbers) > 1:
            off = _deviates(held.even[numbers], np.arange(len(numbers), dtype=np.int32))
            rows = [one[:_POINTS, numbers] for one in held.rows]
            largest = float(np.quantile(_worst_row_px(off, rows), GOOD))
        found[k] = held.row_limit_px / largest
    return found


def _reach(is_even: bool) -> float:
    """What 95 of 100 deviations are smaller than, in standard deviations."""
    return GOOD * math.sqrt(3) if is_even else float(ndtri((1 + GOOD) / 2))


def needed_at_equal_shares(held: HeldTo) -> Array:
    """The same when all that matter take an equal part of the variance, all together.

    With a bound on rows, each takes an equal part of theirs too, and holds the tighter of the two.
    """
    errors, rms, judge = held.errors, held.rms, held.judge
    matter = _that_matter(rms)
    found = np.full(len(held.groups), np.inf)
    others = np.setdiff1d(np.arange(len(found), dtype=np.int32), matter)
    off = _deviates(held.even, held.numbers(np.concatenate([matter, others])))
    # a metre of root mean square from each; points lie evenly, and so do the first of them
    numbers = held.numbers(matter)
    fields = off[:, numbers] @ (errors[:_POINTS, numbers] / held.spread(rms[matter], matter)).T
    found[matter] = _largest_factor(fields, judge.at_first(_POINTS), GOOD) / rms[matter]
    by_rows = held.that_move_rows
    if not len(by_rows):
        return found
    if not held.noise_allows:
        found[by_rows] = 0.0
        return found
    numbers = held.numbers(by_rows)
    unit = [rows[:_POINTS, numbers] / held.spread(held.row_rms[by_rows], by_rows) for rows in held.rows]
    largest = _worst_row_px(off[:, numbers], unit)
    found[by_rows] = np.minimum(
        found[by_rows], held.row_limit_px / float(np.quantile(largest, GOOD)) / held.row_rms[by_rows]
    )
    return found * _that_keeps_both(held, off, found)


def _that_keeps_both(held: HeldTo, off: Array, factors: Array) -> float:
    """What `factors` (q,) must be smaller by, so that 95 of 100 rigs keep both bounds at once."""
    every = np.arange(len(factors), dtype=np.int32)
    used = held.spread(np.where(np.isfinite(factors), factors, 0.0), every)
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


def _that_matter(rms: Array) -> Ids:
    # a quantity that moves no depth, such as a vertical shift, takes no share
    return np.flatnonzero(rms > 1e-9 * rms.max()).astype(np.int32)


def _largest_factor(fields: Array, judge: Judge, share: float) -> float:
    """The largest factor on depth errors (n, m) m at which `share` of the rigs is still good."""

    def enough(factor: float) -> bool:
        return bool(judge.is_good(judge.z + factor * fields).mean() >= share)

    if not enough(0.0):
        return 0.0
    # an error of ten times the bound in the root mean square is good for nobody
    low, high = 0.0, 10 * judge.required.error_m / statistics.rms(fields)
    for _ in range(_ROUNDS):
        middle = (low + high) / 2
        low, high = (middle, high) if enough(middle) else (low, middle)
        if high - low < 1e-4 * high:
            break
    return low
