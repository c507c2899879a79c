"""Depth errors as files: a wall test's CSV in, and what was inferred from it as a document."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rigsim import foreign
from rigsim.errors import InvalidRange, OutputError
from rigsim.interop.values import clipped
from rigsim.rig import extent
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.study.infer import CONFIDENCE, FEWEST, DepthErrors, Inference, Transfer
from rigsim.study.infer_words import sentence

_NEEDED = ("distance_mm", "depth_std_mm")
_OPTIONAL = ("depth_bias_mm", "n")


def read_depth_errors(path: Path) -> DepthErrors:
    """The depth errors in the CSV file `path`: ``distance_mm, depth_std_mm[, depth_bias_mm][, n]``.

    Other columns are ignored.

    Raises:
        OutputError: the file cannot be read.
        InvalidRange: a column is missing, a value is no number or out of bounds, or there are fewer than
            three distances; the message names file, line and column.
    """
    try:
        text = foreign.read_text(path, "a CSV file")
    except UnicodeDecodeError:
        raise OutputError(f"{path}: is not CSV (not UTF-8 text)") from None
    try:
        reader = csv.reader(text.splitlines())
        # every row at once: what the reader cannot split is found here
        rows = [(reader.line_num, row) for row in reader]
    except csv.Error as error:
        raise InvalidRange(f"{path}: is no CSV that can be meant: {error}") from None
    extent.DISTANCES.check(max(1, len(rows)))
    head = [name.strip() for name in rows[0][1]] if rows else []
    for name in _NEEDED:
        if name not in head:
            found = clipped(", ".join(head)) or "nothing"
            raise InvalidRange(
                f"{path}: column {name} is missing (found {found}); the first line must name"
                f" {', '.join(_NEEDED)}, and may name {', '.join(_OPTIONAL)}"
            )
    columns: dict[str, list[float]] = {name: [] for name in (*_NEEDED, *_OPTIONAL) if name in head}
    for line, row in rows[1:]:
        if not any(cell.strip() for cell in row):
            continue
        for name, values in columns.items():
            place = head.index(name)
            cell = row[place].strip() if place < len(row) else ""
            values.append(_number(cell, name, f"{path}, line {line}"))
    count = len(columns["distance_mm"])
    if count < FEWEST:
        raise InvalidRange(
            f"{path}: {count} distance(s), must be >= {FEWEST} to tell a law from chance; measure at more"
            " distances, or give them by --claim, which takes fewer and leaves the law untested"
        )
    biases, counts = columns.get("depth_bias_mm"), columns.get("n")
    return DepthErrors(
        np.array(columns["distance_mm"]) / 1e3,
        np.array(columns["depth_std_mm"]) / 1e3,
        None if biases is None else np.array(biases) / 1e3,
        None if counts is None else np.array(counts),
    )


def inference_document(
    inference: Inference, carried: Transfer | None = None, remarks: Sequence[Remark] = ()
) -> dict[str, object]:
    """The document that ``rigsim infer --json`` prints; docs/infer.md describes it."""
    fit, bias, errors = inference.fit, inference.bias, inference.errors
    sigma = inference.disparity_std_px
    return {
        "disparity_std_px": sigma,
        "disparity_std_ci_low_px": _finite(inference.low_px),
        "disparity_std_ci_high_px": _finite(inference.high_px),
        "confidence_level": CONFIDENCE,
        "interval_from": inference.interval_from,
        "noise_px": sigma / math.sqrt(2),
        "verdict": inference.verdict,
        "says": sentence(inference),
        "fit": None
        if fit is None
        else {
            "best": fit.best,
            "exponent": fit.exponent,
            "exponent_ci_low": fit.exponent_low,
            "exponent_ci_high": fit.exponent_high,
            **{f"{law}_misfit_pct": 100 * misfit for law, misfit in fit.misfit.items()},
        },
        "bias": None
        if bias is None
        else {
            "disparity_offset_px": bias.disparity_offset_px,
            "disparity_offset_se_px": _finite(bias.disparity_offset_se_px),
            "disparity_offset_ci_low_px": _finite(bias.offset_interval_px[0]),
            "disparity_offset_ci_high_px": _finite(bias.offset_interval_px[1]),
            "scale_pct": _finite(100 * bias.scale),
            "scale_se_pct": _finite(100 * bias.scale_se),
            "scale_ci_low_pct": _finite(100 * bias.scale_interval[0]),
            "scale_ci_high_pct": _finite(100 * bias.scale_interval[1]),
            "left_rms_mm": bias.left_rms_m * 1e3,
            "share_of_mean_square_pct": 100 * bias.share,
        },
        "rig": _rig(inference.rig),
        "rows": [
            {
                "distance_mm": float(depth) * 1e3,
                "depth_std_mm": float(std) * 1e3,
                "explained_depth_std_mm": float(sigma * gain) * 1e3,
                "disparity_std_px": float(std / gain),
            }
            for depth, std, gain in zip(errors.depths_m, errors.stds_m, inference.gains_m_per_px, strict=True)
        ],
        "transfer": None
        if carried is None
        else {
            "rig": _rig(carried.rig),
            "rows": [
                {
                    "distance_mm": float(carried.depths_m[i]) * 1e3,
                    "depth_std_mm": float(carried.stds_m[i]) * 1e3,
                    "depth_std_ci_low_mm": _finite(float(carried.lows_m[i]) * 1e3),
                    "depth_std_ci_high_mm": _finite(float(carried.highs_m[i]) * 1e3),
                    "trusted": bool(carried.trusted[i]),
                }
                for i in range(len(carried.depths_m))
            ],
        },
        "remarks": [{"code": remark.code, "text": remark.text} for remark in remarks],
    }


def _rig(rig: StereoRig) -> dict[str, object]:
    return {
        "baseline_mm": rig.baseline_m * 1e3,
        "focal_px": rig.left.fx,
        "width_px": rig.left.width,
        "height_px": rig.left.height,
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _number(cell: str, name: str, where: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InvalidRange(f"{where}: {name} {cell or 'empty'}: must be a number")
    if name in _NEEDED and value <= 0:
        raise InvalidRange(f"{where}: {name} {cell}: must be > 0")
    if name == "n" and not (value >= 2 and value.is_integer()):
        raise InvalidRange(f"{where}: n {cell}: must be a whole number >= 2")
    return value
