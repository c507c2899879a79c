"""The third witness: what is found in the pictures, with the truth joined afterwards.

`rigsim.pixels` gets two pictures and a calibration, as a user's program would; here its answers are held
against what the scene says.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from rigsim.errors import InvalidImage, MeasurementFailed
from rigsim.pixels.corners.pairing import match_sizes
from rigsim.pixels.dense.pair import dense_of_any
from rigsim.pixels.dense.views import RowView
from rigsim.pixels.patches.patches import match_patches
from rigsim.rig.arrays import Array, Ids, Mask
from rigsim.rig.stereo import StereoRig
from rigsim.sim.simulator import Simulator
from rigsim.sim.truth.points import away
from rigsim.statistics import abs_p95, nmad, rms
from rigsim.study.agreement.claims import claim_scale, scale_columns
from rigsim.study.scene import columns as col
from rigsim.study.scene.columns import MEASURED_COLUMNS, Row
from rigsim.study.scene.pictures import Pictures
from rigsim.study.scene.plan import Triangulator
from rigsim.theory.triangulation import triangulate
from rigsim.theory.uncertainty import pixel_gain

METHODS: tuple[str, ...] = ("none", "corners", "patches", "dense")
"""What may be measured."""

_JOIN_PX = 2.0  # a corner further from every true one is none of them
_OUTLIER_PX = 3.0  # of disparity
_DENSE_STRIDE = 4
# share of Gaussian errors within three standard deviations, as a bound on chi squared of 1 and 4 degrees
_THREE_SIGMA = {1: 9.0, 4: 16.25}


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredMatches:
    """Matches of one pair of pictures beside their truth; one row a match that the measurement trusts."""

    method: str
    """corners, patches or dense."""
    uv_left: Array
    """Found in the left picture, (N, 2), px."""
    uv_right: Array
    """Found in the right picture, (N, 2), px."""
    covariance_px2: Array
    """What the measurement claims of (u_left, v_left, u_right, v_right), (N, 4, 4), px^2."""
    points_left: Array
    """True points, (N, 3), m; NaN where there is none."""
    error_px: Array
    """Found minus true (u_left, v_left, u_right, v_right), (N, 4), px; NaN where there is no truth."""
    outlier: Mask
    """Whether the match is of nothing that both cameras see, or more than 3 px of disparity off, (N,)."""
    why: str = ""
    """Why nothing was measured; empty when something was."""

    @property
    def degrees(self) -> int:
        """How many of the four numbers were measured: 4 for corners, 1 for a match at a given left pixel."""
        return 4 if self.method == "corners" else 1

    @property
    def disparity_error_px(self) -> Array:
        """Found minus true disparity, (N,), px."""
        return np.asarray(self.error_px[:, 0] - self.error_px[:, 2])


def measure(
    method: str,
    simulator: Simulator,
    rig: StereoRig,
    pictures: Pictures,
    assumed: StereoRig | None = None,
    view: RowView | None = None,
) -> MeasuredMatches:
    """Measure a pair of pictures of the placed rig and join the truth.

    The measurement is given the calibration of the `assumed` rig, the placed one's by default; the truth is
    the placed one's. What cannot be measured is a result without rows that says why.
    """
    assumed = assumed or rig
    try:
        if method == "corners":
            return _corners(simulator, rig, assumed, pictures)
        if method == "patches":
            return _patches(simulator, rig, assumed, pictures, view)
        return _dense(simulator, rig, assumed, pictures, view)
    except (MeasurementFailed, InvalidImage) as error:
        empty = np.empty((0, 4))
        return MeasuredMatches(
            method,
            empty[:, :2],
            empty[:, :2],
            np.empty((0, 4, 4)),
            np.empty((0, 3)),
            empty,
            np.empty(0, dtype=bool),
            str(error),
        )


def _corners(simulator: Simulator, rig: StereoRig, assumed: StereoRig, pictures: Pictures) -> MeasuredMatches:
    truth = simulator.true_corners()
    if len(truth.points_left) == 0:
        raise MeasurementFailed(f"scene {simulator.scene.name} declares no boards: measure patches")
    sizes = sorted({(int(rows), int(cols)) for rows, cols in truth.sizes})
    found = match_sizes(pictures.left, pictures.right, sizes, rig=assumed)
    valid = found.observations.valid
    uv_left, uv_right = found.observations.uv_left[valid], found.observations.uv_right[valid]
    covariance = np.zeros((len(uv_left), 4, 4))
    covariance[:, :2, :2] = found.cov_left[valid]
    covariance[:, 2:, 2:] = found.cov_right[valid]

    # a corner is the true one next to it in the left picture; the right picture must then speak for itself
    true_left, _ = rig.project(truth.points_left)
    known = np.flatnonzero(np.isfinite(true_left).all(axis=1))
    points_left = np.full((len(uv_left), 3), np.nan)
    board_sizes = found.sizes[found.board[valid]]
    for rows, cols in sizes:
        ours = np.flatnonzero((board_sizes == (rows, cols)).all(axis=1))
        theirs = known[(truth.sizes[known] == (rows, cols)).all(axis=1)]
        if len(ours) and len(theirs):
            distance, nearest = (np.asarray(part) for part in cKDTree(true_left[theirs]).query(uv_left[ours]))
            near = distance < _JOIN_PX
            points_left[ours[near]] = truth.points_left[theirs[nearest[near]]]
    return _joined("corners", rig, uv_left, uv_right, covariance, points_left, np.isfinite(points_left[:, 2]))


def _patches(
    simulator: Simulator, rig: StereoRig, assumed: StereoRig, pictures: Pictures, view: RowView | None
) -> MeasuredMatches:
    found = match_patches(pictures.left, pictures.right, assumed, view=view)
    valid = found.observations.valid
    uv_left = found.observations.uv_left[valid]
    points_left, visible = simulator.points_at(uv_left)
    counted = ~simulator.on_sky(points_left)
    uv_left, points_left, visible = uv_left[counted], points_left[counted], visible[counted]
    return _joined(
        "patches",
        rig,
        uv_left,
        found.observations.uv_right[valid][counted],
        _along_epipolar_lines(assumed, points_left, found.right_std_px[valid][counted]),
        points_left,
        visible,
    )


def _dense(
    simulator: Simulator, rig: StereoRig, assumed: StereoRig, pictures: Pictures, view: RowView | None
) -> MeasuredMatches:
    disparity, rectification = dense_of_any(pictures.left, pictures.right, assumed, view=view)
    height, width = disparity.shape
    v, u = (part.ravel() for part in np.mgrid[:height:_DENSE_STRIDE, :width:_DENSE_STRIDE])
    known = np.isfinite(disparity[v, u])
    v, u = v[known], u[known]
    uv_left = np.column_stack([u, v]).astype(np.float64)
    uv_right = uv_left - np.column_stack([disparity[v, u], np.zeros(len(u))])
    if rectification.rig is not assumed:
        uv_left, uv_right = rectification.left_pixels(uv_left), rectification.right_pixels(uv_right)
    points_left, visible = simulator.points_at(uv_left)
    counted = ~simulator.on_sky(points_left)
    u, uv_left, uv_right = u[counted], uv_left[counted], uv_right[counted]
    points_left, visible = points_left[counted], visible[counted]
    joined = _joined("dense", rig, uv_left, uv_right, np.zeros((len(u), 4, 4)), points_left, visible)
    # the matcher claims nothing for itself: take what its inliers scatter by, in a way that ignores tails
    error = joined.disparity_error_px[~joined.outlier]
    std_px = nmad(error)
    covariance = _along_epipolar_lines(assumed, points_left, np.full(len(u), std_px))
    return _joined("dense", rig, uv_left, uv_right, covariance, points_left, visible)


def _along_epipolar_lines(rig: StereoRig, points_left: Array, std_px: Array) -> Array:
    """Covariance (N, 4, 4) px^2 of right positions that are uncertain along their epipolar lines alone."""
    points_right = rig.right_from_left.apply(points_left)
    ray_right = points_left @ rig.right_from_left.R.T
    direction = np.einsum("nij,nj->ni", rig.right.jacobian(points_right), ray_right)
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    covariance = np.zeros((len(points_left), 4, 4))
    covariance[:, 2:, 2:] = (std_px**2)[:, None, None] * direction[:, :, None] * direction[:, None, :]
    return covariance


def _joined(
    method: str,
    rig: StereoRig,
    uv_left: Array,
    uv_right: Array,
    covariance_px2: Array,
    points_left: Array,
    visible: Mask,
) -> MeasuredMatches:
    true_left, true_right = rig.project(points_left)
    error_px = np.hstack([uv_left - true_left, uv_right - true_right])
    off_px = error_px[:, :2] - error_px[:, 2:]
    # a wide lens's epipolar lines run in every direction
    size_px = np.linalg.norm(off_px, axis=1) if rig.right.is_wide else np.abs(off_px[:, 0])
    off = ~(size_px <= _OUTLIER_PX)
    return MeasuredMatches(method, uv_left, uv_right, covariance_px2, points_left, error_px, off | ~visible)


def nothing_measured() -> Row:
    """The measured columns of a row for which nothing was to be measured."""
    row: Row = dict.fromkeys(MEASURED_COLUMNS, math.nan)
    return {**row, col.MEASURED_METHOD: "none", col.MEASURED_N: 0}


def measured_row(measured: MeasuredMatches, rig: StereoRig, method: Triangulator, inside: Mask) -> Row:
    """The measured columns over the matches in `inside` (N,), triangulated by `method`."""
    kept = inside & ~measured.outlier
    row = nothing_measured() | {col.MEASURED_METHOD: measured.method, col.MEASURED_N: int(kept.sum())}
    if inside.any():
        row[col.MEASURED_OUTLIER_FRACTION] = float(measured.outlier[inside].mean())
    if not kept.any():
        return row
    points_left = measured.points_left[kept]
    found_left = triangulate(rig, measured.uv_left[kept], measured.uv_right[kept], method)
    kept[kept] = np.isfinite(found_left[:, 2])
    if not kept.any():
        return row
    points_left = measured.points_left[kept]
    error_m = found_left[np.isfinite(found_left[:, 2]), 2] - points_left[:, 2]
    gain_z = pixel_gain(rig, points_left)[:, 2]
    claimed_m2 = np.einsum("ni,nij,nj->n", gain_z, measured.covariance_px2[kept], gain_z)
    disparity_error_px = measured.disparity_error_px[kept]
    distance2 = _claimed_distance2(measured, kept)
    scales = (claim_scale(distance2, measured.degrees), claim_scale(error_m**2 / claimed_m2, 1))
    pixel_error2 = (
        float((measured.error_px[kept] ** 2).mean())
        if measured.degrees == 4
        else float((disparity_error_px**2).mean()) / 2
    )
    rmse_m, predicted_m = rms(error_m), math.sqrt(float(claimed_m2.mean()))
    return (
        row
        | {
            col.MEASURED_PIXEL_RMS: math.sqrt(pixel_error2),
            col.MEASURED_DISPARITY_STD: float(disparity_error_px.std()),
            col.MEASURED_DEPTH_BIAS: float(error_m.mean()) * 1e3,
            col.MEASURED_DEPTH_RMSE: rmse_m * 1e3,
            col.MEASURED_DEPTH_ABS_P95: abs_p95(error_m) * 1e3,
            col.PREDICTED_FROM_MEASURED_RMSE: predicted_m * 1e3,
            col.MEASURED_OVER_PREDICTED: rmse_m / predicted_m if predicted_m > 0 else math.nan,
            col.MEASURED_WITHIN_3_SIGMA: float((distance2 <= _THREE_SIGMA[measured.degrees]).mean()),
        }
        | scale_columns(scales)
    )


def _claimed_distance2(measured: MeasuredMatches, kept: Mask) -> Array:
    """Squared pixel errors over what the matches claim, (N,): chi-squared of `degrees` when it holds."""
    error, covariance = measured.error_px[kept], measured.covariance_px2[kept]
    if measured.degrees == 4:
        return np.asarray(np.einsum("ni,ni->n", error, np.linalg.solve(covariance, error[..., None])[..., 0]))
    variance = np.trace(covariance[:, 2:, 2:], axis1=1, axis2=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray((error[:, 2:] ** 2).sum(axis=1) / variance)


def bins_of(measured: MeasuredMatches, rig: StereoRig, edges_m: Array) -> Ids:
    """Depth bin of each match, (N,); -1 where its true point lies in none."""
    depth_m = away(rig.left, measured.points_left)
    inside = (depth_m >= edges_m[0]) & (depth_m <= edges_m[-1])
    bins = np.searchsorted(edges_m[1:-1], depth_m, side="right")
    return np.asarray(np.where(inside, bins, -1), dtype=np.int32)
