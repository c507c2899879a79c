"""Which row is best, by what it was chosen, and how the error moves along an axis."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from rigsim.study.scene import columns as col
from rigsim.study.scene.columns import AXES, COLUMNS
from rigsim.study.sweep.comparison import compare, reservations

_TIE_SIGMAS = 2.0  # standard errors of the difference under which two rows are as good


def rank(rows: pd.DataFrame, by_depth: pd.DataFrame) -> tuple[int, ...]:
    """Places of the rows, best first: smallest depth error at the distances that all answer.

    What is flagged, and what covers too little, comes later; of rows that cannot be compared, the one that
    answers more comes first. Noise is a circumstance, not a choice: only rows of the middle noise level
    compete.
    """
    noises = sorted(rows[col.NOISE].unique())
    middle = rows[col.NOISE] == noises[(len(noises) - 1) // 2]
    comparison = compare(rows, by_depth)
    order = (
        rows.assign(
            reservations=reservations(rows),
            missing=~comparison.compared,
            error=np.where(comparison.compared, comparison.simulated_mm, -comparison.answered),
        )[middle & rows[col.DEPTH_RMSE].notna()]
        .sort_values(["reservations", "missing", "error"], kind="stable")
        .index
    )
    return tuple(int(i) for i in order)


@dataclass(frozen=True, slots=True)
class Choice:
    """By what the best row was chosen."""

    n: int
    """Rows that were compared."""
    spans_mm: tuple[tuple[float, float], ...]
    """At which distances, near to far."""
    best: int
    """Place of the best row."""
    best_mm: float
    """Its depth error at these distances, RMS per pixel of the image."""
    second: int | None
    """Place of the next one that differs in what the simulation knows; None without."""
    second_mm: float
    """Its error; NaN without."""
    is_tie: bool
    """Whether the second is as good as far as the sample can tell."""


def choice(rows: pd.DataFrame, by_depth: pd.DataFrame, order: tuple[int, ...]) -> Choice | None:
    """By what the best row was chosen, and which row is as good; None where none was compared to it."""
    comparison = compare(rows, by_depth)
    best, others = order[0], [place for place in order[1:] if comparison.compared[place]]
    if not others or not comparison.compared[best]:
        return None
    error, spread = comparison.simulated_mm, comparison.spread_mm
    level = reservations(rows)
    second = next(
        (place for place in others if level[place] == level[best] and _differ(rows, best, place)), None
    )
    chosen = Choice(1 + len(others), comparison.spans_mm, best, float(error[best]), None, math.nan, False)
    if second is None:
        return chosen
    room = _TIE_SIGMAS * math.hypot(spread[best], spread[second])
    is_tie = bool(error[second] - error[best] <= room)
    return replace(chosen, second=second, second_mm=float(error[second]), is_tie=is_tie)


def _differ(rows: pd.DataFrame, one: int, other: int) -> bool:
    """Whether two rows differ in what the simulation knows: it sees no picture."""
    axes = [axis for axis in AXES if axis != col.SENSOR]
    return bool((rows.loc[one, axes] != rows.loc[other, axes]).any())


@dataclass(frozen=True, slots=True)
class Trend:
    """How the depth error moves along an axis."""

    axis: str
    """The axis."""
    first: float
    """Its least value."""
    last: float
    """Its greatest value."""
    held: tuple[str, ...]
    """The other axes, at the best row's values."""
    spans_mm: tuple[tuple[float, float], ...]
    """At which distances, near to far."""
    first_mm: float
    """Depth error at the least value, RMS per pixel of the image."""
    last_mm: float
    """That at the greatest."""


def trend(rows: pd.DataFrame, by_depth: pd.DataFrame, swept: tuple[str, ...], best: int) -> Trend | None:
    """How the error at the same distances moves along the first numeric axis, the others held."""
    numeric = [axis for axis in swept if COLUMNS[axis].numeric]
    if not numeric:
        return None
    axis = numeric[0]
    others = [other for other in swept if other != axis]
    among = (rows[others] == rows.loc[best, others]).all(axis=1).to_numpy()
    comparison = compare(rows, by_depth, among)
    line = rows[among & comparison.compared].sort_values(axis, kind="stable")
    if len(line) < 2:
        return None
    first, last = line.index[0], line.index[-1]
    return Trend(
        axis,
        float(line[axis].iloc[0]),
        float(line[axis].iloc[-1]),
        tuple(others),
        comparison.spans_mm,
        float(comparison.simulated_mm[first]),
        float(comparison.simulated_mm[last]),
    )
