"""Which row is best, by what it was chosen, and how the error moves along an axis."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from rigsim.study.scene.columns import AXES, COLUMNS
from rigsim.study.sweep.comparison import Comparison, compare, reservations
from rigsim.study.sweep.phrases import describe, mm, say

_TIE_SIGMAS = 2.0  # standard errors of the difference under which two rows are as good


def rank(rows: pd.DataFrame, by_depth: pd.DataFrame) -> tuple[int, ...]:
    """Places of the rows, best first: smallest depth error at the distances that all answer.

    What is flagged, and what covers too little, comes later; of rows that cannot be compared, the one that
    answers more comes first. Noise is a circumstance, not a choice: only rows of the middle noise level
    compete.
    """
    noises = sorted(rows["noise_px"].unique())
    middle = rows["noise_px"] == noises[(len(noises) - 1) // 2]
    comparison = compare(rows, by_depth)
    order = (
        rows.assign(
            reservations=reservations(rows),
            missing=~comparison.compared,
            error=np.where(comparison.compared, comparison.simulated_mm, -comparison.answered),
        )[middle & rows["depth_rmse_mm"].notna()]
        .sort_values(["reservations", "missing", "error"], kind="stable")
        .index
    )
    return tuple(int(i) for i in order)


def choice(
    rows: pd.DataFrame, comparison: Comparison, swept: tuple[str, ...], order: tuple[int, ...]
) -> list[str]:
    """By what the best row was chosen, and which row is as good as far as the sample can tell."""
    best, others = order[0], [place for place in order[1:] if comparison.compared[place]]
    if not others or not comparison.compared[best]:
        return []
    error, spread = comparison.simulated_mm, comparison.spread_mm
    n = 1 + len(others)
    sentence = (
        f"Best of {n} compared at the same distances, {comparison.words}: "
        f"{describe(rows.loc[best], swept)}, {mm(error[best])} RMS per pixel of the image"
    )
    level = reservations(rows)
    second = next(
        (place for place in others if level[place] == level[best] and _differ(rows, best, place)), None
    )
    if second is None:
        return [sentence + "."]
    room = _TIE_SIGMAS * math.hypot(spread[best], spread[second])
    word = "as good within what the points can tell" if error[second] - error[best] <= room else "next"
    return [f"{sentence}; {word}: {describe(rows.loc[second], swept)}, {mm(error[second])}."]


def _differ(rows: pd.DataFrame, one: int, other: int) -> bool:
    """Whether two rows differ in what the simulation knows: it sees no picture."""
    axes = [axis for axis in AXES if axis != "sensor"]
    return bool((rows.loc[one, axes] != rows.loc[other, axes]).any())


def trend(rows: pd.DataFrame, by_depth: pd.DataFrame, swept: tuple[str, ...], best: int) -> list[str]:
    """How the error at the same distances moves along the first numeric axis, the others held."""
    numeric = [axis for axis in swept if COLUMNS[axis].numeric]
    if not numeric:
        return []
    axis = numeric[0]
    others = [other for other in swept if other != axis]
    among = (rows[others] == rows.loc[best, others]).all(axis=1).to_numpy()
    comparison = compare(rows, by_depth, among)
    line = rows[among & comparison.compared].sort_values(axis, kind="stable")
    if len(line) < 2:
        return []
    ends = line.index[0], line.index[-1]
    first_mm, last_mm = (comparison.simulated_mm[place] for place in ends)
    verb = "falls" if last_mm < first_mm else "rises"
    held = f" (at {describe(rows.loc[best], tuple(others))})" if others else ""
    return [
        f"From {line[axis].iloc[0]:.4g} to {say(axis, line[axis].iloc[-1])}{held}, the depth error at "
        f"{comparison.words} {verb} from {mm(first_mm)} to {mm(last_mm)} RMS per pixel of the image."
    ]
