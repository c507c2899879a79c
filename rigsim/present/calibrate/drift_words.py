"""What changes after a calibration, in words: so that nobody takes its std for the whole truth."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

from rigsim.present.kit.format import number, plain
from rigsim.study.calibrate.drift import Drift

DRIFT_TITLE = "Depth error on the axis, mm, and in brackets over the image, root mean square"
DRIFT_SAYS = (
    "The calibration's std is that of the day it was made. What changes afterwards comes on top, each in"
    " proportion to its size, and no number of pictures helps: calibrate again, or check against a known"
    " distance. `rigsim tolerance` judges such changes together."
)
_CAUSES: Mapping[str, str] = MappingProxyType(
    {
        "bar_warmer": "bar warmer",
        "lenses_warmer": "lenses warmer",
        "knock": "right camera turned",
        "refocus": "right lens refocused",
    }
)
_SOURCES: Mapping[str, str] = MappingProxyType(
    {"aluminium": "aluminium", "estimate": "estimate", "calibrated": "tolerance class"}
)


def drift_heads(found: Sequence[Drift]) -> tuple[str, ...]:
    """Heads of the table."""
    return ("change", "by", *(f"at {plain(z_m)} m" for z_m in found[0].z_m), "size from")


def drift_numeric(found: Sequence[Drift]) -> tuple[bool, ...]:
    """Which columns stand right."""
    return (False, True, *[True] * len(found[0].z_m), False)


def drift_rows(found: Sequence[Drift]) -> list[tuple[str, ...]]:
    """One row a change: depth error on the axis, and over the image in brackets, mm."""
    return [
        (
            _CAUSES[one.cause],
            f"{plain(one.amount)} {one.unit}",
            *(_error(*pair) for pair in zip(one.axis_m, one.image_m, strict=True)),
            _SOURCES[one.source],
        )
        for one in found
    ]


def _error(axis_m: float, image_m: float) -> str:
    axis = number(abs(axis_m) * 1e3, 2) if abs(axis_m) > 1e-9 else "0"
    return f"{axis} ({number(image_m * 1e3, 2)})" if math.isfinite(image_m) else axis
