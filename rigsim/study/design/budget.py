"""How a depth error asked for is shared out: so much of its variance for the noise, the rest for the build.

Noise and build err independently, so their mean squares add. A pick whose noise takes the whole error leaves
nothing for cameras that are mounted, and calibrated, by people: a share of the variance is kept for them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from rigsim.errors import InvalidRange
from rigsim.theory.inverse import Camera, Interval, Requirement, disparity_std_px

BUILD_SHARE = 0.5
"""Share of a depth error's variance that is the build's, unless asked for otherwise."""
MARGIN = 0.05
"""Room that a pick keeps from either end of its interval, where the interval has it."""


def check_share(build_share: float) -> None:
    """Refuse what is no share.

    Raises:
        InvalidRange: it is not from 0 to below 1.
    """
    if not 0 <= build_share < 1:
        raise InvalidRange(
            f"build share {build_share * 100:g} %: must be >= 0 % and < 100 %; noise always takes a part"
        )


def least_baseline_m(
    camera: Camera, requirements: Sequence[Requirement], noise_px: float, build_share: float
) -> float:
    """The shortest baseline, m, at which noise, and the calibration where one is counted, leave `build_share`
    of each depth error's variance."""
    sigma_d = disparity_std_px(noise_px)
    left = math.sqrt(1 - build_share)
    return max(
        replace(asked, limit=asked.limit * left).baseline_m(camera, sigma_d)
        for asked in requirements
        if asked.kind == "depth_error"
    )


def taken_shares(
    camera: Camera, baseline_m: float, requirements: Sequence[Requirement], disparity_std_px: float
) -> tuple[float, float]:
    """What noise and what the calibration take of the variance of the depth error asked for; of the one of
    which both together take most."""
    found = []
    for asked in requirements:
        if asked.kind == "depth_error":
            both, noise = (
                (one.achieved(camera, baseline_m, disparity_std_px) / asked.limit) ** 2
                for one in (asked, replace(asked, calibration=None))
            )
            found.append((noise, max(both - noise, 0.0)))
    return max(found, key=sum)


def picks(interval: Interval, least_m: float) -> tuple[float, ...]:
    """Baselines, m: near the short end, in the middle and near the long end; whole mm where there is room.

    The short end is where noise leaves enough for the build, `least_m`; where that is too long for the
    interval, the long end alone is picked.
    """
    low, high = interval.lower.baseline_m, interval.upper.baseline_m
    inner_low, inner_high = max(low * (1 + MARGIN), least_m), high / (1 + MARGIN)
    if low * (1 + MARGIN) >= inner_high:
        return (_whole_mm(math.sqrt(low * high), low, high),)
    if inner_low > inner_high:
        return (_whole_mm(inner_high, low, inner_high, math.floor),)
    return tuple(
        dict.fromkeys(
            (
                _whole_mm(inner_low, inner_low, inner_high, math.ceil),
                _whole_mm(math.sqrt(inner_low * inner_high), inner_low, inner_high),
                _whole_mm(inner_high, inner_low, inner_high, math.floor),
            )
        )
    )


def _whole_mm(value_m: float, low_m: float, high_m: float, turn: Callable[[float], int] = round) -> float:
    """`value_m` in whole mm, else in tenths, where that stays inside; else as it is."""
    for per_m in (1000, 10_000):
        whole = turn(round(value_m * per_m, 6)) / per_m
        if whole > 0 and low_m * (1 - 1e-9) <= whole <= high_m * (1 + 1e-9):
            return whole
    return value_m
