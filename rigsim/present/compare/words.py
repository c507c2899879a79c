"""What a comparison says, in sentences made from its numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from rigsim.digits import short
from rigsim.present.kit.format import with_error
from rigsim.study.compare import columns as col
from rigsim.study.compare.judge import off_bound, quantile
from rigsim.study.compare.run import ComparisonResult

_LOST = 1e-3
_WORTH_SAYING = 0.002
_WHOLE = 1e6  # points a second


def headline(result: ComparisonResult) -> str:
    """The comparison in one sentence."""
    rows, off = result.rows, off_bound(result)
    count = rows[col.TRIANGULATOR].value_counts()
    labels = [label for label in result.triangulators if label in count.index]
    good = [label for label in labels if not off[rows[col.TRIANGULATOR] == label].any()]
    everywhere = [label for label in good if count[label] == count.max()]
    partly = [label for label in good if label not in everywhere]
    where = "everywhere" if rows[col.GEOMETRY].nunique() > 1 else f"in {rows[col.GEOMETRY].iloc[0]}"
    said = []
    if everywhere:
        said.append(f"{listed(everywhere)} {_verb(everywhere, 'stay')} within noise of the bound {where}")
    if partly:
        said.append(
            f"{listed(partly)} wherever {'it' if len(partly) == 1 else 'they'} ran"
            if everywhere
            else f"{listed(partly)} {_verb(partly, 'stay')} within noise of the bound, not run everywhere"
        )
    lead = ", ".join(said) or f"No triangulator stays within noise of the bound {where}"
    bad = [label for label in labels if label not in good]
    worst = _worst(rows[off & rows[col.PIXEL_ERROR_OVER_BOUND].notna()])
    if not bad:
        return f"{lead}."
    if worst is None:
        return f"{lead}; {listed(bad)} {_verb(bad, 'return')} no point somewhere."
    return f"{lead}; {worst[col.TRIANGULATOR]} is farthest off, {_times(worst)} the bound in {_place(worst)}."


def sentences(result: ComparisonResult) -> tuple[str, ...]:
    """What else there is to say: who is off and where, biases, failures, speed."""
    return (
        *_accuracy(result),
        *_against_first(result),
        *_biases(result),
        *_failures(result),
        *_speeds(result),
    )


def listed(names: Sequence[str]) -> str:
    """Names in a sentence: ``a, b and c``."""
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _verb(names: Sequence[str], verb: str) -> str:
    return f"{verb}s" if len(names) == 1 else verb


def _accuracy(result: ComparisonResult) -> list[str]:
    rows, off = result.rows, off_bound(result)
    said = []
    for label in result.triangulators:
        mine = rows[col.TRIANGULATOR] == label
        worst = _worst(rows[mine & off & rows[col.PIXEL_ERROR_OVER_BOUND].notna()])
        if worst is not None:
            where = listed(list(dict.fromkeys(rows[mine & off][col.GEOMETRY])))
            said.append(f"{label} is off the bound in {where}, at most {_times(worst)} in {_place(worst)}.")
    return said


def _against_first(result: ComparisonResult) -> list[str]:
    """Triangulators within noise of the bound that are surely worse than the first for the same noise."""
    rows, off, first = result.rows, off_bound(result), result.triangulators[0]
    more = rows[col.PIXEL_ERROR_OVER_FIRST] - 1
    sure = (more > quantile(result) * rows[col.PIXEL_ERROR_OVER_FIRST_SE]) & (more >= _WORTH_SAYING)
    said = []
    for label in result.triangulators[1:]:
        mine = more[sure & ~off & (rows[col.TRIANGULATOR] == label)]
        if len(mine):
            row = rows.loc[mine.idxmax()]
            pair = with_error(row[col.PIXEL_ERROR_OVER_FIRST], row[col.PIXEL_ERROR_OVER_FIRST_SE])
            said.append(f"{label} {pair} times in {_place(row)}")
    if not said:
        return []
    return [
        f"Within noise of the bound, but significantly above {first}'s error for the same noise: "
        f"{listed(said)}."
    ]


def _biases(result: ComparisonResult) -> list[str]:
    """The largest bias of each triangulator that is surely one, beyond the bias that lost points cause."""
    rows = result.rows
    beyond = rows[col.DEPTH_BIAS] - rows[col.EXPECTED_DEPTH_BIAS]
    sure = beyond.abs() > quantile(result) * rows[col.DEPTH_BIAS_SE]
    said, unbiased = [], []
    for label in result.triangulators:
        mine = beyond[sure & (rows[col.TRIANGULATOR] == label)]
        if len(mine):
            row = rows.loc[mine.abs().idxmax()]
            value, se = float(mine[row.name]), row[col.DEPTH_BIAS_SE]
            lost = row[col.EXPECTED_FAILED_SHARE] > _LOST
            beside = ", beyond the bias that lost points cause" if lost else ""
            side = "far" if value > 0 else "near"
            said.append(
                f"{label}'s points are too {side} by up to {with_error(abs(value), se)} σ of depth,"
                f" in {_place(row)}{beside}."
            )
        elif beyond[rows[col.TRIANGULATOR] == label].notna().any():
            unbiased.append(label)
    if unbiased:
        said.append(f"{listed(unbiased)} {_verb(unbiased, 'show')} no bias beyond noise.")
    return said


def _failures(result: ComparisonResult) -> list[str]:
    """Triangulators that lose more or fewer points than the noise makes impossible."""
    rows = result.rows
    more = rows[col.FAILED_SHARE] - rows[col.EXPECTED_FAILED_SHARE]
    # one point is nothing to speak of
    sure = more.abs() > quantile(result) * rows[col.EXPECTED_FAILED_SHARE_SE] + 1 / rows[col.N]
    said = []
    for label in result.triangulators:
        mine = more[sure & (rows[col.TRIANGULATOR] == label)]
        if len(mine):
            row = rows.loc[mine.abs().idxmax()]
            said.append(
                f"{label} loses {short(100 * row[col.FAILED_SHARE])} % of the points in {_place(row)}, where"
                f" noise alone loses {short(100 * row[col.EXPECTED_FAILED_SHARE])} %."
            )
    return said or ["Every triangulator loses as many points as noise alone would."]


def _speeds(result: ComparisonResult) -> list[str]:
    """The median speed over geometries, fastest first."""
    known = result.rows[result.rows[col.POINTS_PER_SECOND].notna()]
    if not len(known):
        return []
    median = known.groupby(col.TRIANGULATOR, sort=False)[col.POINTS_PER_SECOND].median()
    fastest = median.sort_values(ascending=False)
    said = ", ".join(f"{label} {_two(rate / _WHOLE)}" for label, rate in fastest.items())
    return [f"Speed, million points/s, median over geometries: {said}."]


def _worst(rows: pd.DataFrame) -> pd.Series[Any] | None:
    """The row that is farthest from the bound, up or down; None without rows."""
    if not len(rows):
        return None
    return rows.loc[np.log(rows[col.PIXEL_ERROR_OVER_BOUND].clip(lower=1e-12)).abs().idxmax()]


def _place(row: pd.Series[Any]) -> str:
    return f"{row[col.GEOMETRY]} at {row[col.NOISE]:g} px"


def _times(row: pd.Series[Any]) -> str:
    return f"{with_error(row[col.PIXEL_ERROR_OVER_BOUND], row[col.PIXEL_ERROR_OVER_BOUND_SE])} times"


def _two(value: float) -> str:
    """Two significant digits, without powers of ten."""
    return f"{value:.0f}" if value >= 10 else np.format_float_positional(value, 2, fractional=False, trim="-")
