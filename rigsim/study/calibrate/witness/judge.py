"""Whether many calibrations bear the covariance out: one family of tests with one false alarm rate.

Of depth errors, in predicted standard deviations, their spread (chi-squared) and their mean (normal) at each
distance; of all parameters together their whitened spread, and of the residuals their size (chi-squared
both). Bonferroni over all of them holds the false alarms of a witness at `FALSE_ALARMS`; what a witness is
excused for is in its `Slack`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import cast

import numpy as np
from scipy.special import chdtri, gammainc, gammaincc, ndtr

from rigsim.rig.arrays import Array
from rigsim.study.agreement.agreement import Agreement, Reason, Witness, finite

FALSE_ALARMS = 1e-3
"""Probability that the calibrations of a right prediction are flagged, over all tests."""

FEW = 8
"""Calibrations below which nothing is said."""

BAND = (1 / 2, 2.0)
"""Where the spread of depths must lie, with its whole interval, to agree."""

_FAILED_SHARE = 0.02
_TAIL = 0.025


@dataclass(frozen=True, slots=True)
class Slack:
    """What no test counts."""

    spread: float
    """Relative excess, or lack, of a standard deviation."""
    mean: float
    """Mean error in predicted standard deviations."""
    misfit: float
    """Relative excess, or lack, of residuals."""


SIMULATED = Slack(spread=0.05, mean=0.1, misfit=0.02)
"""The prediction is of first order."""

MEASURED = Slack(spread=0.25, mean=0.5, misfit=0.1)
"""Corners of a picture are not all alike, and what the renderer's samples shift them by is no noise."""


@dataclass(frozen=True, slots=True, eq=False)
class JudgedErrors:
    """What many calibrations came to."""

    tried: int
    """Calibrations, those that failed included."""
    depth_z: Array
    """Depth errors over their predicted standard deviations, (k, distances)."""
    parameter_square: float
    """Sum of the whitened squares of all parameters' errors; NaN where there are none."""
    parameter_degrees: int
    """How many squares."""
    misfit: float
    """Residuals over what noise leaves; NaN where there is no noise."""
    misfit_degrees: int
    """Degrees of freedom of all residuals."""


@dataclass(frozen=True, slots=True)
class _Test:
    quantity: str
    reason: Reason
    p: float
    ratio: float
    sigmas: float


def judge(name: str, found: JudgedErrors, slack: Slack) -> Agreement:
    """What the calibrations come to.

    Flagged where the most telling test is beyond `FALSE_ALARMS`; untold where there were fewer than `FEW`, or
    the interval of a depth's spread reaches out of `BAND`.
    """
    witness, count = cast(Witness, name), len(found.depth_z)
    if count == 0:
        return Agreement("flagged", witness, "all-failed", "failures", 1.0)
    if found.tried - count > max(_FAILED_SHARE * found.tried, 1):
        return Agreement("flagged", witness, "some-failed", "failures", 1 - count / found.tried)
    if count < FEW:
        return Agreement("untold", witness, "too-few-trials", "depth spread", count=(count, FEW))
    if found.parameter_degrees == 0 or not np.isfinite(found.depth_z).all():
        return Agreement("untold", witness, "exact", "depth spread", cause="no corner noise")
    tests = list(_tests(found, slack))
    first = min(tests, key=lambda test: test.p)
    if not first.p >= FALSE_ALARMS / len(tests):
        return Agreement(
            "flagged", witness, first.reason, first.quantity, finite(first.ratio), sigmas=finite(first.sigmas)
        )
    ratio = float(np.sqrt((found.depth_z.var(axis=0, ddof=1)).mean()))
    low, high = (
        ratio * math.sqrt((count - 1) / float(chdtri(count - 1, tail))) for tail in (_TAIL, 1 - _TAIL)
    )
    if not (BAND[0] <= low and high <= BAND[1]):
        return Agreement("untold", witness, "unclear", "depth spread", finite(ratio), (low, high))
    return Agreement("agrees", witness, "", "depth spread", finite(ratio), (low, high))


def _tests(found: JudgedErrors, slack: Slack) -> Iterator[_Test]:
    count = len(found.depth_z)
    for z in found.depth_z.T:
        yield _spread("depth spread", float(z.var(ddof=1)), count - 1, slack.spread)
        off = max(abs(float(z.mean())) - slack.mean, 0.0) * math.sqrt(count)
        yield _Test("mean depth", "mean", 2 * float(ndtr(-off)), math.nan, off)
    if not math.isnan(found.parameter_square):
        square = found.parameter_square / found.parameter_degrees
        yield _spread("parameter spread", square, found.parameter_degrees, slack.spread)
    if found.misfit_degrees:
        yield _spread("residuals", found.misfit**2, found.misfit_degrees, slack.misfit)


def _spread(quantity: str, ratio2: float, degrees: float, slack: float) -> _Test:
    """A mean square over its expectation against chi-squared, what is excused taken off."""
    high, low = ratio2 / (1 + slack) ** 2, ratio2 * (1 + slack) ** 2
    upper = float(gammaincc(degrees / 2, degrees * high / 2))
    lower = float(gammainc(degrees / 2, degrees * low / 2))
    off = max(high - 1, 1 - low, 0.0) * math.sqrt(degrees / 2)
    return _Test(quantity, "spread", min(2 * min(upper, lower), 1.0), math.sqrt(ratio2), off)
