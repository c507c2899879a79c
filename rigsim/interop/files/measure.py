"""Files of a measured pair: tables, point clouds, the disparity."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from rigsim import foreign
from rigsim.errors import InvalidRange
from rigsim.interop.files.ply import ply_bytes
from rigsim.interop.files.tables import csv_bytes, json_bytes
from rigsim.interop.formats.middlebury import read_disparity
from rigsim.interop.formats.rig_toml import write_rig
from rigsim.pixels.dense.pfm import pfm_bytes
from rigsim.rig.arrays import Array
from rigsim.study.measure import columns as col
from rigsim.study.measure.result import DenseMap, PairMeasurement, eight_bit

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
                col.KIND: matches.kind,
                col.U_LEFT: matches.uv_left[:, 0],
                col.V_LEFT: matches.uv_left[:, 1],
                col.U_RIGHT: matches.uv_right[:, 0],
                col.V_RIGHT: matches.uv_right[:, 1],
                col.DISPARITY: matches.disparity_px,
                col.DISPARITY_STD: matches.disparity_std_px,
                col.EPIPOLAR: matches.epipolar_px,
                col.SCORE: matches.score,
                col.X: 1e3 * matches.points_left[:, 0],
                col.Y: 1e3 * matches.points_left[:, 1],
                col.Z: 1e3 * matches.points_left[:, 2],
                col.DEPTH_STD: 1e3 * matches.depth_std_m,
            }
        )
        if result.corners is not None:
            numbered = pd.Series(matches.board), pd.Series(matches.corner)
            table[col.BOARD], table[col.CORNER] = (ids.astype("Int64").mask(ids < 0) for ids in numbered)
        if result.truth is not None:
            table[col.TRUTH] = matches.truth_px
            table[col.ERROR] = matches.disparity_px - matches.truth_px
            table[col.DEPTH_ERROR] = 1e3 * matches.depth_error_m
        tables.append(table)
    return pd.concat(tables, ignore_index=True)


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
