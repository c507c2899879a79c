"""Calibrates a rig from corners of a board, and says how good that is."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidImage, MeasurementFailed
from rigsim.pixels.calibration.stereo import LEAST_BOARDS
from rigsim.rig.arrays import Mask
from rigsim.study.calibrate.depths import depth_stds
from rigsim.study.calibrate.pictures.asked import PicturesAsked
from rigsim.study.calibrate.pictures.coverage import coverage
from rigsim.study.calibrate.pictures.fit import PicturesFit, adjusted_from, both_sides
from rigsim.study.calibrate.pictures.following import following
from rigsim.study.calibrate.pictures.look import Looked, Seen
from rigsim.study.calibrate.pictures.order import agreed_order
from rigsim.study.calibrate.pictures.outliers import (
    SUSPECT,
    Sorted,
    sort_out,
    stands_out,
    without_suspects,
)
from rigsim.study.calibrate.pictures.remarks import remarks_of
from rigsim.study.calibrate.pictures.result import (
    CalibratedPictures,
    PictureCheck,
    PictureVerdict,
    WarpCheck,
)
from rigsim.study.calibrate.pictures.sightings import Sightings
from rigsim.theory.calibration.covariance import CalibrationCovariance, Undetermined
from rigsim.theory.calibration.parameters import WARP, RigParameters

_SAME_PX = 1e-6
"""Corners that are no farther apart are of one picture."""
_STILL_PX = 0.5
"""A board whose corners move no farther was not moved."""


def calibrate_pictures(asked: PicturesAsked, looked: Looked) -> CalibratedPictures:
    """Calibrate, and check every picture by the others.

    Raises:
        InvalidImage: the pictures are all the same, or one camera's are mirrored.
        InvalidRange: OpenCV cannot hold what is to be held.
        MeasurementFailed: too few pairs show the board, or they leave the rig open.
    """
    sightings = looked.sightings
    _check_count(sightings)
    _check_variety(sightings)
    copies = duplicates(sightings)
    whole = np.array(["unreadable" not in both for both in looked.seen])
    which = np.flatnonzero(~copies & whole & sightings.cameras.any(axis=1))
    parameters = asked.parameters
    ordered = agreed_order(sightings.chosen(which), parameters.lenses, both_sides(asked.held))
    found = sort_out(ordered, parameters, asked.held)
    covariance = _covariance(found.fit)
    result = CalibratedPictures(
        asked=asked,
        sightings=_put_back(sightings, ordered.sightings, which),
        pairs=looked.pairs,
        kept=_spread(found.kept, which, len(sightings)),
        fit=found.fit,
        opencv=found.opencv,
        covariance=covariance,
        depths=depth_stds(covariance, asked.at_m, asked.noise_px),
        pictures=_checks(looked, copies, which, found),
        coverage=coverage(found.fit.sightings),
        warp=warp_check(found.fit),
        without_suspects=without_suspects(found.fit, _suspects(found), covariance, asked.middle_m),
        next_pose=following(asked, found.fit) if asked.following else None,
        remarks=(),
        interrupted=looked.interrupted,
    )
    turned = tuple(sightings.names[which[k]] for k in ordered.turned)
    return replace(result, remarks=(*looked.remarks, *remarks_of(result, turned)))


def duplicates(sightings: Sightings) -> Mask:
    """Which pairs show the very corners of an earlier one, (n,)."""
    copies = np.zeros(len(sightings), dtype=bool)
    seen = [k for k in range(len(sightings)) if sightings.cameras[k].any()]
    for k in seen:
        for earlier in seen[: seen.index(k)]:
            if not copies[earlier] and _farthest_px(sightings, k, earlier) < _SAME_PX:
                copies[k] = True
    return copies


def warp_check(fit: PicturesFit) -> WarpCheck:
    """The board's warps, if they are looked for, and how likely a flat board looks so."""
    nothing = WarpCheck((np.nan, np.nan), (np.nan, np.nan), 1.0)
    if not fit.parameters.warped:
        # asked of the corners even where the rig is not to follow it
        parameters = _with_warp(fit.parameters)
        fit = adjusted_from(fit.sightings, parameters, fit.adjusted.rig, fit.adjusted.poses)
    try:
        covariance = fit.covariance
    except Undetermined:
        return nothing
    rise = np.array(fit.adjusted.board.warp_m)
    C = covariance.of_rig[fit.parameters.warp, fit.parameters.warp]
    if not (np.isfinite(C).all() and np.linalg.det(C) > 0):
        return nothing
    square = float(rise @ np.linalg.solve(C, rise))
    std = np.sqrt(np.diagonal(C))
    chance = math.exp(-square / 2)  # chi-squared of two degrees
    return WarpCheck((float(rise[0]), float(rise[1])), (float(std[0]), float(std[1])), chance)


def _with_warp(parameters: RigParameters) -> RigParameters:
    free = np.append(parameters.free, [True, True])
    return replace(parameters, names=(*parameters.names, *WARP), free=free, warped=True)


def _check_count(sightings: Sightings) -> None:
    both = int(sightings.cameras.all(axis=1).sum())
    if both < LEAST_BOARDS:
        alone = sightings.cameras.sum(axis=0)
        raise MeasurementFailed(
            f"{both} pair(s) show the board in both pictures ({alone[0]} in the left, {alone[1]} in the"
            f" right alone or with it): must be >= {LEAST_BOARDS}, and some ten with the board held"
            " differently are worth having"
        )


def _check_variety(sightings: Sightings) -> None:
    """Refuse pictures that are all the same.

    Raises:
        InvalidImage: they are.
    """
    both = np.flatnonzero(sightings.cameras.all(axis=1))
    left, right = sightings.observed[both, 0], sightings.observed[both, 1]
    if np.nanmax(np.abs(left - right)) < _SAME_PX:
        raise InvalidImage("left and right pictures are the same: give those of two cameras")
    moves = [_farthest_px(sightings, int(both[0]), int(k)) for k in both[1:]]
    if max(moves) < _STILL_PX:
        raise InvalidImage(
            f"the board is at the same place in all {len(both)} pairs (no corner moves by more than"
            f" {max(moves):.2g} px): move and tilt it between pictures"
        )


def _farthest_px(sightings: Sightings, one: int, other: int) -> float:
    """How far a corner moves between two pairs, px; infinite where not the same ones were found."""
    a, b = sightings.observed[one], sightings.observed[other]
    if not np.array_equal(np.isfinite(a), np.isfinite(b)):
        return float("inf")
    return float(np.nanmax(np.abs(a - b)))


def _covariance(fit: PicturesFit) -> CalibrationCovariance:
    if not np.isfinite(fit.noise_px):
        raise MeasurementFailed(
            f"{len(fit.sightings)} pairs have too few corners for what is looked for: give more pictures, or"
            " hold some of it (--fix k3,aspect)"
        )
    try:
        return fit.covariance
    except Undetermined as error:
        names = ", ".join(error.names[:4])
        raise MeasurementFailed(
            f"the pictures leave open: {names}: tilt the board some 30 degrees both ways, bring it near and"
            " into the corners, or hold them (--fix)"
        ) from None


def _checks(
    looked: Looked, copies: Mask, which: npt.NDArray[np.intp], found: Sorted
) -> tuple[PictureCheck, ...]:
    place = {int(k): j for j, k in enumerate(which)}
    checks = []
    for k, name in enumerate(looked.sightings.names):
        corners = looked.sightings.found[k].sum(axis=1)
        count = int(corners[0]), int(corners[1])
        j = place.get(k)
        if j is None:
            verdict: PictureVerdict = "duplicate" if copies[k] else _unseen(looked.seen[k])
            checks.append(PictureCheck(name, verdict, "", count, np.nan, np.nan))
            continue
        ratio = float(found.ratios[j])
        suspect = bool(stands_out(ratio, found.rms_px[j], SUSPECT))
        verdict = _verdict(bool(found.kept[j]), bool(corners.all()), suspect)
        checks.append(PictureCheck(name, verdict, found.reasons[j], count, float(found.rms_px[j]), ratio))
    return tuple(checks)


def _suspects(found: Sorted) -> Mask:
    """Which of the pairs that count are suspect."""
    return stands_out(found.ratios[found.kept], found.rms_px[found.kept], SUSPECT)


def _verdict(kept: bool, both: bool, suspect: bool) -> PictureVerdict:
    if not kept:
        return "outlier"
    if suspect:
        return "suspect"
    return "good" if both else "one_camera"


def _unseen(seen: tuple[Seen, Seen]) -> PictureVerdict:
    for word in ("unreadable", "several"):
        if word in seen:
            return word
    return "not_found"


def _put_back(whole: Sightings, part: Sightings, which: npt.NDArray[np.intp]) -> Sightings:
    """The whole with the corners of some pairs in another order."""
    observed, claimed, weights = whole.observed.copy(), whole.claimed_px.copy(), whole.weights.copy()
    observed[which], claimed[which], weights[which] = part.observed, part.claimed_px, part.weights
    return replace(whole, observed=observed, claimed_px=claimed, weights=weights)


def _spread(kept: Mask, which: npt.NDArray[np.intp], count: int) -> Mask:
    all_kept = np.zeros(count, dtype=bool)
    all_kept[which[kept]] = True
    return all_kept
