"""Depth errors as files: a wall test's CSV in, and what was inferred from it as a document."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np

from rigsim import foreign
from rigsim.errors import InvalidRange, OutputError
from rigsim.interop.formats.values import clipped
from rigsim.rig import extent
from rigsim.study.infer.run import FEWEST, ErrorsByDistance

_NEEDED = ("distance_mm", "depth_std_mm")
_OPTIONAL = ("depth_bias_mm", "n")


def read_depth_errors(path: Path) -> ErrorsByDistance:
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
        raise InvalidRange(f"{path}: is not valid CSV: {error}") from None
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
    return ErrorsByDistance(
        np.array(columns["distance_mm"]) / 1e3,
        np.array(columns["depth_std_mm"]) / 1e3,
        None if biases is None else np.array(biases) / 1e3,
        None if counts is None else np.array(counts),
    )


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
