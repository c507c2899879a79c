"""What noise makes of a depth beyond the first order, and back: how much noise an error allows.

Everything is a share of the depth. ``s = sigma_Z / Z`` is the first order (Gallup et al., CVPR 2008). The
depth goes with one over a disparity whose error is normal, ``Z' = Z / (1 + s n)``, so that

- its mean square error is ``s^2 + 9 s^4 + 75 s^6 + ...``, an asymptotic series: these three terms are within
  2 % of an RMS of 22 %, and say too little once s nears a quarter, where `LEAST_DEPTH_SIGMAS` ends;
- 95 of 100 errors are smaller than r when n lies between ``-r / (1 + r) / s`` and ``r / (1 - r) / s`` with
  that probability: exact.

Where that is within 1 % of the first order, the first order is what is used: it is what everybody quotes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache, lru_cache

P95_OVER_STD = 1.959963984540054
"""95 of 100 normal errors are smaller than this many standard deviations, either sign."""
FIRST_ORDER_OFF = 0.01
"""Relative error of the first order from which it is not used."""


def noise_error(std: float, p95: bool = False) -> float:
    """Depth error that noise makes where the first-order standard deviation is `std`; shares of the depth.

    The root mean square, or with `p95` what 95 of 100 errors stay under.
    """
    first = std * (P95_OVER_STD if p95 else 1.0)
    if not 0 < std < math.inf:
        return first
    whole = _p95(std) if p95 else _rms(std)
    return whole if whole > first * (1 + FIRST_ORDER_OFF) else first


@lru_cache(maxsize=1024)
def noise_allowed(error: float, p95: bool = False) -> float:
    """The largest `std` whose `noise_error` is at most `error`; shares of depth."""
    first = error / (P95_OVER_STD if p95 else 1.0)
    if noise_error(first, p95) <= first * (P95_OVER_STD if p95 else 1.0):
        return first
    law = _p95 if p95 else _rms
    # between the two laws the error jumps by 1 %: there the last of the first order is the most
    return max(_largest(lambda std: law(std) <= error, first), min(_first_order_ends(p95), first))


def _rms(std: float) -> float:
    a = std * std
    return math.sqrt(a * (1 + a * (9 + 75 * a)))


def _p95(std: float) -> float:
    def enough(within: float) -> bool:
        near = within / (1 - within) if within < 1 else math.inf
        return _below(near / std) - _below(-within / (1 + within) / std) >= 0.95

    # over a normal's it may be infinite: the far side never ends where infinity is within reach
    most = 1e6
    return math.inf if not enough(most) else _largest(lambda within: not enough(within), most)


@cache
def _first_order_ends(p95: bool) -> float:
    """The largest std for which the first order is within 1 %."""
    factor, law = (P95_OVER_STD, _p95) if p95 else (1.0, _rms)
    return _largest(lambda std: law(std) <= std * factor * (1 + FIRST_ORDER_OFF), 0.25)


def _largest(holds: Callable[[float], bool], most: float) -> float:
    """The largest number up to `most` for which `holds`, that holds below it and not above; by bisection."""
    low, high = 0.0, most
    if holds(high):
        return high
    while low < (middle := (low + high) / 2) < high:
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def _below(value: float) -> float:
    """Probability that a standard normal number is below `value`."""
    return 0.5 * math.erfc(-value / math.sqrt(2))
