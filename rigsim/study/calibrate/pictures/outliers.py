"""Pictures that the others do not predict, and why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from rigsim.pixels.calibration.camera import board_pose
from rigsim.pixels.calibration.stereo import LEAST_BOARDS, FoundRig
from rigsim.rig.arrays import Array, Mask
from rigsim.study.calibrate.depths import depth_stds
from rigsim.study.calibrate.pictures.at_once import ratios_at_once
from rigsim.study.calibrate.pictures.fit import PicturesFit, adjusted_from, distance_rms, fit_rig
from rigsim.study.calibrate.pictures.held_out import HeldOut, alone_rms, held_out, predicted, without
from rigsim.study.calibrate.pictures.order import Ordered
from rigsim.study.calibrate.pictures.sightings import Sightings
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.covariance import CalibrationCovariance, Undetermined
from rigsim.theory.calibration.information import slopes
from rigsim.theory.calibration.parameters import RigParameters
from rigsim.theory.triangulation import triangulate

LIMIT = 2.0
"""A picture whose residual is so many times what the others predict is none of theirs."""
SUSPECT = 1.5
"""One whose residual is more than so many times that counts, and is named."""
LEAST_OFF_PX = 0.05
"""Of one coordinate: pictures whose corners are no farther off are fine, however much sharper others are."""
_MOST_LEFT_OUT = 1 / 3
"""Of the pairs: where more do not fit, it is the rig or the board that is wrong."""
_LEAST_KEPT = 3
_MOVED = 1.5
"""What both cameras together are off over what either alone is, where the board moved between the shots."""
_FEW_CORNERS = 0.1
_THEIR_SHARE = 0.7
_BLURRED = 2.0
_BENT_LEFT = 0.4
_TINY = 1e-30

OddPairReason: TypeAlias = Literal["", "moved", "mixed_up", "hidden", "blurred", "bent", "unexplained"]
"""Why a picture is an outlier: each camera alone explains it, but not both (the board moved between the two
shots, or the pictures are of different moments); they put the right camera elsewhere altogether; a few
corners are wrong; its corners are far less sharp than the others'; the board was bent; or none of these."""


@dataclass(frozen=True, slots=True, eq=False)
class Sorted:
    """Pairs that explain one another, and those that do not."""

    fit: PicturesFit
    """The rig of those that do."""
    opencv: FoundRig
    """OpenCV's rig of the same."""
    kept: Mask
    """Which pairs they are, (n,)."""
    ratios: Array
    """Each pair's residual over what the others predict, (n,); NaN where they do not."""
    rms_px: Array
    """Root mean square distance of each pair's corners from where they should be, px, (n,); of those left out
    with the others' rig."""
    reasons: tuple[OddPairReason, ...]
    """Why each was left out, or is suspect; empty where it is neither."""


@dataclass(frozen=True, slots=True)
class WithoutSuspects:
    """The rig without the suspect pairs, against the one with them."""

    names: tuple[str, ...]
    """The suspects."""
    baseline_m: float
    """Baseline without them, m."""
    baseline_stds: float
    """How far that is from the one with them, in the latter's standard deviations."""
    z_m: float
    """A depth on the left optical axis, m."""
    depth_shift_m: float
    """How much farther a point there is without them, m."""
    depth_shift_stds: float
    """The same in the standard deviation that the calibration with them leaves there."""
    depth_std_m: tuple[float, float]
    """Depth std from the calibration there, with and without them, m."""
    beyond_chance: float
    """The larger of both moves over its standard deviation for honest pairs, the root of what leaving them
    out adds to the variance: about 1 for those."""


def sort_out(ordered: Ordered, parameters: RigParameters, fix: Sequence[str]) -> Sorted:
    """Calibrate, and leave out, worst first, what the others do not predict.

    Raises:
        InvalidRange: OpenCV cannot hold what `fix` names.
        MeasurementFailed: OpenCV finds no rig.
    """
    sightings = ordered.sightings
    found = np.asarray(sightings.cameras.any(axis=1))
    kept = found & ordered.agrees
    least = max(int(np.ceil((1 - _MOST_LEFT_OUT) * found.sum())), _LEAST_KEPT)
    fit, opencv = fit_rig(sightings.chosen(kept), parameters, fix)
    while True:
        ratios = ratios_at_once(fit)
        bad = stands_out(ratios, fit.picture_rms_px, LIMIT)
        if not bad.any() or kept.sum() <= least:
            break
        worst = int(np.argmax(np.where(bad, ratios, 0.0)))
        kept[np.flatnonzero(kept)[worst]] = False
        fit = without(fit, worst)
    if kept.sum() < found.sum():
        fit, opencv = fit_rig(sightings.chosen(kept), parameters, fix)
        ratios = ratios_at_once(fit)
    return _told(ordered, fit, opencv, kept, ratios)


def _told(ordered: Ordered, fit: PicturesFit, opencv: FoundRig, kept: Mask, kept_ratios: Array) -> Sorted:
    """With what there is to say of every pair."""
    sightings = ordered.sightings
    n = len(sightings)
    ratios, rms_px = np.full(n, np.nan), np.full(n, np.nan)
    ratios[kept], rms_px[kept] = kept_ratios, fit.picture_rms_px
    reasons: list[OddPairReason] = [""] * n
    for place, k in enumerate(np.flatnonzero(kept).tolist()):
        if stands_out(ratios[k], rms_px[k], SUSPECT):
            reasons[k] = why(held_out(fit, place), sightings, k)
    for k in np.flatnonzero(sightings.cameras.any(axis=1) & ~kept).tolist():
        check = predicted(fit, sightings, k, _start(sightings, fit, k))
        ratios[k], rms_px[k] = check.ratio, distance_rms(check.residuals)
        reasons[k] = why(check, sightings, k) if ordered.agrees[k] else "mixed_up"
    return Sorted(fit, opencv, kept, ratios, rms_px, tuple(reasons))


def without_suspects(
    fit: PicturesFit, suspect: Mask, covariance: CalibrationCovariance, z_m: float
) -> WithoutSuspects | None:
    """What leaving out the `suspect` pairs (n,) of a fit changes at a depth; None without any, or where the
    others leave the rig open."""
    rest = fit.sightings.chosen(~suspect)
    if not suspect.any() or rest.cameras.all(axis=1).sum() < LEAST_BOARDS:
        return None
    found = fit.adjusted
    others = adjusted_from(rest, fit.parameters, found.rig, found.poses.chosen(~suspect))
    try:
        after = others.covariance
    except Undetermined:
        return None
    stds = [depth_stds(each, (z_m,), 1.0, ("axis",))[0] for each in (covariance, after)]
    # at the others' noise, which the suspects do not swell
    shrunk = others.noise_px / fit.noise_px
    baseline_by = np.sqrt(max(baseline_std(after) ** 2 - (shrunk * baseline_std(covariance)) ** 2, _TINY))
    depth_by = np.sqrt(max(stds[1].in_camera_m ** 2 - (shrunk * stds[0].in_camera_m) ** 2, _TINY))
    rig = others.adjusted.rig
    depth_m = triangulate(rig, *found.rig.project(np.array([[0.0, 0.0, z_m]])))[0, 2]
    moves = abs(rig.baseline_m - found.rig.baseline_m) / baseline_by, abs(depth_m - z_m) / depth_by
    return WithoutSuspects(
        names=tuple(np.array(fit.sightings.names)[suspect].tolist()),
        baseline_m=rig.baseline_m,
        baseline_stds=(rig.baseline_m - found.rig.baseline_m) / baseline_std(covariance),
        z_m=z_m,
        depth_shift_m=float(depth_m - z_m),
        depth_shift_stds=float(depth_m - z_m) / stds[0].in_camera_m,
        depth_std_m=(stds[0].calibration_m, stds[1].calibration_m),
        beyond_chance=float(max(moves)),
    )


def baseline_std(covariance: CalibrationCovariance) -> float:
    """Standard deviation of the baseline, m."""
    shift = covariance.parameters.pose
    C = covariance.matrix[shift, shift][3:, 3:]
    along = covariance.rig.right_from_left.t / covariance.rig.baseline_m
    return float(np.sqrt(max(float(along @ C @ along), 0.0)))


def stands_out(ratios: npt.ArrayLike, rms_px: npt.ArrayLike, limit: float) -> Mask:
    """Which pairs are so many times as far off as the others predict, and by more than any board is true
    to."""
    least = LEAST_OFF_PX * np.sqrt(2)
    return np.asarray((np.asarray(ratios) > limit) & (np.asarray(rms_px) > least))


def why(check: HeldOut, sightings: Sightings, pair: int) -> OddPairReason:
    """Why a pair is not as the others predict."""
    fit = check.fit
    alone = [alone_rms(fit, sightings, pair, side, check.pose) for side in (0, 1)]
    together = distance_rms(check.residuals) / np.sqrt(2)
    if max(alone) < together / _MOVED:
        return "moved"
    squares = np.sum(check.residuals**2, axis=-1).ravel()
    squares = np.sort(squares[np.isfinite(squares)])[::-1]
    few = max(int(_FEW_CORNERS * squares.size), 1)
    if squares[:few].sum() > _THEIR_SHARE * squares.sum():
        return "hidden"
    claimed = sightings.claimed_px
    if np.isfinite(claimed[pair]).any():
        usual = np.nanmedian(np.delete(claimed, pair, axis=0))
        if max(np.nanmedian(claimed[pair, side]) for side in (0, 1)) > _BLURRED * usual:
            return "blurred"
    if distance_rms(_flattened(check, sightings, pair)) < _BENT_LEFT * distance_rms(check.residuals):
        return "bent"
    return "unexplained"


def _flattened(check: HeldOut, sightings: Sightings, pair: int) -> Array:
    """Its residuals (k, 2) where the board's warps and its pose explain them best, to first order."""
    fit = check.fit
    warped = RigParameters.of(fit.parameters.lenses, warped=True)
    J, J_pose = slopes(fit.adjusted.rig, warped, fit.adjusted.board, check.pose)
    known = np.isfinite(check.residuals)
    A = np.column_stack([J[0][known][:, warped.warp], J_pose[0][known]])
    r = check.residuals[known]
    left = r - A @ np.linalg.lstsq(A, r, rcond=None)[0]
    return np.asarray(left.reshape(-1, 2))


def _start(sightings: Sightings, fit: PicturesFit, pair: int) -> BoardPoses:
    """About where a board was, by the left camera or, where it saw none, by the right one."""
    rig = fit.adjusted.rig
    for side, camera in ((0, rig.left), (1, rig.right)):
        known = sightings.found[pair, side]
        pose = None
        if known.any():
            pose = board_pose(camera, sightings.board.points[known], sightings.observed[pair, side, known])
        if pose is not None:
            pose = pose if side == 0 else rig.right_from_left.inverse @ pose
            return BoardPoses(pose.R[None], pose.t[None])
    return fit.adjusted.poses.chosen(np.array([0]))
