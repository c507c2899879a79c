"""Tolerances and what a built rig is held to, as people type them: ``yaw=0.05deg``, ``baseline=+-0.3``."""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from types import MappingProxyType

from rigsim.errors import InvalidRange
from rigsim.typed import quantity

_ANGLES = quantity.YAW.factors
_LENGTHS = quantity.BASELINE.factors
_PIXELS = quantity.NOISE.factors
_PLAIN = MappingProxyType({"": Fraction(1)})
_TIMES = quantity.TIMES

_ROW_ERROR = quantity.QuantityKind("row error", "px", _PIXELS, above=0)
_DEPTH_ERROR = quantity.QuantityKind("depth error", "mm", _LENGTHS, above=0)
_PERCENT = re.compile(r"\s*([0-9]*\.?[0-9]+)\s*%\s*")
_UNIT = re.compile(r"[a-zA-Zµμ%]\s*$")


def _kind(name: str, unit: str, factors: Mapping[str, Fraction]) -> quantity.QuantityKind:
    return quantity.QuantityKind(f"tolerance {name}", unit, factors, at_least=0)


_KINDS: dict[str, tuple[str, quantity.QuantityKind]] = {
    "yaw": ("yaw_deg", _kind("yaw", "deg", _ANGLES)),
    "pitch": ("pitch_deg", _kind("pitch", "deg", _ANGLES)),
    "roll": ("roll_deg", _kind("roll", "deg", _ANGLES)),
    "baseline": ("baseline_mm", _kind("baseline", "mm", _LENGTHS)),
    "axial": ("axial_mm", _kind("axial", "mm", _LENGTHS)),
    "vertical": ("vertical_mm", _kind("vertical", "mm", _LENGTHS)),
    "focal": ("right_focal_px", _kind("focal", "px", _PIXELS)),
    "focal-both": ("both_focal_px", _kind("focal-both", "px", _PIXELS)),
    "principal": ("right_cx_px", _kind("principal", "px", _PIXELS)),
    "principal-v": ("right_cy_px", _kind("principal-v", "px", _PIXELS)),
    "k1-right": ("right_k1", _kind("k1-right", "", _PLAIN)),
    "k1-both": ("both_k1", _kind("k1-both", "", _PLAIN)),
    "focal-left": ("left_focal_px", _kind("focal-left", "px", _PIXELS)),
    "principal-left": ("left_cx_px", _kind("principal-left", "px", _PIXELS)),
    "principal-left-v": ("left_cy_px", _kind("principal-left-v", "px", _PIXELS)),
    "k1-left": ("left_k1", _kind("k1-left", "", _PLAIN)),
    "time": ("time_offset_ms", _kind("time", "ms", _TIMES)),
    "temperature": ("temperature_k", _kind("temperature", "K", {"K": Fraction(1)})),
}


def row_error(text: str | None) -> float | None:
    """The largest row misalignment, px; None for any."""
    return None if text is None else quantity.value(text, _ROW_ERROR)


def tolerance_values(words: list[str]) -> tuple[dict[str, float], set[str]]:
    """The tolerances given, and which of them are bounds."""
    found: dict[str, float] = {}
    bounds: set[str] = set()
    for word in words:
        name, equals, text = word.partition("=")
        if name.strip() not in _KINDS:
            raise InvalidRange(f"tolerance {name.strip() or 'empty'!r}: choose one of {', '.join(_KINDS)}")
        if not equals:
            raise InvalidRange(f"tolerance {name.strip()}: must be NAME=VALUE, as in yaw=0.05deg")
        key, kind = _KINDS[name.strip()]
        if key in found:
            raise InvalidRange(f"tolerance {name.strip()}: given twice; remove one")
        plain = text.strip().removeprefix("±").removeprefix("+-")
        if plain != text.strip():
            bounds.add(key)
        found[key] = quantity.value(plain, kind)
    return found, bounds


def tolerance_range(text: str) -> tuple[float, float]:
    """Near and far end, m, of ``0.5:3m``.

    Raises:
        InvalidRange: no unit, or not two ends in order.
    """
    if not _UNIT.search(text):
        raise InvalidRange(f"range {text or 'empty'}: m or mm? Write the unit, as in 0.5:3m")
    near_mm, far_mm = quantity.span(text, quantity.DEPTH)
    return near_mm / 1e3, far_mm / 1e3


def tolerance_requirement(text: str) -> dict[str, float]:
    """``10mm@3m`` or ``1%``, as `rigsim.tolerance` takes it.

    Raises:
        InvalidRange: a unit is missing, or a value is out of bounds.
    """
    what, at, where = text.partition("@")
    for part in (what, where) if at else (what,):
        if not _UNIT.search(part):
            raise InvalidRange(f"depth error {text or 'empty'}: of what unit? Write it, as in 10mm@3m or 1%")
    there = {"at_m": quantity.value(where.strip(), quantity.DEPTH) / 1e3} if at else {}
    share = _PERCENT.fullmatch(what)
    if share is None:
        return {"depth_error_mm": quantity.value(what.strip(), _DEPTH_ERROR), **there}
    if not float(share[1]) < 100:
        raise InvalidRange(f"depth error {what.strip()}: must be < 100 %")
    return {"depth_error_pct": float(share[1]), **there}
