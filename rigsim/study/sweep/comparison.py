"""Rows beside each other: their depth error at the same distances, and nowhere else.

Rows see different points, and a row whose disparities drown in their noise sees fewer. An average over what
each can answer favours the row that answers least. Here only the bins of depth count that all the rows
being compared answer, with the same weight for each bin; and within a bin, whose far edge has 1.6 times the
error of its near one, each row's error is brought to the same distance.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from rigsim.rig.arrays import Array, Ids, Mask
from rigsim.study.agreement.agreement import flagged
from rigsim.study.scene import columns as col
from rigsim.study.scene.columns import AXES
from rigsim.study.scene.statistics import CI_SIGMAS

WELL_COVERED = 0.8
"""A configuration must keep this share of the best coverage, in pixels, to be called best."""

FEWEST_POINTS = 5
"""A row answers a bin of depth with no fewer points than this."""

_SHARED = 0.5
# A quarter of depth is between the edges of a bin; the fourth power of depth scatters by a quarter in it
_SPREAD = 0.25
_KEY = (col.SCENE, *AXES)


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """The depth error of rows at the same distances, per pixel of the left image."""

    spans_mm: tuple[tuple[float, float], ...]
    """The distances, nearest and farthest, near to far; none when the rows have none in common."""
    compared: Mask
    """Whether the row answers all these distances, (rows,)."""
    answered: Array
    """How much of the image the row answers, with what bins hold on the average of the rows, (rows,)."""
    simulated_mm: Array
    """Simulated RMS depth error there, (rows,); NaN where the row does not answer."""
    predicted_mm: Array
    """The closed forms' answer for the same, (rows,)."""
    ci_low_mm: Array
    """Lower end of the 95 % confidence interval of the simulated RMS, for these points, (rows,)."""
    ci_high_mm: Array
    """Upper end, (rows,)."""
    spread_mm: Array
    """Standard error of the simulated RMS for other points and other noise, (rows,)."""


def reservations(rows: pd.DataFrame) -> Array:
    """What speaks against each row: 0 nothing, 1 too little coverage, 2 a flag, 3 both."""
    known = rows[col.DEPTH_RMSE].notna()
    poor = rows[col.VISIBLE_FRACTION] < WELL_COVERED * rows[col.VISIBLE_FRACTION][known].max()
    return np.asarray(2.0 * flagged(rows) + 1.0 * poor)


def compare(rows: pd.DataFrame, by_depth: pd.DataFrame, among: Mask | None = None) -> Comparison:
    """The error of each row over the distances that all rows `among` answer.

    A row answers a bin of depth when it has points there and no pixel under ``Z / sigma_Z`` of 4. Each bin's
    mean square error, brought to the same distance by ``Z^4``, counts with the bin's share of the image,
    averaged over the rows. Where the distances that are shared hold less than half of what the row that
    answers most does, the row that answers least is left out, and so on: first of those that something
    speaks against.

    Args:
        rows: `SweepResult.rows`.
        by_depth: `SweepResult.by_depth`.
        among: rows (N,) that decide on the distances; all when None.
    """
    known = rows[col.DEPTH_RMSE].notna().to_numpy()
    among = known if among is None else among & known
    against = reservations(rows)
    bins = _Bins.of(rows, by_depth)
    weight = np.nanmean(bins.share[among], axis=0) if among.any() else np.zeros(len(bins.edges_mm))
    chosen = np.flatnonzero(among)
    shared = np.asarray(bins.answered[chosen].all(axis=0))
    while len(chosen) > 1:
        held = bins.answered[chosen] @ weight
        if weight[shared].sum() >= _SHARED * held.max() and shared.any():
            break
        chosen = np.delete(chosen, np.lexsort((held, -against[chosen]))[0])
        shared = np.asarray(bins.answered[chosen].all(axis=0))
    return _pooled(bins, known, shared, weight[shared], bins.answered @ weight)


def row_of_bins(rows: pd.DataFrame, by_depth: pd.DataFrame) -> Ids:
    """Place in `rows` of each line of `by_depth`: both stand in the order of the sweep.

    Rigs may differ in what no column tells, so that their columns alone do not tell them apart.
    """
    head, near = by_depth[list(_KEY)], by_depth[col.DEPTH_NEAR]
    starts = (head != head.shift()).any(axis=1) | (near <= near.shift())
    places = np.flatnonzero(rows[col.N_POINTS] > 0)
    return np.asarray(places[starts.cumsum().to_numpy(dtype=np.int64) - 1], dtype=np.int32)


@dataclass(frozen=True, slots=True, eq=False)
class _Bins:
    """`by_depth` as arrays, a row a configuration and a column a bin; NaN where it holds nothing."""

    edges_mm: list[tuple[float, float]]
    answered: Mask
    share: Array
    n: Array
    where_mm: Array
    """The distance that the mean square error belongs to, (rows, bins)."""
    simulated_mm: Array
    predicted_mm: Array
    ci_high_mm: Array

    @classmethod
    def of(cls, rows: pd.DataFrame, by_depth: pd.DataFrame) -> _Bins:
        each = list(zip(by_depth[col.DEPTH_NEAR], by_depth[col.DEPTH_FAR], strict=True))
        edges = sorted(set(each))
        columns = {edge: i for i, edge in enumerate(edges)}
        i, j = row_of_bins(rows, by_depth), [columns[edge] for edge in each]

        def spread(name: str, nothing: float = math.nan) -> Array:
            values = np.full((len(rows), len(edges)), nothing)
            values[i, j] = by_depth[name].to_numpy(dtype=np.float64)
            return values

        simulated = spread(col.DEPTH_RMSE)
        n = spread(col.N_VISIBLE, 0.0)
        answered = np.isfinite(simulated) & (n >= FEWEST_POINTS) & (spread(col.LOW_DISPARITY_FRACTION) == 0)
        return cls(
            edges,
            answered,
            spread(col.SCENE_FRACTION, 0.0),
            n,
            spread(col.DEPTH_OF_RMSE),
            simulated,
            spread(col.PREDICTED_DEPTH_RMSE),
            spread(col.DEPTH_RMSE_CI_HIGH),
        )


def _pooled(bins: _Bins, known: Mask, shared: Mask, weight: Array, answered: Array) -> Comparison:
    answers = known & bins.answered[:, shared].all(axis=1) & shared.any()
    # bins that no ray met weigh nothing beside others, and the same where there are no others
    weight = weight / weight.sum() if weight.sum() > 0 else np.full(len(weight), 1 / max(len(weight), 1))

    def over(values: Array) -> Array:
        return np.where(answers, np.where(np.isfinite(values), values, 0.0) @ weight, math.nan)

    where = bins.where_mm[:, shared]
    middle = np.median(where[answers], axis=0) if answers.any() else np.ones(len(weight))
    with np.errstate(invalid="ignore"):
        scale = (middle / where) ** 4
        simulated, predicted, high = (
            scale * each[:, shared] ** 2 for each in (bins.simulated_mm, bins.predicted_mm, bins.ci_high_mm)
        )
        noise_se = (high - simulated) / CI_SIGMAS
        points_se = _SPREAD * simulated / np.sqrt(np.maximum(bins.n[:, shared], 1.0))
        mean = over(simulated)

        def error(*parts: Array) -> Array:
            squares = np.where(np.isfinite(simulated), sum(part**2 for part in parts), 0.0)
            return np.sqrt(squares @ weight**2)

        own, every = error(noise_se), error(noise_se, points_se)
        return Comparison(
            spans_mm=_spans(
                [edge for edge, is_shared in zip(bins.edges_mm, shared, strict=True) if is_shared]
            ),
            compared=np.asarray(answers),
            answered=answered,
            simulated_mm=np.sqrt(mean),
            predicted_mm=np.sqrt(over(predicted)),
            ci_low_mm=np.sqrt(np.maximum(mean - CI_SIGMAS * own, 0.0)),
            ci_high_mm=np.sqrt(mean + CI_SIGMAS * own),
            spread_mm=np.where(mean > 0, every / (2 * np.sqrt(mean)), 0.0 * mean),
        )


def _spans(edges_mm: Sequence[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """Bins that touch, joined."""
    spans = list(edges_mm[:1])
    for (_, before), (near, far) in itertools.pairwise(edges_mm):
        if near == before:
            spans[-1] = (spans[-1][0], far)
        else:
            spans.append((near, far))
    return tuple(spans)
