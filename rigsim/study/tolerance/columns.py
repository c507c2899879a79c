"""The columns of tolerance.csv, each once: name, heading, unit, format and meaning.

Between `HEAD` and `REST` the file has a depth error for each distance, the document one list of them. A
heading breaks into lines at its newlines where a table is narrow.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rigsim.study.scene.column import Column, ColumnList

_HEAD, _REST = ColumnList(), ColumnList()

QUANTITY = _HEAD.add(
    "quantity", "quantity", "", "text", "What it is; the name ends in its unit.", empty=False
)
UNIT = _HEAD.add("unit", "unit", "", "text", "Its unit; empty for a plain number.", empty=False)
TOLERANCE = _HEAD.add(
    "tolerance", "std or ±", "", "number", "How tightly it is held, in that unit.", empty=False
)
FORM = _HEAD.put(
    Column(
        "form",
        "form",
        "",
        "text",
        "Whether that is one standard deviation or a bound.",
        empty=False,
        words=("std", "bound"),
    )
)
SOURCE = _HEAD.add("source", "source", "", "text", "Where the tolerance comes from.", empty=False)

COMMON = _REST.add(
    "common_mm",
    "common",
    "mm",
    "number",
    "At the required distance, what all the image has in common, mm; signed, for a positive deviation.",
    empty=False,
)
DIFFERING = _REST.add(
    "differing_mm",
    "varies across\nthe image",
    "mm",
    "number",
    "At the required distance, what varies across the image, mm.",
    empty=False,
)
VARIANCE_SHARE = _REST.add(
    "variance_share",
    "share",
    "",
    "percent",
    "Its share of the mean squared depth error there, 0 to 1.",
    empty=False,
)
ROW = _REST.add(
    "row_px",
    "rows",
    "px",
    "number",
    "RMS row misalignment over the image that it makes alone at the required distance, px, of the pair\n"
    "rectified by the assumed calibration; null where no rows correspond.",
)
ROW_LARGEST = _REST.add(
    "row_largest_px",
    "rows,\nlargest",
    "px",
    "number",
    "The largest of that over the distances, px.",
)


def _sobol(name: str, heading: str, first: str) -> dict[str, str]:
    """Four columns of indices, by their names in `SobolIndices`."""
    error = "Its standard error."
    total = "Total Sobol index of the same."
    return {
        "first": _REST.add(f"{name}_first", f"{heading},\nalone", "", "percent", first),
        "first_se": _REST.add(f"{name}_first_se", f"{heading}, alone, error", "", "percent", error),
        "total": _REST.add(f"{name}_total", f"{heading}, with\nothers", "", "percent", total),
        "total_se": _REST.add(f"{name}_total_se", f"{heading}, with others, error", "", "percent", error),
    }


_INDEX = "First-order Sobol index of a rig's {} depth error; null where a rig loses a point or not asked."
SOBOL = _sobol("sobol", "Sobol", _INDEX.format("RMS"))
SOBOL_BIAS = _sobol("sobol_bias", "Sobol, bias", _INDEX.format("mean"))

NEEDED_ALONE = _REST.add(
    "needed_alone",
    "needed\nalone",
    "",
    "number",
    "Tolerance with which 95 of 100 rigs meet it with their noise when nothing else is off, in its unit;\n"
    "null when any does, 0 where noise alone is too much.",
)
NEEDED_EQUAL_SHARE = _REST.add(
    "needed_equal_share",
    "equal\nshares",
    "",
    "number",
    "The same when every quantity takes an equal part of the variance, all at once; null when any does.",
)

HEAD: tuple[Column, ...] = tuple(_HEAD.columns)
"""What a quantity is and is held to."""
REST: tuple[Column, ...] = tuple(_REST.columns)
"""What it does to the depth, and what it takes."""
COLUMNS: Mapping[str, Column] = MappingProxyType({column.name: column for column in (*HEAD, *REST)})
"""All of them, by name."""


def at_distance(distance_mm: float) -> Column:
    """The column of the depth errors at one distance."""
    return Column(
        f"depth_error_at_{distance_mm:.10g}_mm",
        f"at\n{distance_mm / 1e3:.10g} m",
        "mm",
        "number",
        "RMS depth error that it makes alone at this distance, mm.",
        empty=False,
    )
