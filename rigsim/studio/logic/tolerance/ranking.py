"""The quantities of a build by what they do, and how many built rigs are good: runs beside the page."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rigsim.errors import RigsimError
from rigsim.studio.logic.faults import plain
from rigsim.studio.logic.tolerance import built as logic
from rigsim.studio.state import State
from rigsim.studio.words import OF_RIG

_WORDS = (*sorted(OF_RIG - {"principal"}), "noise", "range", "depth_error", "class", "max_row_error")


@dataclass(frozen=True, slots=True)
class RankedQuantity:
    """One quantity of a class's rigs, alone, off by its standard deviation; first order."""

    name: str
    """For people."""
    common_mm: float
    """What the whole image shares, mm; signed."""
    differing_mm: float
    """Standard deviation over the image of the rest, mm."""
    cells: tuple[str, ...]
    """Tolerance, share of the variance, needed alone, needed at equal shares, unit, as people see them."""


@dataclass(frozen=True, slots=True, eq=False)
class Ranking:
    """A tolerance study, in words and files."""

    words: Mapping[str, str]
    """The words that it answers."""
    fault: str
    """Why there is none; else empty."""
    quantities: tuple[RankedQuantity, ...] = ()
    """The worst first."""
    headline: str = ""
    """How many of the built rigs are good."""
    as_built: float = math.nan
    """Share of rigs that are good as built, 0 to 1."""
    recalibrated: float = math.nan
    """The same after a recalibration; NaN where none is counted yet."""
    at_m: float = math.nan
    """Distance of the errors, m."""
    csv: bytes = b""
    """tolerance.csv."""
    whole: bool = True
    """Whether recalibrated rigs are counted already."""


def rank(words: Mapping[str, str], whole: bool) -> Ranking:
    """Rank and count for the words of the page; never raises what a user can cause.

    Args:
        words: the words.
        whole: count recalibrated rigs as well, which takes seconds.
    """
    from rigsim.api.tolerance import tolerance
    from rigsim.interop.files.tables import csv_bytes
    from rigsim.present.tolerance.console import quantity_rows

    state = State(words)
    try:
        made = tolerance(**arguments(state), recalibrate=whole)
    except RigsimError as error:
        return Ranking(words, plain(str(error)))
    result = made.result
    places = (1, -4, -3, -2, -1)
    quantities = tuple(
        RankedQuantity(row[0], item.common_mm, item.differing_mm, tuple(row[place] for place in places))
        for item, row in zip(result.sensitivities, quantity_rows(result), strict=True)
    )
    after = made.verdict.recalibrated
    return Ranking(
        words,
        "",
        quantities,
        made.headline,
        made.verdict.as_built,
        math.nan if after is None else after,
        result.required.depth_m,
        csv_bytes(made.table),
        whole,
    )


def arguments(state: State) -> dict[str, Any]:
    """What `rigsim.tolerance` is asked for.

    Raises:
        RigsimError: a word cannot be read.
    """
    shown = logic.assumed(state, "a tolerance study")
    asked, range_m = logic.required(state)
    return {
        "rig": shown.rig,
        "depth_error_mm": asked.error_m * 1e3,
        "at_m": asked.depth_m,
        "max_row_error_px": asked.row_px,
        "range_m": range_m,
        "tolerance_class": state["class"] or logic.CLASSES[0],
        "noise_px": shown.noise.std_px,
        "rigs": logic.RIGS,
        "points": logic.POINTS,
    }


def asked(state: State) -> dict[str, str]:
    """The words that a ranking depends on: with the same ones it is the same."""
    return {name: state[name] for name in _WORDS if state[name]}
