"""Tolerances as people type them: ``yaw=0.05deg``, ``baseline=+-0.3``."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from types import MappingProxyType
from typing import Annotated

import typer

from rigsim.errors import InvalidRange
from rigsim.typed import quantity

ToleranceWord = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=VALUE",
        help="One tolerance, in place of the class's: yaw, pitch, roll (deg), baseline, axial, vertical"
        " (mm), focal, focal-left, focal-both, principal, principal-v, principal-left, principal-left-v"
        " (px), k1-right, k1-left, k1-both, time (ms), temperature (K). One standard deviation, or a"
        " bound as +-VALUE. Repeatable.",
    ),
]

MaxRowError = Annotated[
    str | None,
    typer.Option(
        metavar="PX",
        help="Largest row misalignment of one rig's rectified pair as well, root mean square over the image,"
        " at every distance of the range: 0.5px, for a matcher that searches along rows.",
    ),
]

_ANGLES = quantity.YAW.factors
_LENGTHS = quantity.BASELINE.factors
_PIXELS = quantity.NOISE.factors
_PLAIN = MappingProxyType({"": Fraction(1)})
_TIMES = quantity.TIMES

_ROW_ERROR = quantity.QuantityKind("row error", "px", _PIXELS, above=0)


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
