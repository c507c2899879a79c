"""The rows that a diagnosis is held against, and how much of their error a supposed answer explains."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rigsim.rig.arrays import Array, Mask
from rigsim.study.verify.checks import exact_tolerance_m
from rigsim.study.verify.diagnosis.reenact import Given, given, reenacts, solve_linear
from rigsim.study.verify.result import CaseResult
from rigsim.theory.uncertainty import pixel_gain

_SLACK = 30.0
"""A supposed answer breaks a row when it is off by so many tolerances: triangulators round differently."""
_NOTHING = 0.25
"""What a NaN weighs beside a wrong point: many mistakes lead to it."""
_FAR_M = 1e8
"""A point beyond has no parallax worth a name."""


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """Some rows of every exact case of one triangulator, failing or not."""

    results: tuple[CaseResult, ...]
    """The cases."""
    failing: Mask
    """Which of the cases fail, (C,)."""
    case: npt.NDArray[np.intp]
    """Which case a row belongs to, (N,)."""
    given: Given
    """What the rows were made of."""
    left_xy: Array
    """Ideal normalised coordinates in the left camera, (N, 2)."""
    right_xy: Array
    """The same in the right camera, (N, 2)."""
    right: Array
    """What should have come back, wherever the lines of sight meet, (N, 3), m."""
    asked: Mask
    """Whether there is a point to be found, (N,)."""
    found: Array
    """What came back, (N, 3), m."""
    allowed: Array
    """Largest error that passes, (N,), m."""

    @property
    def weights(self) -> Array:
        """What the cases weigh, (C,): less where little but NaN came back."""
        answered = np.isfinite(self.found).all(axis=1).astype(np.float64)
        share = np.bincount(self.case, answered, len(self.results)) / np.bincount(self.case)
        return np.asarray(_NOTHING + (1 - _NOTHING) * share)

    def normalized(self, g: Given) -> tuple[Array, Array]:
        """Ideal normalised coordinates (N, 2) of both pixels as `g` has them."""
        same_left = g.left is self.given.left and g.uv_left is self.given.uv_left
        same_right = g.right is self.given.right and g.uv_right is self.given.uv_right
        return (
            self.left_xy if same_left else g.left.normalize(g.uv_left),
            self.right_xy if same_right else g.right.normalize(g.uv_right),
        )

    def explained(self, supposed: Array, nothing: Mask) -> tuple[Array, Array]:
        """Share of the rows' errors that `supposed` answers (N, 3) explain, by case.

        Args:
            supposed: answers that the mistake would give.
            nothing: rows for which a triangulator may well answer nothing, (N,).

        Returns:
            (C,) shares, of the rows that are wrong or should be by supposition, 0 to 1; and (C,) what
            those weigh.
        """
        found_none = ~np.isfinite(self.found).all(axis=1)
        nothing = nothing | ~np.isfinite(supposed).all(axis=1)
        apart = np.linalg.norm(self.found - supposed, axis=1)
        error = np.linalg.norm(self.found - self.right, axis=1)
        off = np.linalg.norm(supposed - self.right, axis=1)
        wrong = found_none | ~(error <= self.allowed)
        breaks = nothing | ~(off <= _SLACK * self.allowed)
        nowhere = ~self.asked
        wrong[nowhere] = self._in_front(self.found)[nowhere]
        breaks[nowhere] = ((~nothing | wrong) & self._in_front(supposed))[nowhere]
        size = np.where(nowhere, np.linalg.norm(self.found, axis=1), error)
        share = np.clip(1 - apart / np.maximum(size, 1e-300), 0.0, 1.0)
        share = np.where(found_none, nothing, np.nan_to_num(share)) * wrong * (breaks | ~nowhere)
        counted = wrong | breaks
        cases = len(self.results)
        weights = np.where(found_none, _NOTHING, 1.0) * counted
        count = np.bincount(self.case, weights=weights, minlength=cases)
        total = np.bincount(self.case, weights=share * weights, minlength=cases)
        return np.asarray(total / np.where(count > 0, count, 1.0)), np.asarray(count, dtype=np.float64)

    def _in_front(self, points: Array) -> Mask:
        """Whether points are answers at all."""
        far = np.linalg.norm(points, axis=1) >= _FAR_M
        right = np.einsum("nij,nj->ni", self.given.R, points) + self.given.t
        return np.asarray(np.isfinite(points).all(axis=1) & (points[:, 2] > 0) & (right[:, 2] > 0) & ~far)


def gather(results: Sequence[CaseResult], rows: int) -> Evidence:
    """At most `rows` of each case without noise, half of them wrong ones if there are as many."""
    kept = tuple(
        result
        for result in results
        if result.case.covariance_px2 is None and result.found_left is not None and len(result.case)
        if reenacts(result.case.rig)
    )
    everything = [_columns(result) for result in kept]
    chosen = [_choose(*columns[2:], rows) for columns in everything]
    counts = [len(indices) for indices in chosen]
    uv_left, uv_right, truth, found, tolerances = (
        np.concatenate([columns[i][indices] for columns, indices in zip(everything, chosen, strict=True)])
        for i in range(5)
    )
    table = given([result.case.rig for result in kept], counts, uv_left, uv_right)
    asked = np.isfinite(truth).all(axis=1)
    with np.errstate(all="ignore"):
        left_xy, right_xy = table.left.normalize(uv_left), table.right.normalize(uv_right)
        met = solve_linear(table, left_xy, right_xy)
    return Evidence(
        kept,
        np.array([result.status() == "failed" for result in kept], dtype=bool),
        np.repeat(np.arange(len(kept)), counts),
        table,
        left_xy,
        right_xy,
        np.where(asked[:, None], truth, met),
        np.asarray(asked),
        found,
        tolerances,
    )


def _columns(result: CaseResult) -> tuple[Array, Array, Array, Array, Array]:
    """Pixels of both images, true and found points, and the error that is allowed."""
    case, found = result.case, result.found_left
    if found is None:
        found = np.full((len(case), 3), np.nan)
    with np.errstate(all="ignore"):
        gain = pixel_gain(case.rig, case.points_left)
        allowed = exact_tolerance_m(case.rig, case.points_left, gain)
    return case.uv_left, case.uv_right, case.points_left, found, allowed


def _choose(truth: Array, found: Array, allowed: Array, rows: int) -> npt.NDArray[np.intp]:
    """Indices, in order."""
    asked = np.isfinite(truth).all(axis=1)
    answered = np.isfinite(found).all(axis=1)
    with np.errstate(all="ignore"):
        right = np.linalg.norm(found - truth, axis=1) <= allowed
    wrong = np.flatnonzero(np.where(asked, ~right, answered))
    others = np.flatnonzero(np.where(asked, right, ~answered))
    many = max(rows // 2, rows - len(others))
    few = max(rows // 2, rows - len(wrong))
    return np.sort(np.concatenate([_spread(wrong, many), _spread(others, few)]))


def _spread(indices: npt.NDArray[np.intp], most: int) -> npt.NDArray[np.intp]:
    """At most so many, evenly."""
    return indices[:: max(1, -(-len(indices) // most))]
