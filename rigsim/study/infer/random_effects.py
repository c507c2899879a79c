"""Least squares on values that scatter more than their own variances say: random effects."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy import stats

from rigsim.rig.arrays import Array

CONFIDENCE = 0.95
"""Of every interval here."""
NORMAL = float(stats.norm.ppf((1 + CONFIDENCE) / 2))
"""Standard deviations to the ends of a normal interval."""
_LEAST = 0.8
_STEPS = 50
_STILL = 1e-9


@dataclass(frozen=True, slots=True)
class Effects:
    """Coefficients, and how sure they are."""

    values: Array
    """Coefficients (p,)."""
    ses: Array
    """Standard errors (p,); NaN where nothing tells them."""
    between: float
    """Variance between the values beyond their own; 0 where their own are enough."""
    reach: float
    """Standard errors from a coefficient to an end of its interval."""

    def half_width(self, which: int) -> float:
        """Half of the interval of coefficient `which`; NaN where nothing tells it."""
        return float(self.reach * self.ses[which])


def random_effects(
    columns: Array, values: Array, variances: Array | None, instruments: Array | None = None
) -> Effects:
    """Fit `values` (N,) by `columns` (N, p); each has its own of `variances` (N,), and all have one more.

    That one, the variance between the values, is Paule and Mandel's (1982): it makes the weighted squares
    of what is left as large as their expectation, ``N - p``, and is 0 where they are smaller. The interval
    is Hartung and Knapp's: Student's, N - p degrees of freedom, of what is left; where that is less
    than the values' own variances allow, between .8 and 1 of the normal one that those give. Without
    variances this is ordinary least squares. `instruments` (N, p) stand for columns that hold noise.
    """
    freedom = len(values) - columns.shape[1]
    if variances is None:
        found, ses, squares, _ = _solve(columns, values, np.ones_like(values), instruments)
        between = squares / freedom if freedom else math.nan
        return Effects(found, ses * math.sqrt(between), between, _student(freedom))
    between = _between(columns, values, variances, instruments) if freedom else 0.0
    found, ses, squares, _ = _solve(columns, values, variances + between, instruments)
    reach = _student(freedom)
    if between == 0 and freedom:
        reach = NORMAL * min(max(reach * math.sqrt(squares / freedom) / NORMAL, _LEAST), 1.0)
    return Effects(found, ses, between, reach)


@lru_cache(maxsize=64)
def _student(freedom: int) -> float:
    """Standard errors to the end of an interval; the normal's where nothing is left over."""
    return float(stats.t.ppf((1 + CONFIDENCE) / 2, freedom)) if freedom else NORMAL


def _solve(
    columns: Array, values: Array, variances: Array, instruments: Array | None
) -> tuple[Array, Array, float, float]:
    """Coefficients, their standard errors, the weighted squares that are left, and how fast those fall."""
    Z = columns if instruments is None else instruments
    projected = (Z / variances[:, None]).T
    sizes = np.linalg.norm(columns, axis=0)  # columns of very different size keep their digits
    inverse = np.linalg.pinv(projected @ (columns / sizes)) / sizes[:, None]
    found = inverse @ projected @ values
    ses = np.sqrt(np.diag(inverse @ projected @ Z @ inverse.T))
    left2 = (values - columns @ found) ** 2
    return found, ses, float((left2 / variances).sum()), float((left2 / variances**2).sum())


def _between(columns: Array, values: Array, variances: Array, instruments: Array | None) -> float:
    """The variance at which the weighted squares, which fall with it, are ``N - p``; 0 if less."""
    freedom = len(values) - columns.shape[1]
    between = 0.0
    for _ in range(_STEPS):
        _, _, squares, fall = _solve(columns, values, variances + between, instruments)
        if (between == 0 and squares <= freedom) or fall == 0:
            break
        # Newton's step on one over the squares, which is nearly straight
        step = (squares / freedom - 1) * squares / fall
        between = max(between + step, 0.0)
        if abs(step) <= _STILL * between:
            break
    return between
