"""Standard errors of the numbers of a row, from what the row says of itself."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from rigsim.study.golden.kinds import Kind

_CI_95 = 2 * 1.959964
_CI_99 = 2 * 2.575829
_TWICE = frozenset(("depth_abs_p50_mm", "depth_abs_p95_mm", "measured_depth_abs_p95_mm", "nees"))
"""What scatters up to twice as much as an RMS of the same errors, relative to itself."""
_RATIOS = frozenset(("predicted_over_simulated", "nees"))
"""What does not depend on where the points lie."""
_BIASES = {"depth_bias_mm": "depth_rmse_mm", "measured_depth_bias_mm": "measured_depth_rmse_mm"}
"""A mean, and the RMS of the same errors, by which it scatters."""
_PER_PIXEL = frozenset(("depth_rmse_image_mm", "predicted_depth_rmse_image_mm"))
"""What few far points carry."""
_UNKNOWN = 0.01
"""Relative standard error where neither an interval nor a count is known."""


def standard_error(kind: Kind, key: str, value: float, row: Mapping[str, Any]) -> float:
    """The standard error of `value`, which stands in `row` under `key`; 0 for what is no statistic.

    A row's own are taken where it has them: ``KEY_se``, and the intervals of the RMS and of the measured
    scale. Another seed draws other points as well: an RMS over N of them then scatters by 1/sqrt(N) more.
    """
    own = _number(row, f"{key}_se")
    if kind in ("exact", "label", "finding", "left out") or not math.isfinite(value):
        return 0.0
    if math.isfinite(own):
        return own
    if kind == "count":
        return math.sqrt(abs(value) + 1)
    if kind == "share":
        return _of_share(key, value, row)
    relative = _measured(row) if kind == "measured" else _simulated(key, row)
    if key in _BIASES:
        # of n errors alike, the mean scatters by RMS / sqrt(n), the RMS by RMS / sqrt(2 n)
        return math.sqrt(2) * relative * abs(_number(row, _BIASES[key], value))
    return relative * abs(value) * (2 if key in _TWICE or key in _PER_PIXEL else 1)


def _of_share(key: str, share: float, row: Mapping[str, Any]) -> float:
    percent = 100.0 if key.endswith("_pct") else 1.0
    counted = "measured_n" if key.startswith("measured") else "n_points"
    n = _number(row, f"{key}_rigs", _number(row, counted, _number(row, "rigs", 1 / _UNKNOWN)))
    near = (share / percent * n + 1) / (n + 2)
    return percent * math.sqrt(max(near * (1 - near), 0.0) / max(n, 1.0))


def _simulated(key: str, row: Mapping[str, Any]) -> float:
    low, high, rms = (
        _number(row, name) for name in ("depth_rmse_ci_low_mm", "depth_rmse_ci_high_mm", "depth_rmse_mm")
    )
    noise = (high - low) / _CI_95 / rms if math.isfinite(high - low) and rms > 0 else math.nan
    n = _number(row, "n_visible", _number(row, "points_n", _number(row, "rigs")))
    points = 1 / math.sqrt(n) if n > 0 else math.nan
    if not math.isfinite(noise):
        return points if math.isfinite(points) else _UNKNOWN
    return noise if key in _RATIOS or not math.isfinite(points) else math.hypot(noise, points)


def _measured(row: Mapping[str, Any]) -> float:
    low, high, scale = (
        _number(row, name) for name in ("measured_scale_ci_low", "measured_scale_ci_high", "measured_scale")
    )
    n = _number(row, "measured_n")
    count = 1 / math.sqrt(n) if n > 0 else _UNKNOWN
    interval = (high - low) / _CI_99 / scale if math.isfinite(high - low) and scale > 0 else 0.0
    return max(count, interval)


def _number(row: Mapping[str, Any], key: str, otherwise: float = math.nan) -> float:
    value = row.get(key)
    plain = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if plain and value is not None and math.isfinite(value) else otherwise
