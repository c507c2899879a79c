"""How far rows are apart at a distance, in images that are not rectified."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rigsim.api.calc.fact import Fact

if TYPE_CHECKING:
    from rigsim.rig.stereo import StereoRig

_KEYS = ("row_px", "row_least_px", "row_most_px")


def row_facts(rig: StereoRig, depth_m: float, *, sized: bool, seen: bool = True) -> list[Fact]:
    """Rows on the left optical axis, where it is `seen` by both, and over the image; 0 when rectified."""
    from rigsim.study.calc.plane import rows_apart

    found = rows_apart(rig, depth_m, sized=sized)
    over = "the same over the image that both see"
    values = (found.on_axis_px if seen else math.nan, found.least_px, found.most_px)
    told = (
        ("rows apart, not rectified", "on the axis; + is lower in the right image"),
        ("rows apart, least", f"{over}, the least"),
        ("rows apart, most", f"{over}, the greatest"),
    )
    return [
        Fact(key, name, value, "px", meaning)
        for key, value, (name, meaning) in zip(_KEYS, values, told, strict=True)
    ]


def for_people(facts: Sequence[Fact], rig: StereoRig) -> list[Fact]:
    """The facts without rows that a rectified rig never has apart, or that nobody knows."""
    untold = [
        fact for fact in facts if fact.key in _KEYS and (rig.is_rectified or math.isnan(float(fact.value)))
    ]
    return [fact for fact in facts if fact not in untold]
