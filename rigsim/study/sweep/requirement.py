"""The rows of a sweep held to a depth error asked for at a distance.

The simulated error of the bin of depth that holds the distance, brought to it by the square of the depth, is
held to the limit by its 95 % interval: `met` when all of it is within, `not_met` when all of it is beyond,
`not_shown` when the limit lies in it, or when the scene has no points within 1.25 of the distance that both
cameras see. A rig whose true error is the limit is called met, or not met, about once in 40 each; with 3000
errors in the bin (30 points, 100 trials) one that keeps a tenth in hand is called met nearly always.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np
import pandas as pd

from rigsim.rig.arrays import Array, Ids
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.agreement.agreement import flagged
from rigsim.study.scene import columns as col
from rigsim.study.sweep.comparison import FEWEST_POINTS, reservations, row_of_bins
from rigsim.theory.inverse_error import P95_OVER_STD
from rigsim.theory.limits import overlap_at_depth
from rigsim.theory.uncertainty import predict_depth_std

RowVerdict: TypeAlias = Literal["met", "not_met", "not_shown"]
VERDICTS: tuple[RowVerdict, ...] = get_args(RowVerdict)
"""Whether a row keeps what was asked, the best first."""

REACH = 1.25
"""Farthest points, as a factor of the distance, that say something about it."""

_P95_SPREAD = 1.35
"""Relative standard error of a 95th percentile over that of the RMS of the same Gaussian errors."""


@dataclass(frozen=True, slots=True)
class DepthRequirement:
    """A depth error that is asked for at a distance."""

    at_mm: float
    """The distance, mm."""
    error_mm: float
    """Largest error there, mm."""
    p95: bool = False
    """Whether 95 of 100 errors stay under it, instead of their root mean square."""
    pct: float | None = None
    """The same in percent of the distance, where it was said so."""


@dataclass(frozen=True, slots=True)
class RowHeld:
    """One row held to one requirement."""

    verdict: RowVerdict
    """Whether it keeps it."""
    error_mm: float
    """Simulated error at the distance, mm; NaN where the scene has no points there."""
    low_mm: float
    """Lower end of its 95 % interval."""
    high_mm: float
    """Upper end."""
    near_mm: float
    """Near edge of the bin that shows it; NaN for none."""
    far_mm: float
    """Far edge."""


@dataclass(frozen=True, slots=True)
class RowsHeld:
    """All rows of a sweep held to one requirement."""

    asked: DepthRequirement
    """What was asked for."""
    rows: tuple[RowHeld, ...]
    """One for each row."""


def hold_rows(
    rows: pd.DataFrame, by_depth: pd.DataFrame, asked: Sequence[DepthRequirement]
) -> tuple[RowsHeld, ...]:
    """Hold every row to every requirement."""
    places = row_of_bins(rows, by_depth) if len(by_depth) else np.zeros(0, dtype=np.int32)
    return tuple(
        RowsHeld(
            one,
            tuple(
                _held(one, by_depth, np.flatnonzero(places == i).astype(np.int32)) for i in range(len(rows))
            ),
        )
        for one in asked
    )


def verdicts(held: Sequence[RowsHeld]) -> tuple[RowVerdict, ...]:
    """What each row makes of all requirements: the worst, `not_met` before `not_shown`; none without any."""
    order: tuple[RowVerdict, ...] = ("not_met", "not_shown", "met")
    return tuple(
        min((one.verdict for one in row), key=order.index)
        for row in zip(*(one.rows for one in held), strict=True)
    )


def take(rows: pd.DataFrame, best: Sequence[int], held: Sequence[RowsHeld]) -> int | None:
    """Place of the row to take: of those that meet everything and are not flagged one that covers enough, of
    these the shortest baseline, of these the best; None for none."""
    is_flagged = flagged(rows)
    return next((i for i in met_first(rows, best, held) if not is_flagged[i]), None)


def met_first(rows: pd.DataFrame, best: Sequence[int], held: Sequence[RowsHeld]) -> tuple[int, ...]:
    """The places of the rows that meet everything, in the order in which to take them: what nothing speaks
    against first (`reservations`), then by baseline, then as they are ranked."""
    found, against = verdicts(held), reservations(rows)
    return tuple(
        sorted(
            (i for i in best if found[i] == "met"),
            key=lambda i: (float(against[i]), float(rows.loc[i, col.BASELINE])),
        )
    )


def nearest_first(best: Sequence[int], held: Sequence[RowsHeld]) -> tuple[int, ...]:
    """The places of the rows by their worst error over its limit, the least first; those that show nothing at
    a distance asked for come last, as they are ranked."""
    over = {i: max(one.rows[i].error_mm / one.asked.error_mm for one in held) for i in best}
    shows = {i: all(math.isfinite(one.rows[i].error_mm) for one in held) for i in best}
    return tuple(sorted(best, key=lambda i: over[i] if shows[i] else math.inf))


def nearest_miss(best: Sequence[int], held: Sequence[RowsHeld]) -> int | None:
    """Place of the row whose worst error over its limit is least, of those that show something."""
    first = next(iter(nearest_first(best, held)), None)
    if first is None or not all(math.isfinite(one.rows[first].error_mm) for one in held):
        return None
    return first


def answer_first(rows: pd.DataFrame, best: Sequence[int], held: Sequence[RowsHeld]) -> tuple[int, ...]:
    """The places of the rows, best first; where something is asked the row to take or, where none is, the
    one nearest to it, then the others that meet it, then the rest, the nearest to it first."""
    if not held:
        return tuple(best)
    taken = take(rows, best, held)
    first = nearest_miss(best, held) if taken is None else taken
    order = [*([] if first is None else [first]), *met_first(rows, best, held), *nearest_first(best, held)]
    return tuple(dict.fromkeys(order))


@dataclass(frozen=True, slots=True)
class WouldMeet:
    """What would meet what was asked, by the closed form of a rectified rig's depth error."""

    baseline_m: float | None
    """A baseline, m, with the noise as it is; None where its cameras would share no view at a distance asked
    for."""
    noise_px: float
    """Or a noise, px, with the baseline as it is."""


def would_meet(rig: StereoRig, noise: PixelNoise, held: Sequence[RowsHeld]) -> WouldMeet | None:
    """What would meet all that was asked: the error goes with ``sigma / B``; None where it does not."""
    if not rig.is_rectified or not held:
        return None
    over = max(
        float(predict_depth_std(rig, np.array([[0.0, 0.0, one.asked.at_mm / 1e3]]), noise)[0])
        * (P95_OVER_STD if one.asked.p95 else 1.0)
        / (one.asked.error_mm / 1e3)
        for one in held
    )
    if not 0 < over < math.inf:
        return None
    baseline_m = rig.baseline_m * over
    longer = StereoRig.rectified(rig.left, baseline_m, right=rig.right)
    shared = all(overlap_at_depth(longer, one.asked.at_mm / 1e3).fraction > 0 for one in held)
    return WouldMeet(baseline_m if shared else None, noise.std_px / over)


def _held(asked: DepthRequirement, by_depth: pd.DataFrame, lines: Ids) -> RowHeld:
    nothing = RowHeld("not_shown", *(math.nan,) * 5)
    bins = by_depth.iloc[lines]
    names = (col.DEPTH_RMSE, col.DEPTH_OF_RMSE, col.DEPTH_NEAR, col.DEPTH_FAR)
    rmse, where, near, far = (bins[name].to_numpy(dtype=np.float64) for name in names)
    away = np.abs(np.log(where / asked.at_mm)) if len(bins) else np.zeros(0)
    known = np.isfinite(rmse) & (bins[col.N_VISIBLE].to_numpy() >= FEWEST_POINTS)
    usable = known & (away <= math.log(REACH))
    if not usable.any():
        return nothing
    holds = usable & (near <= asked.at_mm) & (asked.at_mm <= far)
    chosen = int(np.flatnonzero(holds if holds.any() else usable)[_least(away, holds, usable)])
    scale = (asked.at_mm / where[chosen]) ** 2
    line = bins.iloc[chosen]
    low, high = float(line[col.DEPTH_RMSE_CI_LOW]), float(line[col.DEPTH_RMSE_CI_HIGH])
    error = float(rmse[chosen])
    if asked.p95:
        p95 = float(line[col.DEPTH_ABS_P95])
        spread = _P95_SPREAD * p95 / error if error > 0 else 0.0
        low, high, error = p95 - spread * (error - low), p95 + spread * (high - error), p95
    low, error, high = (scale * one for one in (low, error, high))
    verdict: RowVerdict = "not_shown"
    if high <= asked.error_mm:
        verdict = "met"
    elif low > asked.error_mm:
        verdict = "not_met"
    return RowHeld(verdict, error, low, high, float(near[chosen]), float(far[chosen]))


def _least(away: Array, holds: Array, usable: Array) -> int:
    """Which of the bins that count lies nearest."""
    return int(np.argmin(away[holds if holds.any() else usable]))
