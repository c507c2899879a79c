"""Which axes a sweep varies, and what limits each of its rows."""

from __future__ import annotations

from typing import Literal, TypeAlias

import pandas as pd

from rigsim.study.scene import columns as col
from rigsim.study.scene.columns import AXES
from rigsim.study.sweep.comparison import WELL_COVERED

Limit: TypeAlias = Literal["no result", "failed points", "overlap", "low disparity", "bias", "pixel noise"]

_LOW_DISPARITY = 0.05
_FAILED = 0.01
_BIASED = 0.3


def swept_axes(rows: pd.DataFrame, order: tuple[str, ...]) -> tuple[str, ...]:
    """Axes that take more than one value, without those that merely follow another.

    Args:
        rows: sweep table.
        order: the axes that were asked for, which are preferred to those that follow them.
    """
    varied = [axis for axis in (*order, *(a for a in AXES if a not in order)) if rows[axis].nunique() > 1]
    swept: list[str] = []
    for axis in varied:
        followers = rows.groupby(swept, sort=False)[axis].nunique().max() if swept else 2
        if followers > 1:
            swept.append(axis)
    return tuple(sorted(swept, key=AXES.index))


def limits(rows: pd.DataFrame) -> tuple[Limit, ...]:
    """What limits each row."""
    coverage = rows[col.VISIBLE_FRACTION].max()
    found: list[Limit] = []
    for row in rows.to_dict("records"):
        if not row[col.DEPTH_RMSE] >= 0:
            found.append("no result")
        elif row[col.FAILED_FRACTION] > _FAILED:
            found.append("failed points")
        elif row[col.VISIBLE_FRACTION] < WELL_COVERED * coverage:
            found.append("overlap")
        elif row[col.LOW_DISPARITY_FRACTION] > _LOW_DISPARITY:
            found.append("low disparity")
        elif abs(row[col.DEPTH_BIAS]) > _BIASED * row[col.DEPTH_RMSE]:
            found.append("bias")
        else:
            found.append("pixel noise")
    return tuple(found)
