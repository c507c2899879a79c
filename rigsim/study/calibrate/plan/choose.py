"""Which of many poses leave the least variance of the depths that count: one by one, then exchanged."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.board import Board
from rigsim.study.calibrate.plan.reach import ReachedPoses
from rigsim.study.calibrate.plan.terms import DepthTerms, Sums

Picks: TypeAlias = list[int]
"""Places among the poses that were reached."""
LEAST_SHARED = 3
"""Boards that both cameras see, in any set that is chosen."""
_ALIKE = 0.12
"""Two boards whose corners differ by less of their distance (rms) are the same to whom holds them."""
_PASSES = 3
_WORTH = 1e-3
"""Share of the loss that an exchange must save."""


def choose(terms: DepthTerms, reached: ReachedPoses, close: Mask, count: int) -> Picks:
    """`count` of the poses, best first: any number of the first ones is a good choice too. Poses that are
    `close` (n, n) to each other are not both taken.

    Picked one by one, each the best beside the ones before; then one is exchanged for a better one as long as
    there is any (Fedorov, "Theory of Optimal Experiments", 1972); then the one missed least goes to the end,
    again and again.
    """
    picks = extended(terms, reached, [], count, close)
    for _ in range(_PASSES):
        if not _exchanged(terms, reached, picks, close):
            break
    return ordered(terms, reached, picks)


def extended(
    terms: DepthTerms, reached: ReachedPoses, picks: Picks, count: int, close: Mask | None = None
) -> Picks:
    """`picks` and the best next ones, `count` in all; none that is `close` (n, n) to another if that is said,
    unless all are."""
    picks = list(picks)
    sums = terms.boards.chosen(picks).total()
    while len(picks) < count:
        allowed = np.ones(len(reached), dtype=bool)
        if close is not None:
            allowed &= ~close[picks].any(axis=0)
        if reached.both[picks].sum() < LEAST_SHARED:
            allowed &= reached.both
        if not allowed.any():
            allowed = reached.both if reached.both.any() else np.ones(len(reached), dtype=bool)
        best, _ = _best(terms, sums, allowed)
        sums = sums.plus(terms.boards.chosen(best))
        picks.append(best)
    return picks


def ordered(terms: DepthTerms, reached: ReachedPoses, picks: Picks) -> Picks:
    """The same poses, best first: the last one is the one that is missed the least, and so on."""
    left, last = list(picks), []
    sums = terms.boards.chosen(left).total()
    while len(left) > 1:
        without = sums.minus(terms.boards.chosen(left))
        loss = terms.loss(without)
        shared = reached.both[left]
        if shared.sum() <= LEAST_SHARED and not shared.all():
            loss = np.where(shared, np.inf, loss)
        place = int(np.argmin(loss))
        sums = without.chosen(place)
        last.append(left.pop(place))
    return left + last[::-1]


def alike(reached: ReachedPoses, board: Board) -> Mask:
    """Which poses (n, n) are nearly the same to whom holds the board; each is like itself."""
    (w, h), poses = board.size_m, reached.poses
    corners = poses.points_left(np.array([[0.0, 0, 0], [w, 0, 0], [w, h, 0], [0, h, 0]]))
    flat = corners.reshape(len(poses), -1)
    squares = np.sum(flat**2, axis=1)
    apart2 = np.maximum(squares[:, None] + squares - 2 * flat @ flat.T, 0.0) / 4
    distance2 = np.sum(corners.mean(axis=1) ** 2, axis=1)
    return np.asarray(apart2 <= _ALIKE**2 * np.minimum(distance2[:, None], distance2))


def _best(terms: DepthTerms, sums: Sums, allowed: Mask) -> tuple[int, float]:
    """The best of the allowed poses beside those of `sums`, and the loss with it."""
    places: npt.NDArray[np.intp] = np.flatnonzero(allowed)
    loss: Array = terms.loss(sums.plus(terms.boards.chosen(places)))
    best = int(np.argmin(loss))
    return int(places[best]), float(loss[best])


def _exchanged(terms: DepthTerms, reached: ReachedPoses, picks: Picks, close: Mask) -> bool:
    """Exchange each pick for the best pose in its place; whether any was."""
    any_better = False
    sums = terms.boards.chosen(picks).total()
    now = float(terms.loss(sums))
    for place, pick in enumerate(list(picks)):
        others = picks[:place] + picks[place + 1 :]
        allowed = np.asarray(~close[others].any(axis=0))
        if reached.both[others].sum() < LEAST_SHARED:
            allowed &= reached.both
        if not allowed.any():
            continue
        without = sums.minus(terms.boards.chosen(pick))
        best, loss = _best(terms, without, allowed)
        if loss < now * (1 - _WORTH):
            picks[place], now, any_better = best, loss, True
            sums = without.plus(terms.boards.chosen(best))
    return any_better
