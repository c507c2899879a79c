"""The third witness in the tables: what was measured, and which noise it corresponds to."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from rigsim.present.kit.format import count, number
from rigsim.rig.arrays import Array
from rigsim.study.scene import columns as col

METHODS: dict[str, str] = {
    "corners": "board corners",
    "patches": "matched patches",
    "dense": "dense disparities",
}
"""What a measurement looks for, by its name on the command line."""


def was_measured(table: pd.DataFrame) -> bool:
    """Whether anything was found in the pictures of any row."""
    return bool((table[col.MEASURED_N] > 0).any())


def equivalent_noise_px(table: pd.DataFrame) -> Array:
    """The `--noise` (N,) px that the measured disparity noise of each row corresponds to."""
    return np.asarray(table[col.MEASURED_DISPARITY_STD], dtype=np.float64) / math.sqrt(2)


def noise_value(row: Mapping[Any, Any]) -> str:
    """The `--noise` that a row's measured disparity noise corresponds to, as it is typed; "" if unknown."""
    std_px = float(row[col.MEASURED_DISPARITY_STD])
    return f"{std_px / math.sqrt(2):.2g}" if 0 < std_px < math.inf else ""


def method_words(row: Mapping[Any, Any]) -> str:
    """What was looked for in the pictures: ``board corners``."""
    method = str(row[col.MEASURED_METHOD])
    return METHODS.get(method, method)


def equivalent_noise_words(row: Mapping[Any, Any]) -> str:
    """Which `--noise` the measurement corresponds to, as a sentence; "" when it is not known."""
    value = noise_value(row)
    if not value:
        return ""
    return f"What was measured in renderings ({method_words(row)}) corresponds to `--noise {value}`."


def found_words(row: Mapping[Any, Any]) -> str:
    """How many were found, and the share that was wrong: ``312, 0.4 % of them outliers``."""
    n, share = float(row[col.MEASURED_N]), float(row[col.MEASURED_OUTLIER_FRACTION])
    if not n > 0:
        return "none found"
    return count(n) + (f", {number(100 * share, 2)} % outliers" if share > 0 else ", no outliers")
