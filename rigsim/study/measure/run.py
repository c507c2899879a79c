"""A pair of pictures that somebody took: what their pixels say, and how well a given truth bears it out.

The two pictures and a calibration go to `rigsim.pixels`, what is found there becomes points in space by
`rigsim.theory`, and a true disparity, if there is one, is joined last (`rigsim.study.measure.truth`).
"""

from __future__ import annotations

import math
import platform
from importlib.metadata import version

import numpy as np

from rigsim.errors import InvalidImage, InvalidRange, MeasurementFailed
from rigsim.pixels.corners.pairing import match_boards
from rigsim.pixels.dense.matcher import Matcher
from rigsim.pixels.images import grey, same_size
from rigsim.pixels.opencv import load_cv2
from rigsim.pixels.patches.patches import PatchMatches, fits_rig, match_patches
from rigsim.pixels.patches.vertical import VerticalShift, find_vertical_shift
from rigsim.rig.arrays import AnyImage, Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.pose import skew
from rigsim.rig.stereo import StereoRig
from rigsim.study.measure.along import along_verdict
from rigsim.study.measure.dense import dense_map, target_quality
from rigsim.study.measure.result import BoardFit, Finding, PairMatches, PairMeasurement, Target
from rigsim.study.measure.rows import LOW_SHARE, row_verdict, shift_words
from rigsim.study.measure.truth import MatchErrors, check_truth, match_errors, truth_at
from rigsim.study.measure.words import board_findings, dense_findings, match_findings
from rigsim.theory.triangulation import triangulate
from rigsim.theory.uncertainty import pixel_gain, predict_depth_std

_SWAPPED = 3  # times as many matches the other way round
_SEARCHED_BELOW = 0.5  # share of points that tell something of the rows
_BETTER = 2  # times as many matches on other rows
_LEAST_SHIFT_PX = 0.5


def measure_pair(
    image_left: AnyImage,
    image_right: AnyImage,
    rig: StereoRig,
    *,
    matcher: Matcher | None = "sgbm",
    board: tuple[int, int] | None = None,
    square_m: float | None = None,
    truth: Array | None = None,
    target: Target | None = None,
    disparity_range: tuple[float, float] | None = None,
    timeout_s: float = 120.0,
    provenance: dict[str, object] | None = None,
) -> PairMeasurement:
    """Measure a pair of pictures.

    Args:
        image_left: (H, W) or (H, W, 3), 8 or 16 bit or floating point.
        image_right: of the same size.
        rig: the calibration of both.
        matcher: who finds the dense disparities (`rigsim.pixels.dense.dense`); None measures none.
        board: rows and columns of inner corners of boards that are to be measured as well.
        square_m: known side of the boards' squares, m, which tells whether depths are right.
        truth: true disparity ``u_left - u_right`` at the left pixels, (H, W), px; not finite where unknown.
        target: pixels of a flat target, whose dense disparities are judged by themselves.
        disparity_range: least and largest disparity to search, px.
        timeout_s: a dense matcher of somebody else that takes longer is killed.
        provenance: handed on as it is.

    Raises:
        InvalidImage: a picture or the truth cannot be used, or does not fit the others or the rig.
        InvalidRange: the target or a limit is none.
        MeasurementFailed: nothing matched, no board was found, the pictures are swapped, or the matcher
            failed.
    """
    if truth is not None:
        truth = np.where(np.isfinite(truth), truth, np.nan)
    _check(image_left, image_right, rig, truth, target, matcher)
    findings: list[Finding] = []
    corners: PairMatches | None = None
    boards: tuple[BoardFit, ...] = ()
    if board is not None:
        corners, boards = _corners(image_left, image_right, rig, board, truth)

    found: PatchMatches | None = None
    shift: VerticalShift | None = None
    try:
        found = match_patches(image_left, image_right, rig, disparity_range=disparity_range)
    except MeasurementFailed as error:
        shift = _on_other_rows(image_left, image_right, rig, None, disparity_range)
        if shift is None:
            _refuse_swapped(image_left, image_right, rig, 0, disparity_range)
        if corners is None:
            where = "" if shift is None else f". {shift_words(shift.rows_px, rig)} Calibrate or rectify again"
            raise MeasurementFailed(f"{error}{where}") from None
        findings.append(Finding("no_patches", f"Corners alone were measured. Patches: {error}.", "untold"))
    patches = None if found is None else _patches(found, rig, truth)
    if patches is not None:
        shift = _on_other_rows(image_left, image_right, rig, patches, disparity_range)
        if shift is None and patches.n < LOW_SHARE * patches.n_tried:
            _refuse_swapped(image_left, image_right, rig, patches.n, disparity_range)
    measured = tuple(matches for matches in (patches, corners) if matches is not None)
    rows = row_verdict(measured[0], rig, None if shift is None else shift.rows_px)
    if patches is not None:
        findings += match_findings(patches, rig)
    if corners is not None:
        findings += board_findings(corners, rig)
    if rows.kind == "flagged":
        findings.append(rows)
    along = along_verdict(measured, findings, rig, boards, square_m)
    if along.key == "scale":
        findings.append(along)

    dense = None
    if matcher is not None:
        searched = found.disparity_range if found is not None and disparity_range is None else disparity_range
        dense = dense_map(image_left, image_right, rig, matcher, searched, timeout_s, truth)
        findings += dense_findings(dense, truth, patches or corners)
    return PairMeasurement(
        rig=rig,
        image_left=image_left,
        image_right=image_right,
        patches=patches,
        corners=corners,
        boards=boards,
        dense=dense,
        truth=truth,
        target=target,
        target_quality=None if target is None or dense is None else target_quality(dense, truth, target),
        findings=tuple(findings),
        verdicts=(rows, along),
        provenance=dict(provenance or {}),
    )


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
    target: Target | None,
    matcher: Matcher | None,
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
    if target is not None:
        u, v, target_width, target_height = target
        if matcher is None:
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
    image_left: AnyImage,
    image_right: AnyImage,
    rig: StereoRig,
    patches: PairMatches | None,
    disparity_range: tuple[float, float] | None,
) -> VerticalShift | None:
    """The vertical shift after which the pair matches far better, where it matches badly as it is."""
    if patches is not None:
        telling = np.isfinite(patches.epipolar_px).sum()
        if telling >= _SEARCHED_BELOW * patches.n_tried:
            return None
    try:
        shift = find_vertical_shift(image_left, image_right, rig, disparity_range=disparity_range)
    except MeasurementFailed:
        return None
    if shift is None or abs(shift.rows_px) < _LEAST_SHIFT_PX:
        return None
    share = 0.0 if patches is None else patches.n / patches.n_tried
    moved = shift.matches
    return shift if moved.n_valid > _BETTER * share * len(moved.score) else None


def _refuse_swapped(
    image_left: AnyImage,
    image_right: AnyImage,
    rig: StereoRig,
    n: int,
    disparity_range: tuple[float, float] | None,
) -> None:
    """Say so where the pictures match much better the other way round."""
    try:
        swapped = match_patches(image_right, image_left, rig, disparity_range=disparity_range)
    except MeasurementFailed:
        return
    tried = len(swapped.observations.valid)
    if swapped.n_valid >= max(_SWAPPED * n, LOW_SHARE * tried):
        raise MeasurementFailed(
            f"it looks as if left and right image are swapped: {swapped.n_valid} of {tried} points match the "
            f"other way round, {n} this way; a right picture shifted along its rows until all lies beyond "
            "infinity does the same"
        )


def _patches(found: PatchMatches, rig: StereoRig, truth: Array | None) -> PairMatches:
    valid = found.observations.valid
    uv_left, uv_right = found.observations.uv_left[valid], found.observations.uv_right[valid]
    std = found.disparity_std_px[valid]
    points_left = triangulate(rig, uv_left, uv_right)
    # the prediction is linear in the noise; a disparity's is sqrt(2) of a coordinate's
    depth_std = predict_depth_std(rig, points_left, PixelNoise(1.0)) * std / math.sqrt(2)
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


def _corners(
    image_left: AnyImage,
    image_right: AnyImage,
    rig: StereoRig,
    board: tuple[int, int],
    truth: Array | None,
) -> tuple[PairMatches, tuple[BoardFit, ...]]:
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
    ones = np.ones((len(uv_left), 1))
    ray_left = np.hstack([rig.left.normalize(uv_left), ones])
    ray_right = np.hstack([rig.right.normalize(uv_right), ones])
    line = ray_left @ (skew(rig.right_from_left.t) @ rig.right_from_left.R).T
    # the line's normal points down as long as the right camera sits on the right
    off = np.sum(ray_right * line, axis=1) / np.hypot(line[:, 0], line[:, 1])
    return np.asarray(off * math.sqrt(rig.right.fx * rig.right.fy))
