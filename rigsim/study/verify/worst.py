"""The rows of a case that a triangulator got most wrong."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.study.verify.result import CaseResult

_WRONG_PX = 1e-6  # less is rounding


@dataclass(frozen=True, slots=True, eq=False)
class WorstRow:
    """One row: what was given, what was true, what came back."""

    row: int
    """Its place in the case."""
    uv_left: Array
    """Given pixel in the left image, (2,), px."""
    uv_right: Array
    """Given pixel in the right image, (2,), px."""
    expected_left: Array
    """True point, (3,), m; NaN where there is none."""
    found_left: Array
    """What came back, (3,), m; NaN for nothing."""

    @property
    def distance_m(self) -> float:
        """Distance from the true point, m; NaN when either is none."""
        return float(np.linalg.norm(self.found_left - self.expected_left))


def pixel_errors(result: CaseResult) -> Array:
    """(N,) px: how far the found points' projections lie from the true points'.

    Infinite where one has a point in front of both cameras and the other none, 0 where neither has.
    """
    case = result.case
    if result.found_left is None or len(case) == 0:
        return np.full(len(case), np.inf)
    with np.errstate(all="ignore"):
        found = np.hstack(case.rig.project(result.found_left))
        true = np.hstack(case.rig.project(case.points_left))
        error = np.linalg.norm(found - true, axis=1)
    has_found, has_true = np.isfinite(found).all(axis=1), np.isfinite(true).all(axis=1)
    return np.where(has_found & has_true, error, np.where(has_found == has_true, 0.0, np.inf))


def worst_rows(result: CaseResult, most: int = 5) -> tuple[WorstRow, ...]:
    """At most that many rows with an error, the worst first; none when nothing came back.

    Rows whose point is missing or made up are the worst, but leave up to half of the places to wrong ones.
    """
    if result.found_left is None:
        return ()
    case, error = result.case, pixel_errors(result)
    order = np.argsort(-error, kind="stable")
    n_none = int(np.isinf(error).sum())
    n_wrong = int((np.isfinite(error) & (error > _WRONG_PX)).sum())
    n_shown = min(n_none, most - min(n_wrong, most // 2))
    order = np.concatenate([order[:n_shown], order[n_none:]])[:most]
    return tuple(
        WorstRow(
            int(row), case.uv_left[row], case.uv_right[row], case.points_left[row], result.found_left[row]
        )
        for row in order
        if error[row] > 0
    )
