"""Sobol indices of the depth error: what each quantity does alone, and what it does with the others.

A quantity's first-order index is the share of the variance it makes alone; its total index adds whatever
it makes together with others. For small errors both are the share of the variance of the first order;
where they part, quantities act on one another. SciPy's estimator (Saltelli et al., Comput. Phys. Commun.
181, 2010) does the sums. Over an image every point is an output of its own, and indices of many outputs
are the means of theirs weighted by variance (Gamboa et al., Electron. J. Stat. 8, 2014).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc, sobol_indices, t

from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.built import built_depths, deviates, rigs_a_block
from rigsim.study.tolerance.sensitivities import Causes

SHIFTS = 8
"""Independent repetitions, each its own shift of the same even points: they tell the sampling error."""
LOG2_SAMPLES = 9
"""Base-two logarithm of the samples in each."""
NOTICEABLE = 0.01
"""Share of the variance from which interactions are worth a word."""
_CHANCE = 1e-3  # that sampling alone makes any quantity of a study seem to act on others
_POINTS = 64
_EDGE = 1e-12
_ROUNDING = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class SobolIndices:
    """Sobol indices of some quantities, with the standard errors of their estimates."""

    first: Array
    """Share of the variance made alone (q,)."""
    first_se: Array
    """Its standard error (q,)."""
    total: Array
    """Share made alone and with others (q,)."""
    total_se: Array
    """Its standard error (q,)."""
    together: Array
    """Their difference (q,)."""
    together_se: Array
    """Its standard error (q,)."""

    @property
    def noticed(self) -> tuple[int, ...]:
        """Places of the quantities that act on others, noticeably and beyond the sampling error."""
        errors = t.isf(_CHANCE / len(self.together), SHIFTS - 1)
        sure = self.together > np.maximum(NOTICEABLE, errors * self.together_se)
        return tuple(np.flatnonzero(sure).tolist())


@dataclass(frozen=True, slots=True, eq=False)
class Interactions:
    """Sobol indices of a built rig's depth error at the judged depth."""

    keys: tuple[str, ...]
    """The quantities, as `Causes.names`."""
    error: SobolIndices
    """Of the error at every point of the image: the variance is the mean squared error but for its mean."""
    bias: SobolIndices | None
    """Of the mean over the image alone; None where it does not vary."""
    evaluations: int
    """Rigs built for it."""

    def place(self, key: str) -> int:
        """Place of a quantity in the indices."""
        return self.keys.index(key)


def interactions(rig: StereoRig, off: Causes, points: Array, rng: np.random.Generator) -> Interactions | None:
    """The indices of rigs off by `off`, over the first 64 of `points` (m, 3) m of one depth.

    None where a rig loses a point, so that there is no variance, or where no depth errs.
    """

    points = points[:_POINTS]

    def errors_m(deviations: Array) -> Array:
        found = np.empty((len(deviations), len(points) + 1))
        size = rigs_a_block(len(points))
        for start in range(0, len(deviations), size):
            block = slice(start, start + size)
            drawn = deviations[block]
            depths, _, _ = built_depths(rig, off.thetas(drawn), points, off.together(drawn))
            errors = depths - points[:, 2]
            # what moves no depth leaves rounding, which has no variance to share out
            found[block, :-1] = np.where(np.abs(errors) < _ROUNDING * points[:, 2], 0.0, errors)
        found[:, -1] = found[:, :-1].mean(axis=1)
        return found

    read = estimate(errors_m, lambda turns: deviates(off, turns), off.groups, rng)
    if read is None:
        return None
    per_output, variance = read
    error = combine(per_output[..., :-1], variance[:, :-1])
    if error is None:
        return None
    rigs = SHIFTS * (len(off.names) + 2) << LOG2_SAMPLES
    return Interactions(off.names, error, combine(per_output[..., -1:], variance[:, -1:]), rigs)


def estimate(
    model: Callable[[Array], Array],
    deviates_of: Callable[[Array], Array],
    groups: int | Sequence[slice],
    rng: np.random.Generator,
) -> tuple[Array, Array] | None:
    """First and total indices (2, q, s, m) and variances (s, m) of `model`, for each shift and output.

    `model` makes outputs (n, m) of deviations (n, k), and `deviates_of` those of even numbers in (0, 1).
    `groups` are the columns of each of q quantities; as many quantities of one column each where it is a
    number. None when an output is not finite.
    """
    if isinstance(groups, int):
        groups = [slice(place, place + 1) for place in range(groups)]
    quantities, numbers = len(groups), groups[-1].stop
    even = qmc.Sobol(2 * numbers, scramble=False).random_base2(LOG2_SAMPLES)
    found: list[Array] = []
    variances: list[Array] = []
    for _ in range(SHIFTS):
        turns = np.clip((even + rng.random(2 * numbers)) % 1, _EDGE, 1 - _EDGE)
        one, other = deviates_of(turns[:, :numbers]), deviates_of(turns[:, numbers:])
        swapped = np.repeat(one[None], quantities, axis=0)
        for place, columns in enumerate(groups):
            swapped[place][:, columns] = other[:, columns]
        outputs = model(np.concatenate([one, other, swapped.reshape(-1, numbers)]))
        if not np.isfinite(outputs).all():
            return None
        parts = outputs.reshape(quantities + 2, len(even), -1).transpose(0, 2, 1)
        variance = parts[:2].var(axis=(0, 2))
        varies = variance > 0
        shares = np.zeros((2, quantities, len(variance)))
        if varies.any():
            a, b, mixed = parts[0][varies], parts[1][varies], parts[2:][:, varies]
            result = sobol_indices(func={"f_A": a, "f_B": b, "f_AB": mixed}, n=len(even))
            # SciPy drops the axis of a single output
            for kind, values in enumerate((result.first_order, result.total_order)):
                shares[kind][:, varies] = values.reshape(-1, quantities).T
        found.append(shares)
        variances.append(variance)
    return np.stack(found, axis=2), np.stack(variances)


def combine(per_output: Array, variance: Array) -> SobolIndices | None:
    """Indices of many outputs from those of each (2, q, s, m), weighted by their variances (s, m)."""
    whole = variance.sum(axis=1)
    if not (whole > 0).all():
        return None
    # (2, q, s): one value for each shift
    first, total = (per_output * variance).sum(axis=-1) / whole
    pairs = [
        (values.mean(axis=1), values.std(axis=1, ddof=1) / math.sqrt(SHIFTS)) for values in (first, total)
    ]
    together = total - first
    pairs.append((together.mean(axis=1), together.std(axis=1, ddof=1) / math.sqrt(SHIFTS)))
    return SobolIndices(*(values for pair in pairs for values in pair))
