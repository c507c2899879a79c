"""The same boards' corners in the left and the right picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from rigsim.errors import InvalidImage, MeasurementFailed
from rigsim.pixels.corners.boards import BoardCorners, find_sizes, not_found, turns
from rigsim.pixels.images import grey, same_size
from rigsim.rig.arrays import AnyImage, Array, Ids
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.lens import ahead
from rigsim.rig.observations import Observations
from rigsim.rig.pose import skew
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import rms

_HOPELESS = 1e9


@dataclass(frozen=True, slots=True)
class BoardMatches:
    """Corners of all boards seen in both pictures; one row a corner, board after board, row-major."""

    observations: Observations
    """Positions, (N, 2) px each; valid where the corner was fitted in both."""
    cov_left: Array
    """Covariance of the left positions (N, 2, 2), px^2; NaN where not valid."""
    cov_right: Array
    """Covariance of the right positions (N, 2, 2), px^2; NaN where not valid."""
    board: Ids
    """Which board (N,), counted from the left in the left picture."""
    corner: Ids
    """Which corner of its board (N,), row-major."""
    sizes: Ids
    """Rows and columns of inner corners of each board (B, 2)."""
    epipolar_rms_px: float
    """RMS distance of the right positions from their epipolar lines, px: how well the rig's calibration
    holds for this pair."""


def match_boards(
    left_image: AnyImage,
    right_image: AnyImage,
    rows: int,
    cols: int,
    *,
    rig: StereoRig | None = None,
    max_epipolar_px: float = 5.0,
    limit: int = 32,
) -> BoardMatches:
    """Find the boards of rows x cols inner corners in both pictures and put their corners side by side.

    A board of the left picture belongs to the one in the right picture that lies on its epipolar lines, in
    front of both cameras, with the same colours and about the same size; where that leaves a choice,
    disparities are kept small.

    Args:
        left_image: (H, W) or (H, W, 3).
        right_image: Of the same size.
        rows: Rows of inner corners.
        cols: Columns of inner corners.
        rig: Calibration that is believed; None takes the pair for rectified.
        max_epipolar_px: RMS distance from the epipolar lines above which two boards are not the same.
        limit: At most so many boards a picture.

    Raises:
        InvalidImage: a picture, or the pair, cannot be used.
        MeasurementFailed: no board in one of the pictures (the message says which), or none in both.
    """
    return match_sizes(
        left_image, right_image, [(rows, cols)], rig=rig, max_epipolar_px=max_epipolar_px, limit=limit
    )


def match_sizes(
    left_image: AnyImage,
    right_image: AnyImage,
    sizes: Sequence[tuple[int, int]],
    *,
    rig: StereoRig | None = None,
    max_epipolar_px: float = 5.0,
    limit: int = 32,
) -> BoardMatches:
    """`match_boards` of several sizes (rows, cols) at once; sizes that are not seen are no error."""
    left_grey = grey(left_image, "left image")
    same_size(left_grey, grey(right_image, "right image"))
    if rig is not None:
        for name, intrinsics in (("left", rig.left), ("right", rig.right)):
            if left_grey.shape != (intrinsics.height, intrinsics.width):
                raise InvalidImage(
                    f"{name} image {left_grey.shape[1]} x {left_grey.shape[0]} px: "
                    f"the rig says {intrinsics.width} x {intrinsics.height}"
                )
    found = []
    for name, image in (("left image", left_image), ("right image", right_image)):
        boards = find_sizes(image, sizes, name=name, limit=limit)
        if not boards:
            raise MeasurementFailed(not_found(name, sizes))
        found.append(boards)
    return pair_boards(found[0], found[1], rig=rig, max_epipolar_px=max_epipolar_px)


def pair_boards(
    left: tuple[BoardCorners, ...],
    right: tuple[BoardCorners, ...],
    *,
    rig: StereoRig | None = None,
    max_epipolar_px: float = 5.0,
) -> BoardMatches:
    """`match_boards` of boards already found.

    Raises:
        MeasurementFailed: no board of the left picture is one of the right picture's.
    """
    geometry = _Epipolar.of(rig)
    cost = np.full((len(left), len(right)), _HOPELESS)
    nearest = np.inf
    turned: dict[tuple[int, int], BoardCorners] = {}
    for i, board in enumerate(left):
        for j, candidate in enumerate(right):
            if (candidate.rows, candidate.cols) != (board.rows, board.cols):
                continue
            for turn in _turned(candidate, board.polarity):
                distance, in_front, disparity = geometry.compare(board, turn)
                nearest = min(nearest, distance)
                if distance > max_epipolar_px or not in_front:
                    continue
                price = distance**2 + (np.log(_size(turn) / _size(board)) / 0.1) ** 2 + disparity * 1e-3
                if price < cost[i, j]:
                    cost[i, j], turned[i, j] = price, turn
    assigned = ((int(i), int(j)) for i, j in zip(*linear_sum_assignment(cost), strict=True))
    pairs = [(i, j) for i, j in assigned if cost[i, j] < _HOPELESS]
    if not pairs:
        near = f"the nearest pair is {nearest:.1f} px off its epipolar lines, at most {max_epipolar_px:g}"
        if not np.isfinite(nearest):
            near = "their rows and columns differ"
        elif nearest <= max_epipolar_px:
            near = "every pair on common epipolar lines lies behind the cameras"
        raise MeasurementFailed(
            f"{len(left)} board(s) in the left and {len(right)} in the right image, none the same: {near}; "
            "are the images swapped, or not as the rig says?"
        )
    return _stack([(left[i], turned[i, j]) for i, j in pairs], geometry)


def _stack(pairs: list[tuple[BoardCorners, BoardCorners]], geometry: _Epipolar) -> BoardMatches:
    valid = np.concatenate([a.valid & b.valid for a, b in pairs])
    uv_left, uv_right = (np.concatenate([pair[side].uv for pair in pairs]) for side in (0, 1))
    cov_left, cov_right = (np.concatenate([pair[side].cov for pair in pairs]) for side in (0, 1))
    count = [a.rows * a.cols for a, _ in pairs]
    for values in (uv_left, uv_right, cov_left, cov_right):
        values[~valid] = np.nan
    distance = geometry.distance_px(uv_left[valid], uv_right[valid])
    return BoardMatches(
        Observations(uv_left, uv_right, valid),
        cov_left,
        cov_right,
        np.repeat(np.arange(len(pairs)), count).astype(np.int32),
        np.concatenate([np.arange(n) for n in count]).astype(np.int32),
        np.array([(a.rows, a.cols) for a, _ in pairs], dtype=np.int32),
        rms(distance),
    )


def _turned(board: BoardCorners, polarity: int) -> list[BoardCorners]:
    """The board in every order of its corners that has the given polarity."""
    index_grid = np.arange(board.rows * board.cols, dtype=np.float64).reshape(board.rows, board.cols, 1)
    boards = []
    for order in turns(index_grid):
        index = order.ravel().astype(np.intp)
        row, col = divmod(int(index[0]), board.cols)
        # the first corner's inner square, counted from the old first corner's: colours alternate
        steps = min(row, board.rows - 2) + min(col, board.cols - 2)
        sign = board.polarity * (-1) ** steps
        if sign == polarity:
            boards.append(
                replace(
                    board, uv=board.uv[index], cov=board.cov[index], valid=board.valid[index], polarity=sign
                )
            )
    return boards


def _size(board: BoardCorners) -> float:
    """Root of the mean squared distance of the corners from their middle, px."""
    uv = board.uv[board.valid]
    return float(np.sqrt(np.mean(np.sum((uv - uv.mean(axis=0)) ** 2, axis=1))))


@dataclass(frozen=True, slots=True)
class _Epipolar:
    """What a rig says about two positions of one point; without a rig, what any rectified rig says."""

    rig: StereoRig | None
    R: Array
    t: Array

    @classmethod
    def of(cls, rig: StereoRig | None) -> _Epipolar:
        if rig is None:
            return cls(None, np.eye(3), np.array([-1.0, 0.0, 0.0]))
        return cls(rig, rig.right_from_left.R, rig.right_from_left.t / rig.baseline_m)

    def compare(self, left: BoardCorners, right: BoardCorners) -> tuple[float, bool, float]:
        """RMS epipolar distance px, whether the corners lie in front, and their mean |disparity| px."""
        both = left.valid & right.valid
        if np.count_nonzero(both) < 4:
            return np.inf, False, np.inf
        uv_left, uv_right = left.uv[both], right.uv[both]
        distance = rms(self.distance_px(uv_left, uv_right))
        shift = float(np.mean(np.linalg.norm(uv_left - uv_right, axis=1)))
        return distance, self._in_front(uv_left, uv_right), shift

    def distance_px(self, uv_left: Array, uv_right: Array) -> Array:
        """Distance (N,) px of right positions from the epipolar lines of left ones (N, 2)."""
        x_left, x_right = self._rays(uv_left, uv_right)
        lines = x_left @ (skew(self.t) @ self.R).T
        focal = 1.0 if self.rig is None else (self.rig.right.fx * self.rig.right.fy) ** 0.5
        return np.asarray(
            focal * np.sum(x_right * lines, axis=1) / np.maximum(np.hypot(lines[:, 0], lines[:, 1]), 1e-15)
        )

    def _in_front(self, uv_left: Array, uv_right: Array) -> bool:
        """Whether most rays meet in front of both cameras: z_R x_R = z_L R x_L + t."""
        x_left, x_right = self._rays(uv_left, uv_right)
        a = x_left @ self.R.T
        aa, bb, ab = (np.sum(p * q, axis=1) for p, q in ((a, a), (x_right, x_right), (a, x_right)))
        at, bt = a @ self.t, x_right @ self.t
        determinant = aa * bb - ab * ab
        z_left, z_right = (ab * bt - bb * at) / determinant, (aa * bt - ab * at) / determinant
        return bool(np.mean((z_left > 0) & (z_right > 0)) > 0.5)

    def _rays(self, uv_left: npt.ArrayLike, uv_right: npt.ArrayLike) -> tuple[Array, Array]:
        left, right = (np.asarray(uv, dtype=np.float64) for uv in (uv_left, uv_right))
        if self.rig is None:
            return ahead(left), ahead(right)
        return _rays_of(self.rig.left, left), _rays_of(self.rig.right, right)


def _rays_of(camera: Intrinsics, uv: Array) -> Array:
    """Rays (N, 3) of pixels, with z 1 where the lens is no wide one."""
    return camera.ray(uv) if camera.is_wide else ahead(camera.normalize(uv))
