"""Values as the sentences of a sweep say them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pandas as pd

from rigsim.digits import length, short
from rigsim.study.scene.axes import registry

AXIS_WORDS = {
    column.name: (
        axis.word if place == 0 else column.heading,
        column.shown_unit if column.numeric else None,
    )
    for axis in registry.ALL
    for place, column in enumerate(axis.columns)
}
"""What an axis is called, and its unit; None where its values are names."""


def describe(row: pd.Series, axes: tuple[str, ...]) -> str:
    """The row's values on some axes, as a person would say them."""
    return ", ".join(say(axis, row[axis]) for axis in axes)


def say(axis: str, value: Any) -> str:
    """A value of an axis with its name: ``120 mm of baseline``."""
    words, unit = AXIS_WORDS[axis]
    if unit is None:
        return f"`{value}`"
    space = "" if unit in ("", "°") else " "
    return f"{short(value, 4)}{space}{unit} of {words}"


def distances(spans_mm: Sequence[tuple[float, float]]) -> str:
    """Stretches of depth: ``0.8 to 4 m``."""
    return " and ".join(f"{near / 1e3:.3g} to {far / 1e3:.3g} m" for near, far in spans_mm)


def mm(value: float) -> str:
    """Millimetres with three digits; metres from 1 m on."""
    return length(value)


def percent(fraction: float) -> str:
    """Whole percent; one digit more where that would hide something."""
    percent = fraction * 100
    return f"{percent:.0f} %" if percent >= 1 or percent == 0 else f"{percent:.1g} %"
