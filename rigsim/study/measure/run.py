"""A pair of pictures that somebody took: what their pixels say, and how well a given truth bears it out.

The two pictures and a calibration go to `rigsim.pixels`, what is found there becomes points in space by
`rigsim.theory`, and a true disparity, if there is one, is joined last (`rigsim.study.measure.truth`).
"""

from __future__ import annotations

import platform
from dataclasses import dataclass
from importlib.metadata import version

import numpy as np

from rigsim.errors import InvalidImage, InvalidRange, MeasurementFailed
from rigsim.pixels.dense.matcher import Matcher
from rigsim.pixels.dense.views import RowView
from rigsim.pixels.images import grey, same_size
from rigsim.pixels.opencv import load_cv2
from rigsim.pixels.patches.patches import PatchMatches, fits_rig, match_patches
from rigsim.pixels.patches.vertical import VerticalShift, find_vertical_shift
from rigsim.rig.arrays import AnyImage, Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.measure.along import along_verdict
from rigsim.study.measure.dense import dense_map, target_quality
from rigsim.study.measure.findings import board_findings, dense_findings, match_findings
from rigsim.study.measure.matches import corner_matches, patch_matches
from rigsim.study.measure.result import BoardFit, Finding, PairMatches, PairMeasurement, Target
from rigsim.study.measure.rows import LOW_SHARE, row_verdict, shift_words
from rigsim.study.measure.truth import check_truth

_SWAPPED = 3  # times as many matches the other way round
_SEARCHED_BELOW = 0.5  # share of points that tell something of the rows
_BETTER = 2  # times as many matches on other rows
_LEAST_SHIFT_PX = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class Wanted:
    """What of a pair is to be measured, and how."""

    matcher: Matcher | None = "sgbm"
    """Who finds the dense disparities (`rigsim.pixels.dense.dense`); None measures none."""
    board: tuple[int, int] | None = None
    """Rows and columns of inner corners of boards that are to be measured as well."""
    square_m: float | None = None
    """Known side of the boards' squares, m, which tells whether depths are right."""
    target: Target | None = None
    """Pixels of a flat target, whose dense disparities are judged by themselves."""
    disparity_range: tuple[float, float] | None = None
    """Least and largest disparity to search, px."""
    timeout_s: float = 120.0
    """A dense matcher of somebody else that takes longer is killed."""
    rectify: RowView | None = None
    """What a pair that is not rectified is turned into; None chooses by what the lenses see."""


def measure_pair(
    image_left: AnyImage,
    image_right: AnyImage,
    rig: StereoRig,
    wanted: Wanted | None = None,
    *,
    truth: Array | None = None,
    provenance: dict[str, object] | None = None,
) -> PairMeasurement:
    """Measure a pair of pictures.

    Args:
        image_left: (H, W) or (H, W, 3), 8 or 16 bit or floating point.
        image_right: of the same size.
        rig: the calibration of both.
        wanted: what is to be measured, and how.
        truth: true disparity ``u_left - u_right`` at the left pixels, (H, W), px; not finite where unknown.
        provenance: handed on as it is.

    Raises:
        InvalidImage: a picture or the truth cannot be used, or does not fit the others or the rig.
        InvalidRange: the target or a limit is none.
        MeasurementFailed: nothing matched, no board was found, the pictures are swapped, or the matcher
            failed.
    """
    wanted = wanted or Wanted()
    if truth is not None:
        truth = np.where(np.isfinite(truth), truth, np.nan)
    _check(image_left, image_right, rig, truth, wanted)
    corners: PairMatches | None = None
    boards: tuple[BoardFit, ...] = ()
    if wanted.board is not None:
        corners, boards = corner_matches(image_left, image_right, rig, wanted.board, truth)
    look = _look_for_patches((image_left, image_right), rig, truth, wanted, corners is None)
    verdicts, findings = _conclude(look, corners, boards, rig, wanted.square_m)
    dense = None
    if wanted.matcher is not None:
        searched = wanted.disparity_range
        if look.found is not None and searched is None:
            searched = look.found.disparity_range
        dense = dense_map(
            (image_left, image_right),
            rig,
            matcher=wanted.matcher,
            disparity_range=searched,
            timeout_s=wanted.timeout_s,
            truth=truth,
            view=wanted.rectify,
        )
        findings += dense_findings(dense, truth, look.patches or corners)
    target = wanted.target
    return PairMeasurement(
        rig=rig,
        image_left=image_left,
        image_right=image_right,
        patches=look.patches,
        corners=corners,
        boards=boards,
        dense=dense,
        truth=truth,
        target=target,
        target_quality=None if target is None or dense is None else target_quality(dense, truth, target),
        findings=tuple(findings),
        verdicts=verdicts,
        provenance=dict(provenance or {}),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Look:
    """What matching patches gave; without any, why not."""

    found: PatchMatches | None
    patches: PairMatches | None
    shift: VerticalShift | None
    why: str = ""


def _look_for_patches(
    pair: tuple[AnyImage, AnyImage], rig: StereoRig, truth: Array | None, wanted: Wanted, needed: bool
) -> _Look:
    """Match patches, and see whether the pair matches better on other rows or the other way round.

    Raises:
        MeasurementFailed: the pictures are swapped, or nothing matched where matches are `needed`.
    """
    try:
        found = match_patches(*pair, rig, disparity_range=wanted.disparity_range, view=wanted.rectify)
    except MeasurementFailed as error:
        shift = _on_other_rows(pair, rig, None, wanted)
        if shift is None:
            _refuse_swapped(pair, rig, 0, wanted)
        if needed:
            where = "" if shift is None else f". {shift_words(shift.rows_px, rig)} Calibrate or rectify again"
            raise MeasurementFailed(f"{error}{where}") from None
        return _Look(None, None, shift, str(error))
    patches = patch_matches(found, rig, truth)
    shift = _on_other_rows(pair, rig, patches, wanted)
    if shift is None and patches.n < LOW_SHARE * patches.n_tried:
        _refuse_swapped(pair, rig, patches.n, wanted)
    return _Look(found, patches, shift)


def _conclude(
    look: _Look,
    corners: PairMatches | None,
    boards: tuple[BoardFit, ...],
    rig: StereoRig,
    square_m: float | None,
) -> tuple[tuple[Finding, Finding], list[Finding]]:
    """The two verdicts, and what should make one doubt the matches."""
    measured = tuple(matches for matches in (look.patches, corners) if matches is not None)
    rows = row_verdict(measured[0], rig, None if look.shift is None else look.shift.rows_px)
    findings: list[Finding] = []
    if look.patches is None:
        findings.append(Finding("no_patches", "corners-alone", "untold", of=look.why))
    else:
        findings += match_findings(look.patches, rig)
    if corners is not None:
        findings += board_findings(corners, rig)
    if rows.kind == "flagged":
        findings.append(rows)
    along = along_verdict(measured, findings, rig, boards, square_m)
    if along.key == "scale":
        findings.append(along)
    return (rows, along), findings


def versions() -> dict[str, object]:
    """Versions of what measures, as JSON values."""
    names = ("rigsim", "numpy", "scipy")
    return {
        **{name: version(name) for name in names},
        "opencv": str(load_cv2().__version__),
        "python": platform.python_version(),
    }


def _check(
    image_left: AnyImage,
    image_right: AnyImage,
    rig: StereoRig,
    truth: Array | None,
    wanted: Wanted,
) -> None:
    """Refuse what cannot be measured before anything long is started."""
    left, right = grey(image_left, "left image"), grey(image_right, "right image")
    same_size(left, right)
    fits_rig(left, rig)
    height, width = left.shape
    if np.array_equal(left, right):
        raise InvalidImage("left and right image are the same picture: give one of each camera")
    if truth is not None:
        check_truth(truth, width, height)
    if wanted.target is not None:
        u, v, target_width, target_height = wanted.target
        if wanted.matcher is None:
            raise InvalidRange("a target is judged by its dense disparities: measure them")
        if not rig.is_rectified:
            raise InvalidRange("a target needs a rectified rig: its pixels are those of the rectified pair")
        if min(target_width, target_height) < 1 or not (
            0 <= u <= width - target_width and 0 <= v <= height - target_height
        ):
            raise InvalidRange(
                f"target of {target_width} x {target_height} px at {u},{v}: must lie on the pictures of "
                f"{width} x {height} px"
            )


def _on_other_rows(
    pair: tuple[AnyImage, AnyImage], rig: StereoRig, patches: PairMatches | None, wanted: Wanted
) -> VerticalShift | None:
    """The vertical shift after which the pair matches far better, where it matches badly as it is."""
    if patches is not None:
        telling = np.isfinite(patches.epipolar_px).sum()
        if telling >= _SEARCHED_BELOW * patches.n_tried:
            return None
    try:
        shift = find_vertical_shift(*pair, rig, disparity_range=wanted.disparity_range, view=wanted.rectify)
    except MeasurementFailed:
        return None
    if shift is None or abs(shift.rows_px) < _LEAST_SHIFT_PX:
        return None
    share = 0.0 if patches is None else patches.n / patches.n_tried
    moved = shift.matches
    return shift if moved.n_valid > _BETTER * share * len(moved.score) else None


def _refuse_swapped(pair: tuple[AnyImage, AnyImage], rig: StereoRig, n: int, wanted: Wanted) -> None:
    """Say so where the pictures match much better the other way round."""
    try:
        swapped = match_patches(
            pair[1], pair[0], rig, disparity_range=wanted.disparity_range, view=wanted.rectify
        )
    except MeasurementFailed:
        return
    tried = len(swapped.observations.valid)
    if swapped.n_valid >= max(_SWAPPED * n, LOW_SHARE * tried):
        raise MeasurementFailed(
            f"it looks as if left and right image are swapped: {swapped.n_valid} of {tried} points match the "
            f"other way round, {n} this way; a right picture shifted along its rows until all lies beyond "
            "infinity does the same"
        )
