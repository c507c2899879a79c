"""Depth errors at distances, as several use cases ask for them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from rigsim.api.rigs import Several
from rigsim.errors import InvalidRange
from rigsim.rig import given


@dataclass(frozen=True, slots=True)
class DepthError:
    """One depth error at a distance: a length, a share of the distance, or two depths about it.

    Example:
        >>> import rigsim
        >>> rigsim.DepthError(3.0, mm=10).said, rigsim.DepthError(2.0, pct=1).error_m(2.0)
        ('10mm@3m', 0.02)
    """

    at_m: float | None = None
    """The distance, m; None for the use case's own."""
    mm: float | None = None
    """The error, mm."""
    pct: float | None = None
    """The error, percent of the distance."""
    bounds_mm: tuple[float, float] | None = None
    """Nearest and farthest depth that is measured there, mm."""
    p95: bool = False
    """Whether 95 of 100 errors stay under it; a root mean square, or one standard deviation, by default."""
    words: str = ""
    """How messages call it; made from the numbers by default."""

    @property
    def said(self) -> str:
        """How messages call it."""
        if self.words:
            return self.words
        what = f"{self.mm:g}mm" if self.mm is not None else f"{self.pct:g}%" if self.pct is not None else ""
        if self.bounds_mm is not None:
            what = f"{self.bounds_mm[0]:g}:{self.bounds_mm[1]:g}mm"
        return what if self.at_m is None else f"{what}@{self.at_m:g}m"

    def error_m(self, at_m: float) -> float:
        """The error at a distance of `at_m`, m."""
        if self.pct is not None:
            return self.pct / 100 * at_m
        return math.nan if self.mm is None else self.mm / 1e3


def at_distances(errors: DepthError | Sequence[DepthError]) -> tuple[DepthError, ...]:
    """One or several errors, each with its distance.

    Raises:
        InvalidRange: one has no distance or no size, or is over 100 % of the distance.
    """
    found = tuple(given.a(DepthError, one, "a DepthError") for one in given.several(errors))
    for one in found:
        if one.at_m is None:
            raise InvalidRange(f"require {one.said}: at which distance? As in 10mm@3m")
        if not (math.isfinite(one.at_m) and one.at_m > 0 and one.error_m(one.at_m) > 0):
            raise InvalidRange(f"require {one.said}: error and distance must be > 0")
        if one.pct is not None and one.pct > 100:
            raise InvalidRange(f"require {one.pct:g}%: must be <= 100 % of the distance")
    return found


def depth_errors(
    mm: Several | None,
    pct: Several | None,
    at_m: Several | None,
    p95: bool = False,
    more: Sequence[DepthError] = (),
) -> tuple[DepthError, ...]:
    """Errors in mm or percent, each at its own distance or all at one; and `more`.

    Raises:
        InvalidRange: both are given, or there are more or fewer distances.
    """
    more = tuple(given.a(DepthError, one, "a DepthError") for one in given.several(more))
    if mm is not None and pct is not None:
        raise InvalidRange("depth_error_mm and depth_error_pct both given: give one")
    if mm is None and pct is None:
        if at_m is not None:
            raise InvalidRange(f"at_m {given.shown(at_m)}: of which error? give depth_error_mm as well")
        return more
    name, errors = ("depth_error_mm", mm) if mm is not None else ("depth_error_pct", pct)
    values = given.reals(errors, name)
    distances: tuple[float | None, ...] = (None,) if at_m is None else given.reals(at_m, "at_m")
    if len(distances) == 1:
        distances *= len(values)
    if len(distances) != len(values):
        raise InvalidRange(f"at_m: {len(distances)} distances for {len(values)} errors: give as many, or one")
    made = (
        DepthError(at, value if mm is not None else None, value if mm is None else None, p95=p95)
        for value, at in zip(values, distances, strict=True)
    )
    return (*made, *more)
