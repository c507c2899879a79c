"""Files of a measured pair: one JSON document, tables, point clouds, the disparity."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pandas as pd

from rigsim import foreign
from rigsim.errors import InvalidRange
from rigsim.interop.documents.base import Written
from rigsim.interop.documents.text import clean
from rigsim.interop.files.ply import ply_bytes
from rigsim.interop.files.tables import csv_bytes, json_bytes
from rigsim.interop.formats.middlebury import read_disparity
from rigsim.interop.formats.rig_toml import write_rig
from rigsim.pixels.dense.metrics import DisparityErrors
from rigsim.pixels.dense.pfm import pfm_bytes
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.measure.result import DenseMap, Finding, PairMatches, PairMeasurement, eight_bit

_PNG_BIT_DEPTH = 24  # byte of the header


def read_truth(path: Path, png_scale: float | None = None) -> Array:
    """A true disparity (H, W) px from a PFM, NPY or PNG file, as `middlebury.read_disparity`.

    Args:
        path: the file.
        png_scale: grey levels of a PNG that are one px; by default 256, for 16 bit (KITTI's).

    Raises:
        OutputError: the file cannot be read.
        InvalidImage: it holds no disparity map.
        InvalidRange: the scale is none, or a PNG of 8 bit was given without one.
    """
    if png_scale is not None:
        if not (math.isfinite(png_scale) and png_scale > 0):
            raise InvalidRange(f"truth scale {png_scale:g}: must be > 0")
        return read_disparity(path, png_scale=png_scale)
    head = foreign.read_bytes(path, "a disparity map (PFM, NPY or PNG)")[: _PNG_BIT_DEPTH + 1]
    if head.startswith(b"\x89PNG") and head[_PNG_BIT_DEPTH:] == b"\x08":
        raise InvalidRange(
            f"{path}: a PNG of 8 bit: say with --truth-scale how many grey levels are one px (Middlebury: "
            "1 to 8)"
        )
    return read_disparity(path)


def sources(paths: Mapping[str, Path]) -> dict[str, object]:
    """Name and SHA-256 of files that were measured, as JSON values.

    Raises:
        OutputError: a file cannot be read.
    """
    return {
        key: {"file": str(path), "sha256": hashlib.sha256(foreign.read_bytes(path, "a file")).hexdigest()}
        for key, path in paths.items()
    }


def document(
    result: PairMeasurement, says: Callable[[Finding, StereoRig], str], written: Written | None = None
) -> dict[str, object]:
    """Everything measured as one JSON document (docs/reference/measure.md); null where there is no number.

    Args:
        result: what was measured.
        says: puts a finding into words.
        written: its folder and files; None when none was asked for.
    """
    best, dense = result.best_matches, result.dense

    def told(finding: Finding) -> dict[str, object]:
        return {"key": finding.key, "says": says(finding, result.rig), "kind": finding.kind}

    return {
        "n_matches": sum(matches.n for matches in result.matches),
        "epipolar_rms_px": _number(best.epipolar_rms_px),
        "epipolar_median_px": _number(best.epipolar_median_px),
        "rig": _rig(result.rig),
        "patches": None if result.patches is None else _matches(result.patches),
        "corners": None
        if result.corners is None
        else {**_matches(result.corners), "boards": _boards(result)},
        "dense": None if dense is None else _dense(dense),
        "target": None
        if result.target is None or result.target_quality is None
        else {
            "pixels": list(result.target),
            **{key: _number(value) for key, value in asdict(result.target_quality).items()},
        },
        "verdicts": [told(verdict) for verdict in result.verdicts],
        "warnings": [told(finding) for finding in result.findings],
        "written": None if written is None else written.model_dump(),
    }


def pair_files(result: PairMeasurement) -> dict[str, bytes]:
    """The files of a measured pair that programs read, but for the document."""
    files = {
        "matches.csv": csv_bytes(matches_table(result)),
        "points.ply": _points_ply(result),
        "rig.toml": write_rig(result.rig, comment="rig that the pair was measured with").encode(),
        "provenance.json": json_bytes(result.provenance),
    }
    if result.dense is not None:
        files["disparity.pfm"] = pfm_bytes(result.dense.disparity)
        files["cloud.ply"] = _cloud_ply(result.dense)
        if result.dense.rectified:
            comment = "rectified rig of disparity.pfm, left_rectified.png and right_rectified.png"
            files["rig_rectified.toml"] = write_rig(result.dense.rig, comment=comment).encode()
    return files


def matches_table(result: PairMeasurement) -> pd.DataFrame:
    """One row a trusted match, patches before corners."""
    tables = []
    for matches in result.matches:
        table = pd.DataFrame(
            {
                "kind": matches.kind,
                "u_left_px": matches.uv_left[:, 0],
                "v_left_px": matches.uv_left[:, 1],
                "u_right_px": matches.uv_right[:, 0],
                "v_right_px": matches.uv_right[:, 1],
                "disparity_px": matches.disparity_px,
                "disparity_std_px": matches.disparity_std_px,
                "epipolar_px": matches.epipolar_px,
                "score": matches.score,
                "x_mm": 1e3 * matches.points_left[:, 0],
                "y_mm": 1e3 * matches.points_left[:, 1],
                "z_mm": 1e3 * matches.points_left[:, 2],
                "depth_std_mm": 1e3 * matches.depth_std_m,
            }
        )
        if result.corners is not None:
            numbered = pd.Series(matches.board), pd.Series(matches.corner)
            table["board"], table["corner"] = (ids.astype("Int64").mask(ids < 0) for ids in numbered)
        if result.truth is not None:
            table["truth_px"] = matches.truth_px
            table["error_px"] = matches.disparity_px - matches.truth_px
            table["depth_error_mm"] = 1e3 * matches.depth_error_m
        tables.append(table)
    return pd.concat(tables, ignore_index=True)


def _matches(matches: PairMatches) -> dict[str, object]:
    errors = matches.errors
    judged = _errors(None if errors is None else errors.errors)
    # every match has a disparity: how many are missing is no question here
    for key in ("n", "invalid_pct", "fill_pct"):
        del judged[key]
    return {
        "n": matches.n,
        "n_tried": matches.n_tried,
        "valid_pct": _number(100.0 * matches.n / matches.n_tried),
        "epipolar_rms_px": _number(matches.epipolar_rms_px),
        "predicted_std_px": _number(matches.predicted_std_px),
        "predicted_rms_px": _number(matches.predicted_rms_px),
        "noise_px": _number(matches.noise_px),
        "depth_median_mm": _median(1e3 * matches.points_left[:, 2]),
        "predicted_depth_std_mm": _median(1e3 * matches.depth_std_m),
        "n_truth": None if errors is None else errors.errors.n,
        **judged,
        "outlier_pct": None if errors is None else _number(errors.outlier_pct),
        "inlier_std_px": None if errors is None else _number(errors.inlier_std_px),
        "within_3_std_pct": None if errors is None else _number(errors.within_3_std_pct),
    }


def _boards(result: PairMeasurement) -> list[dict[str, object]]:
    return [
        {
            "board": board.board,
            "n": board.n,
            "distance_mm": _number(1e3 * board.distance_m),
            "square_mm": _number(1e3 * board.square_m),
            "square_std_mm": _number(1e3 * board.square_std_m),
            "flatness_rms_mm": _number(1e3 * board.flatness_rms_m),
        }
        for board in result.boards
    ]


def _dense(dense: DenseMap) -> dict[str, object]:
    errors = dense.errors
    judged = _errors(None if errors is None else errors.regions["all"])
    if errors is None:
        judged["fill_pct"] = _number(dense.image_fill_pct)
    return {
        "matcher": dense.matcher,
        "rectified_first": dense.rectified,
        "image_fill_pct": _number(dense.image_fill_pct),
        **judged,
        "inlier_std_px": None if errors is None else _number(errors.inlier_std_px),
        "noise_px": None if errors is None else _number(errors.inlier_std_px / math.sqrt(2)),
        "regions": None if errors is None else {name: _errors(one) for name, one in errors.regions.items()},
        "phase": None
        if errors is None
        else {
            "amplitude_px": _number(errors.phase.amplitude_px),
            "phase_px": _numbers(errors.phase.phase_px),
            "mean_error_px": _numbers(errors.phase.mean_error_px),
            "count": [int(n) for n in errors.phase.count],
            "measured_count": [int(n) for n in errors.phase.measured_count],
        },
        "depth": None
        if errors is None
        else {key: _number(value) for key, value in asdict(errors.depth).items()},
    }


def _errors(errors: DisparityErrors | None) -> dict[str, object]:
    """The fields of `DisparityErrors` and the filled share; all null without errors."""
    names = [*DisparityErrors.__dataclass_fields__, "fill_pct"]
    return {name: None if errors is None else _number(getattr(errors, name)) for name in names}


def _rig(rig: StereoRig) -> dict[str, object]:
    return {
        "width_px": rig.left.width,
        "height_px": rig.left.height,
        "focal_px": rig.left.fx,
        "baseline_mm": clean(1e3 * rig.baseline_m),
        "doffs_px": rig.doffs_px,
        "rectified": rig.is_rectified,
    }


def _points_ply(result: PairMeasurement) -> bytes:
    points, std, colors = [], [], []
    for matches in result.matches:
        points.append(matches.points_left)
        std.append(matches.depth_std_m)
        at = np.round(matches.uv_left).astype(np.intp)
        colors.append(eight_bit(result.image_left)[at[:, 1], at[:, 0]])
    return ply_bytes(np.concatenate(points), depth_std_m=np.concatenate(std), colors=np.concatenate(colors))


def _cloud_ply(dense: DenseMap) -> bytes:
    points, known = dense.points_left()
    return ply_bytes(points, colors=eight_bit(dense.image_left)[known])


def _number(value: float) -> float | int | None:
    if isinstance(value, int | np.integer):
        return int(value)
    return float(value) if math.isfinite(value) else None


def _numbers(values: Array) -> list[float | int | None]:
    return [_number(float(value)) for value in values]


def _median(values: Array) -> float | int | None:
    known = values[np.isfinite(values)]
    return _number(float(np.median(known))) if len(known) else None
