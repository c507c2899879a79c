"""The columns of matches.csv, each once: name, heading, unit, format and meaning."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rigsim.study.scene.column import Column, ColumnList

_TABLE = ColumnList()

KIND = _TABLE.put(
    Column(
        "kind",
        "kind",
        "",
        "text",
        "What was matched: patches or corners.",
        empty=False,
        words=("patches", "corners"),
    )
)
U_LEFT = _TABLE.add("u_left_px", "u left", "px", "number", "Column in the left picture, px.", empty=False)
V_LEFT = _TABLE.add("v_left_px", "v left", "px", "number", "Row in the left picture, px.", empty=False)
U_RIGHT = _TABLE.add("u_right_px", "u right", "px", "number", "Column in the right picture, px.", empty=False)
V_RIGHT = _TABLE.add("v_right_px", "v right", "px", "number", "Row in the right picture, px.", empty=False)
DISPARITY = _TABLE.add(
    "disparity_px", "disparity", "px", "number", "`u_left_px - u_right_px`, px.", empty=False
)
DISPARITY_STD = _TABLE.add(
    "disparity_std_px",
    "disparity std",
    "px",
    "number",
    "Standard deviation that the match claims for it, px.",
    empty=False,
)
EPIPOLAR = _TABLE.add(
    "epipolar_px",
    "epipolar residual",
    "px",
    "number",
    "How far below its epipolar line the match lies in the right picture, px; empty where the patch does not"
    " tell.",
)
SCORE = _TABLE.add(
    "score", "correlation", "", "ratio", "Correlation of the patches, -1 to 1; empty for corners."
)
X = _TABLE.add("x_mm", "X", "mm", "number", "Right of the left camera, mm; empty as Z.")
Y = _TABLE.add("y_mm", "Y", "mm", "number", "Below the left camera, mm; empty as Z.")
Z = _TABLE.add(
    "z_mm",
    "Z",
    "mm",
    "number",
    "In front of the left camera, mm; empty where the rays do not meet in front of both cameras.",
)
DEPTH_STD = _TABLE.add(
    "depth_std_mm", "depth std", "mm", "number", "Standard deviation that the match claims for Z, mm."
)
# with --board
BOARD = _TABLE.add(
    "board", "board", "", "count", "Which board, counted from the left; empty for patches. With boards only."
)
CORNER = _TABLE.add(
    "corner",
    "corner",
    "",
    "count",
    "Which corner of its board, row by row; empty for patches. With boards only.",
)
# with --truth
TRUTH = _TABLE.add(
    "truth_px",
    "true disparity",
    "px",
    "number",
    "True disparity there, px; empty where unknown. With a truth only.",
)
ERROR = _TABLE.add(
    "error_px", "disparity error", "px", "number", "Disparity minus the true one, px. With a truth only."
)
DEPTH_ERROR = _TABLE.add(
    "depth_error_mm",
    "depth error",
    "mm",
    "number",
    "Depth minus the depth of the true disparity, mm. With a truth only.",
)

COLUMNS: Mapping[str, Column] = MappingProxyType({column.name: column for column in _TABLE.columns})
"""All of them, by name, in the order of the file; a row is one trusted match."""
