"""Checker boards of any size in a cluttered picture: saddles first, then grids grown over them.

Every strong saddle of the smoothed picture is fitted as a corner; those that look like one carry a place,
the directions of their two edges and their colours. A board is grown from a corner along its edges: the
next corner lies where the last step points, its edges agree and its colours are the opposite.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter, maximum_filter
from scipy.spatial import KDTree

from rigsim.pixels.corners import saddle
from rigsim.rig.arrays import Array
from rigsim.statistics import inner_range

_SMOOTHING = 1.4  # px
_HALF_WINDOW = 4
_MOST = 6000  # saddles that are looked at
_FAINTEST = 0.06  # half a corner's step over the picture's range
_LEAST_SYMMETRY = 0.5  # correlation with itself turned by half a turn
_MAX_MISFIT = 0.3  # of the contrast
_MAX_LEAN = 0.9  # |cos| between the edges
_MAX_REACH = 0.35  # of a step, from where the next corner is expected
_MAX_TURN = 0.35  # rad, of edges from one corner to the next, and of a first step from its edge
_LONGEST_STEP = 200.0  # px
_MIN_SHARE = 0.75  # of a grid's corners must be found
_NEIGHBOURS = ((0, 1), (1, 0), (0, -1), (-1, 0))


@dataclass(frozen=True, slots=True)
class _Candidates:
    uv: Array
    """(N, 2) px."""
    along: Array
    """Unit directions of the two edges, (N, 2, 2)."""
    normal: Array
    """Unit normals of the two edges, (N, 2, 2)."""
    sign: Array
    """Sign of the contrast, (N,)."""

    def colour(self, index: int, direction: Array) -> float:
        """1 where the quadrant that `direction` (2,) points into is bright, else -1."""
        side = self.normal[index] @ direction
        return float(np.sign(self.sign[index] * side[0] * side[1]))

    def turn(self, index: int, direction: Array) -> float:
        """Smallest angle from `direction` (2,) to an edge, rad."""
        cosine = np.abs(self.along[index] @ direction).max() / np.hypot(*direction)
        return float(np.arccos(min(cosine, 1.0)))


def find_grids(levels: Array) -> list[Array]:
    """Corners of every board, (rows, cols, 2) px each, NaN where one is missing; rows and columns in any
    order and direction.

    Args:
        levels: Grey levels (H, W).
    """
    candidates = _candidates(levels)
    if len(candidates.uv) < 4:
        return []
    tree = KDTree(candidates.uv)
    free = np.ones(len(candidates.uv), dtype=bool)
    grids = []
    for seed in range(len(free)):
        if not free[seed]:
            continue
        members = _grow(seed, candidates, tree, free)
        if len(members) < 9:
            continue
        free[list(members.values())] = False
        grids.append(_as_array(members, candidates.uv))
    return [grid for grid in grids if min(grid.shape[:2]) >= 3]


def fill(grid: Array) -> Array:
    """The grid with its missing corners put where a plane's perspective has them."""
    missing = np.isnan(grid[..., 0])
    if not missing.any():
        return grid
    row, col = np.mgrid[0 : grid.shape[0], 0 : grid.shape[1]]
    board = np.stack([col, row, np.ones_like(col)], axis=-1).astype(np.float64)
    scale = np.nanstd(grid, axis=(0, 1)).max()
    middle = np.nanmean(grid, axis=(0, 1))
    seen = (grid[~missing] - middle) / scale
    source = board[~missing] / max(grid.shape)
    zero = np.zeros_like(source)
    design = np.concatenate(
        [
            np.concatenate([source, zero, -seen[:, :1] * source], axis=1),
            np.concatenate([zero, source, -seen[:, 1:] * source], axis=1),
        ]
    )
    homography = np.linalg.svd(design)[2][-1].reshape(3, 3)
    image = board[missing] / max(grid.shape) @ homography.T
    filled = grid.copy()
    filled[missing] = image[:, :2] / image[:, 2:] * scale + middle
    return filled


def _candidates(levels: Array) -> _Candidates:
    derivative = [gaussian_filter(levels, _SMOOTHING, order=order) for order in ((0, 2), (2, 0), (1, 1))]
    strength = derivative[2] ** 2 - derivative[0] * derivative[1]
    low, high = inner_range(levels)
    # an upright corner of half step b has a mixed derivative of (2 / pi) b / variance there
    faintest = (2 / np.pi * _FAINTEST * (high - low) / (_SMOOTHING**2 + 0.5)) ** 2
    peak = (strength == maximum_filter(strength, 5)) & (strength > faintest)
    margin = _HALF_WINDOW
    peak[:margin], peak[-margin:], peak[:, :margin], peak[:, -margin:] = False, False, False, False
    v, u = np.nonzero(peak)
    strongest = np.argsort(-strength[v, u], kind="stable")[:_MOST]
    v, u = v[strongest], u[strongest]
    offset = np.arange(-margin, margin + 1)
    windows = levels[v[:, None, None] + offset[:, None], u[:, None, None] + offset]
    symmetric = _half_turn_correlation(windows) > _LEAST_SYMMETRY
    u, v, windows = u[symmetric], v[symmetric], windows[symmetric]
    fit = saddle.fit(windows, np.ones_like(windows), iterations=15, tolerance_px=0.02, exact=False)
    p = fit.parameters
    contrast = np.abs(p[:, saddle.CONTRAST])
    angles = p[:, saddle.ANGLE_1 : saddle.ANGLE_2 + 1]
    good = (
        (np.hypot(p[:, saddle.U], p[:, saddle.V]) < 1.5)
        & (contrast > _FAINTEST * (high - low))
        & (fit.residual_square < fit.pixels * (_MAX_MISFIT * contrast) ** 2)
        & (np.abs(np.cos(angles[:, 0] - angles[:, 1])) < _MAX_LEAN)
        & (p[:, saddle.BLUR_VAR] < _HALF_WINDOW**2 / 4)
    )
    normal = np.stack([np.cos(angles), np.sin(angles)], axis=-1)[good]
    return _Candidates(
        uv=p[good][:, saddle.U : saddle.V + 1] + np.stack([u, v], axis=1)[good],
        along=np.stack([-normal[..., 1], normal[..., 0]], axis=-1),
        normal=normal,
        sign=np.sign(p[good, saddle.CONTRAST]),
    )


def _half_turn_correlation(windows: Array) -> Array:
    """Correlation (N,) of windows (N, S, S) with themselves turned by 180 degrees; 1 at a corner's middle."""
    flat = windows.reshape(len(windows), -1)
    flat = flat - flat.mean(axis=1, keepdims=True)
    return np.asarray(np.sum(flat * flat[:, ::-1], axis=1) / np.maximum(np.sum(flat * flat, axis=1), 1e-12))


def _grow(
    seed: int, candidates: _Candidates, tree: KDTree, free: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]
) -> dict[tuple[int, int], int]:
    """Lattice places (row, col) and the candidates on them, connected to the seed."""
    steps = _first_steps(seed, candidates, tree, free)
    if steps is None:
        return {}
    members = {(0, 0): seed}
    taken = {seed}
    step_at = {(0, 0): steps}
    bright = candidates.colour(seed, steps[0] + steps[1])
    queue = deque([(0, 0)])
    while queue:
        place = queue.popleft()
        here = candidates.uv[members[place]]
        for move in _NEIGHBOURS:
            there = (place[0] + move[0], place[1] + move[1])
            if there in members:
                continue
            axis = 0 if move[1] else 1
            direction = move[0] + move[1]
            step = step_at[place][axis]
            behind = (place[0] - move[0], place[1] - move[1])
            if behind in members:
                step = direction * (here - candidates.uv[members[behind]])
            found = _next(here + direction * step, step, candidates, tree, free, taken)
            if found is None:
                continue
            steps = step_at[place].copy()
            steps[axis] = direction * (candidates.uv[found] - here)
            if candidates.colour(found, steps[0] + steps[1]) != bright * (-1) ** (there[0] + there[1]):
                continue
            if max(candidates.turn(found, steps[0]), candidates.turn(found, steps[1])) > _MAX_TURN:
                continue
            members[there] = found
            taken.add(found)
            step_at[there] = steps
            queue.append(there)
    return members


def _first_steps(
    seed: int, candidates: _Candidates, tree: KDTree, free: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]
) -> Array | None:
    """Steps (2, 2) from the seed to its nearest neighbours along its two edges; None when it has none."""
    here = candidates.uv[seed]
    distance, near = tree.query(here, k=min(25, len(free)), distance_upper_bound=_LONGEST_STEP)
    steps: list[Array | None] = [None, None]
    for index in np.asarray(near)[np.isfinite(distance)]:
        if index == seed or not free[index]:
            continue
        offset = candidates.uv[index] - here
        cosine = candidates.along[seed] @ offset / np.hypot(*offset)
        axis = int(np.argmax(np.abs(cosine)))
        if steps[axis] is not None or abs(cosine[axis]) < np.cos(_MAX_TURN / 2):
            continue
        if candidates.turn(index, offset) > _MAX_TURN:
            continue
        steps[axis] = offset * np.sign(cosine[axis])
    first, second = steps
    if first is None or second is None:
        return None
    return np.stack([first, second])


def _next(
    expected: Array,
    step: Array,
    candidates: _Candidates,
    tree: KDTree,
    free: np.ndarray[tuple[int, ...], np.dtype[np.bool_]],
    taken: set[int],
) -> int | None:
    distance, index = tree.query(expected, distance_upper_bound=_MAX_REACH * float(np.hypot(*step)))
    if not np.isfinite(distance) or not free[index] or int(index) in taken:
        return None
    return int(index)


def _as_array(members: dict[tuple[int, int], int], uv: Array) -> Array:
    """Grid (rows, cols, 2) without border lines that hold too few corners."""
    placed = np.array(list(members))
    places = placed - placed.min(axis=0)
    grid = np.full((*(places.max(axis=0) + 1), 2), np.nan)
    grid[places[:, 0], places[:, 1]] = uv[list(members.values())]
    while grid.size:
        present = np.isfinite(grid[..., 0])
        shares = (present[0].mean(), present[-1].mean(), present[:, 0].mean(), present[:, -1].mean())
        worst = int(np.argmin(shares))
        if shares[worst] > 0.34:
            break
        grid = (grid[1:], grid[:-1], grid[:, 1:], grid[:, :-1])[worst]
    return grid if grid.size and np.isfinite(grid[..., 0]).mean() >= _MIN_SHARE else np.zeros((0, 0, 2))
