"""What was found in both pictures, as points in space, with the truth joined where there is one."""

from __future__ import annotations

import math

import numpy as np

from rigsim.pixels.corners.pairing import match_boards
from rigsim.pixels.patches.patches import PatchMatches
from rigsim.rig.arrays import AnyImage, Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.pose import skew
from rigsim.rig.stereo import StereoRig
from rigsim.sim.truth.points import directions
from rigsim.study.measure.result import BoardFit, PairMatches
from rigsim.study.measure.truth import MatchErrors, match_errors, truth_at
from rigsim.theory.triangulation import triangulate
from rigsim.theory.uncertainty import pixel_gain, predict_depth_std


def patch_matches(found: PatchMatches, rig: StereoRig, truth: Array | None) -> PairMatches:
    """The trusted patches as points in space, with the errors of those whose true disparity is known."""
    valid = found.observations.valid
    uv_left, uv_right = found.observations.uv_left[valid], found.observations.uv_right[valid]
    std = found.disparity_std_px[valid]
    points_left = triangulate(rig, uv_left, uv_right)
    # the prediction is linear in the noise; a disparity's is sqrt(2) of a coordinate's
    right_std = found.right_std_px[valid]
    depth_std = predict_depth_std(rig, points_left, PixelNoise(1.0)) * right_std / math.sqrt(2)
    nothing = np.full(len(uv_left), -1, dtype=np.int32)
    true, depth_error, errors = _judged(rig, uv_left, uv_right, std, truth)
    return PairMatches(
        kind="patches",
        n_tried=len(valid),
        uv_left=uv_left,
        uv_right=uv_right,
        disparity_std_px=std,
        epipolar_px=found.epipolar_px[valid],
        score=found.score[valid],
        points_left=points_left,
        depth_std_m=depth_std,
        board=nothing,
        corner=nothing,
        truth_px=true,
        depth_error_m=depth_error,
        errors=errors,
    )


def corner_matches(
    image_left: AnyImage,
    image_right: AnyImage,
    rig: StereoRig,
    board: tuple[int, int],
    truth: Array | None,
) -> tuple[PairMatches, tuple[BoardFit, ...]]:
    """The corners of all boards as points in space, and how well each board fits itself.

    Raises:
        MeasurementFailed: no board was found in both pictures.
    """
    found = match_boards(image_left, image_right, *board, rig=rig)
    valid = found.observations.valid
    uv_left, uv_right = found.observations.uv_left[valid], found.observations.uv_right[valid]
    covariance = np.zeros((len(uv_left), 4, 4))
    covariance[:, :2, :2], covariance[:, 2:, 2:] = found.cov_left[valid], found.cov_right[valid]
    std = np.sqrt(covariance[:, 0, 0] + covariance[:, 2, 2])
    points_left = triangulate(rig, uv_left, uv_right)
    gain_z = pixel_gain(rig, points_left)[:, 2]
    true, depth_error, errors = _judged(rig, uv_left, uv_right, std, truth)
    matches = PairMatches(
        kind="corners",
        n_tried=len(valid),
        uv_left=uv_left,
        uv_right=uv_right,
        disparity_std_px=std,
        epipolar_px=_epipolar_px(rig, uv_left, uv_right),
        score=np.full(len(uv_left), np.nan),
        points_left=points_left,
        depth_std_m=np.sqrt(np.einsum("ni,nij,nj->n", gain_z, covariance, gain_z)),
        board=found.board[valid],
        corner=found.corner[valid],
        truth_px=true,
        depth_error_m=depth_error,
        errors=errors,
    )
    fits = (_board_fit(matches, i, *map(int, size)) for i, size in enumerate(found.sizes))
    return matches, tuple(fits)


def _board_fit(corners: PairMatches, board: int, rows: int, cols: int) -> BoardFit:
    mine = corners.board == board
    points = corners.points_left[mine]
    flat = np.full((rows * cols, 3), np.nan)
    flat[corners.corner[mine]] = points
    grid = flat.reshape(rows, cols, 3)
    sides = [np.linalg.norm(np.diff(grid, axis=axis), axis=-1).ravel() for axis in (0, 1)]
    side = np.concatenate(sides)
    side = side[np.isfinite(side)]
    known = points[np.isfinite(points[:, 2])]
    flatness = math.nan
    if len(known) > 3:
        flatness = float(np.linalg.svd(known - known.mean(axis=0), compute_uv=False)[2])
        flatness /= math.sqrt(len(known))
    return BoardFit(
        board=board,
        n=int(mine.sum()),
        distance_m=float(np.median(known[:, 2])) if len(known) else math.nan,
        square_m=float(side.mean()) if len(side) else math.nan,
        square_std_m=float(side.std()) if len(side) else math.nan,
        flatness_rms_m=flatness,
    )


def _judged(
    rig: StereoRig, uv_left: Array, uv_right: Array, std_px: Array, truth: Array | None
) -> tuple[Array, Array, MatchErrors | None]:
    """True disparity (N,) px, depth error (N,) m, and a summary of both."""
    if truth is None:
        unknown = np.full(len(uv_left), np.nan)
        return unknown, unknown, None
    true = truth_at(truth, uv_left)
    disparity = uv_left[:, 0] - uv_right[:, 0]
    uv_true = uv_right + np.column_stack([disparity - true, np.zeros(len(true))])
    depth, true_depth = (triangulate(rig, uv_left, uv)[:, 2] for uv in (uv_right, uv_true))
    return true, depth - true_depth, match_errors(disparity, std_px, true)


def _epipolar_px(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    """How far below the epipolar line of its left position a right one lies, (N,), px."""
    ray_left, ray_right = directions(rig.left, uv_left), directions(rig.right, uv_right)
    line = ray_left @ (skew(rig.right_from_left.t) @ rig.right_from_left.R).T
    # the line's normal points down as long as the right camera sits on the right
    off = np.sum(ray_right * line, axis=1) / np.hypot(line[:, 0], line[:, 1])
    return np.asarray(off * math.sqrt(rig.right.fx * rig.right.fy))
