"""The disparities that a matcher searches, as typed, as published, or as assumed."""

from __future__ import annotations

from rigsim.api.calc.limits import Search
from rigsim.typed import quantity
from rigsim.typed.rigs import RigOptions

_ASSUMED = (1.0, 128.0)


def searched(options: RigOptions, disparities: str | None) -> Search:
    """The disparities that are searched: those typed, else the published ones, else 1 to 128 px.

    Raises:
        InvalidRange: what was typed cannot be read.
    """
    if disparities is not None:
        return Search(*quantity.span(disparities, quantity.DISPARITY), "as asked")
    published = options.published_search()
    if published is None:
        return Search(*_ASSUMED, "assumed")
    (low_px, high_px), says = published
    return Search(low_px, high_px, says)
