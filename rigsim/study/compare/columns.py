"""The columns of compare.csv, each once: name, heading, unit, format and meaning.

A heading breaks into lines at its newlines where a table is narrow.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rigsim.study.scene.column import Column, ColumnList

_TABLE = ColumnList()

# what a row is about
GEOMETRY = _TABLE.add("geometry", "geometry", "", "text", "Name of the geometry.", empty=False)
NOISE = _TABLE.put(
    Column(
        "noise_px",
        "pixel noise",
        "px",
        "short",
        "Standard deviation of every pixel coordinate, px.",
        empty=False,
        above=0,
    )
)
TRIANGULATOR = _TABLE.add(
    "triangulator", "triangulator", "", "text", "Name of the triangulator.", empty=False
)

# how many points come back
N = _TABLE.add("n", "points", "", "count", "Points that were asked for.", empty=False)
FAILED_SHARE = _TABLE.add(
    "failed_share", "lost", "", "percent", "Share of them that came back as NaN, 0 to 1.", empty=False
)
EXPECTED_FAILED_SHARE = _TABLE.add(
    "expected_failed_share",
    "expected",
    "",
    "percent",
    "Share whose parallax the noise turns negative, 0 to 1.",
    empty=False,
)
EXPECTED_FAILED_SHARE_SE = _TABLE.add(
    "expected_failed_share_se",
    "expected, error",
    "",
    "percent",
    "Standard error of what is seen of that share.",
    empty=False,
)

# how far off they are, in pixels
PIXEL_ERROR = _TABLE.add(
    "pixel_error_px",
    "pixel error",
    "px",
    "number",
    "RMS length of the error in the four projected coordinates, px; null when no point came back.",
)
PIXEL_BOUND = _TABLE.add(
    "pixel_bound_px",
    "pixel bound",
    "px",
    "number",
    "The same of the best unbiased triangulator, px.",
    empty=False,
)
PIXEL_ERROR_OVER_BOUND = _TABLE.add(
    "pixel_error_over_bound", "pixel error\nover bound", "", "ratio", "Their ratio."
)
PIXEL_ERROR_OVER_BOUND_SE = _TABLE.add(
    "pixel_error_over_bound_se",
    "pixel error over bound, error",
    "",
    "ratio",
    "Its standard error, from these points.",
)
BOUND_SE = _TABLE.add(
    "bound_se",
    "bound, error",
    "",
    "ratio",
    "Standard error that the ratio has at the bound.",
    empty=False,
)
PIXEL_ERROR_OVER_FIRST = _TABLE.add(
    "pixel_error_over_first",
    "over\nfirst",
    "",
    "ratio",
    "Pixel error over that of the first triangulator, over points that both found.",
)
PIXEL_ERROR_OVER_FIRST_SE = _TABLE.add(
    "pixel_error_over_first_se",
    "over first, error",
    "",
    "ratio",
    "Its standard error; the noise is the same for both.",
)

# and in depth
DEPTH_ERROR_OVER_BOUND = _TABLE.add(
    "depth_error_over_bound", "depth error over bound", "", "ratio", "RMS error of 1/Z over its bound."
)
DEPTH_BIAS = _TABLE.add(
    "depth_bias_over_std",
    "bias",
    "",
    "number",
    "Mean error of 1/Z in predicted standard deviations, positive when too far.",
)
DEPTH_BIAS_SE = _TABLE.add("depth_bias_over_std_se", "bias, error", "", "number", "Its standard error.")
EXPECTED_DEPTH_BIAS = _TABLE.add(
    "expected_depth_bias_over_std",
    "expected bias",
    "",
    "number",
    "What lost points leave of it: those that come back are the nearer ones.",
    empty=False,
)
DEPTH_MEDIAN_ABS = _TABLE.add(
    "depth_median_abs_mm", "median depth error", "mm", "number", "Median size of the depth error, mm."
)

# how fast
POINTS_PER_SECOND = _TABLE.add(
    "points_per_second",
    "points/s",
    "1/s",
    "number",
    "Median speed, points/s; null when it could not be timed.",
)
SPEED_OVER_FIRST = _TABLE.add(
    "speed_over_first", "over\nfirst", "", "ratio", "Speed over that of the first triangulator."
)

COLUMNS: Mapping[str, Column] = MappingProxyType({column.name: column for column in _TABLE.columns})
"""All of them, by name, in the order of the file; a row is one triangulator in one geometry at one noise
level."""
