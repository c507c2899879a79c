"""Left and right corners must be the same corners: which way round each board's grid is counted.

A grid turned onto itself looks the same to its finder. Colours tell the two ways apart where one of the
board's sides has an odd and the other an even number of corners; where they do not, the poses do: the right
camera stands in the left one's frame the same in every pair.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidImage, MeasurementFailed
from rigsim.pixels.calibration.camera import LEAST_CORNERS, OneCamera, board_pose, calibrate_camera
from rigsim.rig.arrays import Mask
from rigsim.rig.board import Board
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose
from rigsim.study.calibrate.pictures.sightings import Sightings

Order = npt.NDArray[np.intp]

_MOST_TURN_RAD = np.radians(8.0)
_MOST_SHIFT = 0.3
"""Of the baseline and, ...."""
_MOST_OFF = 0.08
"""... added, of the board's distance: how far one board's pose may put the right camera off."""
_LEAST_SHARE = 0.5
"""Of the pairs must agree on where the right camera stands; else the pictures may be mirrored."""
_LEAST_AGREE = 1 / 3
"""Of them must at least; fewer do by chance."""


@dataclass(frozen=True, slots=True, eq=False)
class Ordered:
    """Corners in one order in both cameras."""

    sightings: Sightings
    """The corners, those of right pictures reordered where they had to be."""
    turned: tuple[int, ...]
    """Pairs whose right corners the poses, not the colours, turned."""
    agrees: Mask
    """Which pairs put the right camera where most put it, (n,); those seen by one camera alone do."""


def agreed_order(
    sightings: Sightings, lenses: tuple[type[Lens] | None, type[Lens] | None], fix: Sequence[str]
) -> Ordered:
    """Count the corners of every right picture as its left one's are.

    Raises:
        InvalidImage: one camera's pictures are mirrored.
        MeasurementFailed: a camera cannot be calibrated alone, or the pairs agree on no rig.
    """
    cameras = [
        calibrate_camera(sightings.board, sightings.observed[:, side], sightings.sizes[side], lens, fix, name)
        for side, lens, name in ((0, lenses[0], "left"), (1, lenses[1], "right"))
    ]
    pairs = [k for k in range(len(sightings)) if all(one.poses[k] is not None for one in cameras)]
    votes = _Votes.of(sightings, cameras[0], cameras[1], pairs)
    if len(pairs) >= 3 and votes.count < max(_LEAST_SHARE * len(pairs), 2):
        _refuse_mirrored(sightings, lenses, fix, cameras[0], pairs)
    if votes.count < max(_LEAST_AGREE * len(pairs), 2):
        _refuse_wrong_pairs(sightings, votes.count, pairs)
    agrees = np.ones(len(sightings), dtype=bool)
    turned = []
    for k in pairs:
        choice = votes.choice(k)
        agrees[k] = choice is not None
        if choice is not None and choice.index > 0:
            sightings = sightings.reordered(k, choice.order)
            turned += [k] if choice.unforeseen else []
    return Ordered(sightings, tuple(turned), agrees)


@dataclass(frozen=True, slots=True, eq=False)
class _Candidate:
    """One way to count one right picture's corners."""

    pair: int
    index: int
    order: Order
    right_from_left: Pose
    distance_m: float
    unforeseen: bool


@dataclass(frozen=True, slots=True, eq=False)
class _Votes:
    """Where pairs put the right camera."""

    candidates: tuple[_Candidate, ...]
    near: Mask
    """Which candidates agree with the most popular one, (k,)."""
    count: int
    """How many pairs have one that does."""

    @classmethod
    def of(cls, sightings: Sightings, left: OneCamera, right: OneCamera, pairs: Sequence[int]) -> _Votes:
        candidates = [each for k in pairs for each in _candidates(sightings, left, right, k)]
        if not candidates:
            return cls((), np.zeros(0, dtype=bool), 0)
        R = np.array([each.right_from_left.R for each in candidates])
        t = np.array([each.right_from_left.t for each in candidates])
        z = np.array([each.distance_m for each in candidates])
        cosine = (np.einsum("aij,bij->ab", R, R) - 1) / 2
        turn = np.arccos(np.clip(cosine, -1, 1))
        shift = np.linalg.norm(t[:, None] - t[None], axis=2)
        slack = _MOST_SHIFT * np.linalg.norm(t, axis=1)[:, None] + _MOST_OFF * np.maximum(z[:, None], z[None])
        near = (turn < _MOST_TURN_RAD) & (shift < slack)
        pair = np.array([each.pair for each in candidates])
        support = np.array([len(set(pair[row])) for row in near])
        # among equals the one whose corners need no turning, then the shortest baseline
        unforeseen = np.array([each.index for each in candidates])
        best = np.lexsort((np.linalg.norm(t, axis=1), unforeseen, -support))[0]
        return cls(tuple(candidates), np.asarray(near[best]), int(support[best]))

    def choice(self, pair: int) -> _Candidate | None:
        """How to count one pair's right corners; None where no way agrees with the others."""
        ways = [
            each for each, near in zip(self.candidates, self.near, strict=True) if near and each.pair == pair
        ]
        return min(ways, key=lambda each: each.index, default=None)


def _candidates(sightings: Sightings, left: OneCamera, right: OneCamera, pair: int) -> list[_Candidate]:
    seen_left = left.poses[pair]
    assert seen_left is not None
    ways = orders(sightings.board)
    foreseen = [_fits(sightings, pair, order) for order in ways]
    # the finder's own order, then what the colours say, then the rest
    ranks = sorted(range(len(ways)), key=lambda k: (not foreseen[k], k))
    candidates = []
    for k in ranks:
        uv = sightings.observed[pair, 1][ways[k]]
        known = np.isfinite(uv).all(axis=1)
        if known.sum() < LEAST_CORNERS:
            continue
        pose = board_pose(right.camera, sightings.board.points[known], uv[known])
        if pose is not None:
            relative = pose @ seen_left.inverse
            distance = float(np.linalg.norm(seen_left.t))
            candidates.append(
                _Candidate(pair, k, ways[k], relative, distance, not foreseen[k] or (k > 0 and all(foreseen)))
            )
    return candidates


def orders(board: Board) -> list[Order]:
    """Every way (m,) to turn the grid of a board's corners onto its own shape; the first leaves it."""
    grid = np.arange(board.rows * board.cols).reshape(board.rows, board.cols)
    quarters = range(4) if board.rows == board.cols else (0, 2)
    return [np.rot90(grid, k).ravel() for k in quarters]


def _fits(sightings: Sightings, pair: int, order: Order) -> bool:
    """Whether the colours allow an order of the right corners."""
    left, right = (int(sign) for sign in sightings.polarity[pair])
    if left == 0 or right == 0:
        return True
    rows, cols = sightings.board.rows, sightings.board.cols
    row, col = divmod(int(order[0]), cols)
    # the first corner's inner square, counted from the old first corner's: colours alternate
    steps = min(row, rows - 2) + min(col, cols - 2)
    return (right if steps % 2 == 0 else -right) == left


def _refuse_wrong_pairs(sightings: Sightings, agree: int, pairs: Sequence[int]) -> None:
    """Raise, for pairs that agree on no rig."""
    who = "no two" if agree < 2 else f"only {agree}"
    raise MeasurementFailed(
        f"{who} of {len(pairs)} pairs put the right camera in the same place: are they paired wrongly, as"
        f" {sightings.names[pairs[0]]}? Give the two pictures of one moment the same number"
    )


def _refuse_mirrored(
    sightings: Sightings,
    lenses: tuple[type[Lens] | None, type[Lens] | None],
    fix: Sequence[str],
    left: OneCamera,
    pairs: Sequence[int],
) -> None:
    """Raise if the pairs agree once the right pictures are mirrored."""
    board, size = sightings.board, sightings.sizes[1]
    grid = np.arange(board.rows * board.cols).reshape(board.rows, board.cols)[:, ::-1].ravel()
    observed = sightings.observed.copy()
    observed[:, 1] = observed[:, 1, grid]
    observed[:, 1, :, 0] = size[0] - 1 - observed[:, 1, :, 0]
    mirrored = replace(sightings, observed=observed, polarity=np.zeros_like(sightings.polarity))
    right = calibrate_camera(board, observed[:, 1], size, lenses[1], fix, "right")
    votes = _Votes.of(mirrored, left, right, pairs)
    if votes.count >= 0.75 * len(pairs):
        raise InvalidImage(
            f"left and right pictures are mirrored against each other: {votes.count} of {len(pairs)} pairs"
            " agree on a rig once one camera's are flipped; flip them back, or turn the camera's mirroring"
            " off"
        )
