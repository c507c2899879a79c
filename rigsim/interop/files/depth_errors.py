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
_UNITS_MM = {"_mm": 1.0, "_cm": 10.0, "_m": 1e3}
_OTHER_NAMES = {"z": "distance"}
_SHORTEST_MM = 100.0
"""A shorter distance without a unit may be in metres."""


def read_depth_errors(path: Path) -> ErrorsByDistance:
    """The depth errors in the CSV file `path`: ``distance_mm, depth_std_mm[, depth_bias_mm][, n]``.

    A name's ending says the unit: ``_mm``, ``_cm`` or ``_m``. The distance may be called z, and be in mm
    without an ending. Other columns are ignored.

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
    written = [name.strip() for name in rows[0][1]] if rows else []
    head, scales = _known(written, str(path))
    for name in _NEEDED:
        if name not in head:
            found = clipped(", ".join(written)) or "nothing"
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
            number = _number(cell, written[place], f"{path}, line {line}")
            _check(number, name, written[place], cell, f"{path}, line {line}")
            values.append(number * scales.get(name, 1.0))
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


def _known(written: list[str], where: str) -> tuple[list[str], dict[str, float]]:
    """The columns under the names that are known, and the unit, mm, of those that are lengths.

    Raises:
        InvalidRange: two columns say the same.
    """
    head: list[str] = []
    scales: dict[str, float] = {}
    for name in written:
        base, ending, unit = name.lower().rpartition("_")
        ending += unit
        if ending not in _UNITS_MM:
            base, ending = name.lower(), "_mm" if name.lower() in ("distance", *_OTHER_NAMES) else ""
        known = f"{_OTHER_NAMES.get(base, base)}_mm" if ending else base
        if known in (*_NEEDED, *_OPTIONAL):
            if known in head:
                both = f"{written[head.index(known)]} and {name}"
                raise InvalidRange(f"{where}: columns {both} say the same; leave one")
            if ending:
                scales[known] = _UNITS_MM[ending]
        head.append(known)
    return head, scales


def _number(cell: str, name: str, where: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InvalidRange(f"{where}: {name} {cell or 'empty'}: must be a number")
    return value


def _check(value: float, name: str, written: str, cell: str, where: str) -> None:
    """Refuse a number that the column called `name` cannot hold."""
    if name in _NEEDED and value <= 0:
        raise InvalidRange(f"{where}: {written} {cell}: must be > 0")
    if name == "n" and not (value >= 2 and value.is_integer()):
        raise InvalidRange(f"{where}: n {cell}: must be a whole number >= 2")
    if written.lower() in ("distance", *_OTHER_NAMES) and value < _SHORTEST_MM:
        raise InvalidRange(
            f"{where}: {written} {cell}: metres or millimetres? Call the column {written}_m or {written}_mm"
        )
