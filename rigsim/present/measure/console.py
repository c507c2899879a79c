"""A measured pair for people: tables and sentences in a terminal, and pictures."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from rich.console import Console

from rigsim.present.kit.console import make_console, paragraph, print_table
from rigsim.present.kit.format import count, length, length_mm, number, percent
from rigsim.present.kit.pictures import disparity_picture, encode, picture_limits, with_scale
from rigsim.present.measure.words import rows_in_short, sentence
from rigsim.rig.arrays import Array, Image
from rigsim.statistics import inner_range, rms, robust_rms
from rigsim.study.measure.result import DenseMap, Finding, PairMatches, PairMeasurement, eight_bit
from rigsim.study.measure.rows import row_verdict
from rigsim.study.measure.truth import OUTLIER_PX, DenseErrors

_BINS = 5
_LEAST_IN_BIN = 20
_DOT_PX = 2
_LOCKING_PX = 0.05
_REGIONS = {
    "non-occluded": "non-\noccluded",
    "textureless": "texture-\nless",
    "near-discontinuity": "near a\nstep",
}


def _pct(value_pct: float) -> str:
    return percent(value_pct / 100)


def _px(value_px: float) -> str:
    return number(value_px, 2)


_METRICS: tuple[tuple[str, str, Callable[[float], str]], ...] = (
    ("pixels with ground truth", "n", count),
    ("with a disparity, %", "fill_pct", _pct),
    ("wrong by > 0.5 px, %", "bad_0_5_pct", _pct),
    ("wrong by > 1 px, %", "bad_1_pct", _pct),
    ("wrong by > 2 px, %", "bad_2_pct", _pct),
    ("wrong by > 4 px, %", "bad_4_pct", _pct),
    ("D1: > 3 px and > 5 %, %", "d1_pct", _pct),
    ("mean error, px", "mean_px", _px),
    ("mean |error| (EPE), px", "epe_px", _px),
    ("RMS error, px", "rms_px", _px),
    ("median |error|, px", "median_abs_px", _px),
    ("NMAD, px", "nmad_px", _px),
)


def print_pair(
    result: PairMeasurement, folder: Path | None = None, *, console: Console | None = None
) -> None:
    """Print what was measured of a pair.

    Args:
        result: the measurement.
        folder: where its files are; nothing is said about it when None.
        console: where to; standard output by default.
    """
    console = console or make_console()
    rig = result.rig
    paragraph(
        console,
        f"Pair of {rig.left.width} x {rig.left.height} px; baseline {length(rig.baseline_m)}, focal length "
        f"{number(rig.left.fx, 4)} px",
        style="bold",
    )
    for finding in result.findings:
        paragraph(console, f"Warning: {sentence(finding, rig)}", style="bold yellow")
    console.print()
    for matches in result.matches:
        rows = result.verdicts[0] if matches is result.best_matches else row_verdict(matches, rig)
        for said in _sentences(matches, rows):
            paragraph(console, said)
        console.print()
        _print_by_depth(matches, console)
    for verdict in result.verdicts:
        if verdict.kind == "untold" or verdict.key == "along_rows":
            paragraph(console, sentence(verdict, rig))
    console.print()
    if result.boards:
        _print_boards(result, console)
    if result.dense is not None:
        _print_dense(result.dense, console)
    if result.target_quality is not None:
        _print_target(result, console)
    if folder is not None:
        paragraph(console, f"Files: {folder}", style="bold")


def pair_pictures(result: PairMeasurement) -> dict[str, bytes]:
    """Name to content: disparity.png, and the rectified pictures where the pair had to be rectified."""
    dense = result.dense
    if dense is None:
        return {"disparity.png": _with_scale(_dots(result), result.best_matches.disparity_px)}
    picture = disparity_picture(dense.disparity)
    files = {"disparity.png": _with_scale(picture, dense.disparity)}
    if dense.rectified:
        files["left_rectified.png"] = encode(eight_bit(dense.image_left))
        files["right_rectified.png"] = encode(eight_bit(dense.image_right))
    return files


def _sentences(matches: PairMatches, rows: Finding) -> Iterator[str]:
    what = "points of the left picture were matched" if matches.kind == "patches" else "corners were found"
    depth = matches.points_left[:, 2]
    depth = depth[np.isfinite(depth)]
    where = ""
    if len(depth):
        near, far = inner_range(depth)
        where = f", nearly all at {length(near)} to {length(far)}"
    yield f"{matches.kind.capitalize()}: {count(matches.n)} of {count(matches.n_tried)} {what}{where}."
    off_px = matches.epipolar_rms_px
    if math.isfinite(off_px):
        yield (
            f"They lie {_px(off_px)} px (RMS) off their epipolar lines, half of them within "
            f"{_px(matches.epipolar_typical_px)} px: {rows_in_short(rows)}."
        )
    yield (
        f"Predicted standard deviation of a disparity: {number(matches.predicted_std_px, 2)} px in the "
        f"median, {number(matches.predicted_rms_px, 2)} px RMS."
    )
    errors = matches.errors
    if errors is not None and errors.errors.n:
        scatter = errors.inlier_std_px
        others = f", the others scatter by {_px(scatter)} px" if math.isfinite(scatter) else ""
        yield (
            f"Against the truth ({count(errors.errors.n)} matches): wrong by "
            f"{_px(errors.errors.median_abs_px)} px in the median; {_pct(errors.outlier_pct)} % by more than "
            f"3 px{others}; {_pct(errors.within_3_std_pct)} % lie within 3 of their predicted standard "
            "deviations."
        )
    elif errors is not None:
        yield "No ground truth for these matches."
    judged = errors is not None and errors.inlier_std_px > 0
    said = "That scatter" if judged else "That RMS"
    yield f"{said} corresponds to --noise {matches.noise_px:.2g} in `rigsim sweep`."


def _print_by_depth(matches: PairMatches, console: Console) -> None:
    """How accurate at which distance: equally many matches in every row."""
    depth = matches.points_left[:, 2]
    known = np.flatnonzero(np.isfinite(depth) & np.isfinite(matches.depth_std_m))
    known = known[np.argsort(depth[known], kind="stable")]
    if not len(known):
        return
    judged = matches.errors is not None and matches.errors.errors.n > 0
    off = np.abs(matches.disparity_px - matches.truth_px) > OUTLIER_PX
    error_m = np.where(off, np.nan, matches.depth_error_m)
    rows = []
    for part in np.array_split(known, max(1, min(_BINS, len(known) // _LEAST_IN_BIN))):
        row = [
            f"{length(depth[part[0]])} to {length(depth[part[-1]])}",
            count(len(part)),
            length(float(np.median(matches.depth_std_m[part]))),
            length(rms(matches.depth_std_m[part])),
        ]
        if judged:
            error = error_m[part]
            error = error[np.isfinite(error)]
            row += [length(robust_rms(error)), length(rms(error))]
        rows.append(row)
    columns = ["depth", "matches", "predicted\ntypical", "predicted\nRMS"]
    columns += ["measured\ntypical", "measured\nRMS"] if judged else []
    paragraph(console, f"Depth errors of {matches.kind}", style="bold")
    if judged:
        paragraph(console, "Typical is the median, and 1.48 times the median |error|; outliers are left out.")
    else:
        paragraph(console, "Typical is the median.")
    print_table("", columns, rows, numeric=[False] + [True] * (len(columns) - 1), console=console)


def _print_boards(result: PairMeasurement, console: Console) -> None:
    rows = [
        (
            board.board + 1,
            count(board.n),
            length(board.distance_m),
            length(board.square_m, 4),
            length(board.square_std_m),
            length(board.flatness_rms_m),
        )
        for board in result.boards
    ]
    print_table(
        "Boards on their own: check the square size with a ruler",
        ("board", "corners", "depth", "square", "its scatter", "off its plane, RMS"),
        rows,
        numeric=[True] * 6,
        console=console,
    )


def _print_dense(dense: DenseMap, console: Console) -> None:
    low, high = inner_range(dense.disparity)
    to = "" if dense.view == "perspective" else f" ({dense.view}, rows about the baseline)"
    rectified = f" of the pair, which was rectified first{to}," if dense.rectified else ""
    paragraph(
        console,
        f"Dense ({dense.matcher}):{rectified} {_pct(dense.image_fill_pct)} % of the pixels have a "
        f"disparity, nearly all from {number(low)} to {number(high)} px.",
    )
    errors = dense.errors
    if errors is not None and math.isfinite(errors.inlier_std_px):
        for sentence in _dense_sentences(errors):
            paragraph(console, sentence)
    console.print()
    if errors is None:
        return
    print_table(
        "Disparity against the truth",
        ("", *(_REGIONS.get(name, name) for name in errors.regions)),
        [
            (label, *(say(getattr(region, key)) for region in errors.regions.values()))
            for label, key, say in _METRICS
        ],
        numeric=[False] + [True] * len(errors.regions),
        console=console,
    )


def _dense_sentences(errors: DenseErrors) -> Iterator[str]:
    depth = errors.depth
    side = "far" if depth.z_accuracy_pct > 0 else "near"
    yield (
        f"As depths: {number(abs(depth.z_accuracy_pct), 2)} % too {side} in the median, "
        f"{number(depth.rms_pct, 2)} % or {length_mm(depth.rms_mm)} RMS (0.5 % trimmed at either end)."
    )
    amplitude = errors.phase.amplitude_px
    locking = ": pixel locking" if amplitude > _LOCKING_PX else ""
    yield f"The error swings by {number(amplitude, 2)} px with the fraction of a pixel{locking}."
    yield (
        f"The scatter of all within 3 px, {number(errors.inlier_std_px, 2)} px, corresponds to --noise "
        f"{errors.inlier_std_px / math.sqrt(2):.2g} in `rigsim sweep`."
    )


def _print_target(result: PairMeasurement, console: Console) -> None:
    quality = result.target_quality
    if quality is None:
        return
    rows = [
        ("fill rate", f"{_pct(quality.fill_rate_pct)} %", "pixels with a disparity"),
        ("distance", length_mm(quality.distance_mm, 4), "where its plane meets the middle of the picture"),
        (
            "plane-fit RMS",
            length_mm(quality.plane_fit_rms_mm),
            f"distance from the plane; {number(quality.plane_fit_rms_pct, 2)} % of the distance",
        ),
        ("sub-pixel RMS", f"{number(quality.subpixel_rms_px, 2)} px", "the same in disparity"),
    ]
    if math.isfinite(quality.z_accuracy_pct):
        rows.append(
            (
                "Z accuracy",
                f"{number(quality.z_accuracy_pct, 2)} %",
                "median depth error, positive is too far",
            )
        )
    print_table(
        "Flat target", ("quantity", "value", "meaning"), rows, numeric=(False, True, False), console=console
    )


def _dots(result: PairMeasurement) -> Image:
    """The left picture in grey, with a dot on every match in the colour of its disparity."""
    grey = eight_bit(result.image_left).mean(axis=2, keepdims=True)
    picture = np.repeat(grey, 3, axis=2).astype(np.uint8)
    matches = result.best_matches
    limits = picture_limits(matches.disparity_px)
    colors = disparity_picture(matches.disparity_px[:, None], limits)[:, 0]
    height, width = picture.shape[:2]
    at = np.round(matches.uv_left).astype(np.intp)
    reach = range(-_DOT_PX, _DOT_PX + 1)
    for down in reach:
        for along in reach:
            v, u = np.clip(at[:, 1] + down, 0, height - 1), np.clip(at[:, 0] + along, 0, width - 1)
            picture[v, u] = colors
    return picture


def _with_scale(picture: Image, disparity: Array) -> bytes:
    return encode(with_scale(picture, picture_limits(disparity), "disparity, px"))
