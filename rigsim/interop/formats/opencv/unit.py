"""The unit of a file's lengths, where the file says it or states the baseline a second time."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from rigsim.interop.formats.kit.reading import metres
from rigsim.interop.formats.opencv.names import LENGTH_UNITS, Facts
from rigsim.rig.arrays import Array
from rigsim.rig.remark import Remark

_UNITS_M: Mapping[str, float] = MappingProxyType({"mm": 1e-3, "cm": 1e-2, "m": 1.0})
_SAID = {unit: unit for unit in ("m", "cm", "mm", "in")} | {
    "meter": "m",
    "metre": "m",
    "millimeter": "mm",
    "millimetre": "mm",
    "centimeter": "cm",
    "centimetre": "cm",
    "inch": "in",
    "inche": "in",
}
_SAME = 0.01
"""Share by which a stated baseline, often rounded, may differ from T."""
_SHORT_M, _LONG_M = 1e-2, 1.0
"""Baselines that most rigs have, m."""


def unit_of(facts: Facts, t: Array) -> tuple[str | None, tuple[Remark, ...]]:
    """The unit of T's numbers, as `--rig-unit` takes it, and what is to be said.

    A stated baseline decides where T has its length in one unit alone; the side of a board's squares where
    no other reading is a baseline of 10 mm to 1 m.

    Args:
        facts: what the file says.
        t: (3,), T as it stands there.
    """
    stated = next(iter(_lengths(facts, "baseline")), None)
    squares = [(key, value, of) for key, value, of in _lengths(facts, "square") if of and 1e-3 <= value < 1e5]
    word = str(facts.value("unit")).strip().lower()
    unit = _SAID.get(word.removesuffix("s") if len(word) > 2 else word)
    if stated is not None:
        return _by_baseline(stated, t, squares, unit)
    if unit is not None or not squares:
        return unit, ()
    key, value, of = squares[0]
    length = float(np.linalg.norm(t))
    readings = dict.fromkeys((of, "m", f"{value:.9g}{of}"))
    likely = [one for one in readings if _SHORT_M <= length * metres(one) <= _LONG_M]
    if len(likely) != 1:
        return None, ()
    (unit,) = likely
    mm = length * metres(unit) * 1e3
    text = (
        f"T is taken to be in {unit}, as beside {key} {value:g} nothing else makes a usual baseline:"
        f" {mm:.4g} mm; if it is in another unit, say --rig-unit"
    )
    return unit, () if unit == "m" else (Remark("unit_said", text),)


def _by_baseline(
    stated: tuple[str, float, str], t: Array, squares: list[tuple[str, float, str]], unit: str | None
) -> tuple[str | None, tuple[Remark, ...]]:
    key, value, of = stated
    lengths = (float(np.linalg.norm(t)), float(np.abs(t).max()))
    own = (of,) if of else tuple(_UNITS_M)
    sides = [f"{side:.9g}{of_side}" for _, side, of_side in squares]
    fit = {
        one: other
        for other in own
        for one in (*_UNITS_M, *sides, *([] if unit is None else [unit]))
        if any(_near(length * metres(one), value * _UNITS_M[other]) for length in lengths)
    }
    if not fit or (unit is not None and unit not in fit):
        tried = "mm, cm and m" if unit is None else unit
        text = (
            f"{key} {value:g} differs from the length {lengths[0]:.4g} of T in {tried}: T is taken; one of"
            " the two is of another calibration, or in another unit"
        )
        return unit, (Remark("baseline_differs", text),)
    if unit is not None or len(fit) != 1:
        return unit, ()  # said, or the same number of an unknown unit twice
    ((found, other),) = fit.items()
    text = f"T is in {found}: so it has the length {value:g} {other} that the file states as {key}"
    return found, () if found == "m" else (Remark("unit_said", text),)


def _lengths(facts: Facts, role: str) -> list[tuple[str, float, str]]:
    """Key, value and unit, empty where the key has none, of what the file says of a length."""
    found = []
    for of in (*LENGTH_UNITS, ""):
        own = f"{role}_{of}" if of else role
        value = facts.value(own)
        if isinstance(value, int | float) and np.isfinite(value) and value:
            found.append((facts.key(own), abs(float(value)), of))
    return found


def _near(one: float, other: float) -> bool:
    return abs(one - other) <= _SAME * other
