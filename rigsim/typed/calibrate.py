"""What `rigsim calibrate` is asked for, as typed: boards, poses, where a board can be held, lens models."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from rigsim.errors import InvalidRange
from rigsim.typed import quantity
from rigsim.typed.board import board
from rigsim.typed.noise import pixel_noise
from rigsim.typed.tolerances import tolerance_range, tolerance_requirement

TILT = quantity.QuantityKind("tilt", "deg", quantity.HFOV.factors, at_least=0, below=90)
CORNER_NOISE = quantity.QuantityKind("corner noise", "px", quantity.NOISE.factors, above=0)
FLATNESS = quantity.QuantityKind("flatness", "mm", quantity.BASELINE.factors, at_least=0)
TRUE_WARP = quantity.QuantityKind("true warp", "mm", quantity.BASELINE.factors)
SIMULATED, MEASURED = 300, 20
"""Whole calibrations that --verify simulates, and makes of rendered pictures."""


def plan_arguments(typed: Mapping[str, Any]) -> dict[str, Any]:
    """What `rigsim.plan_calibration` is asked for, from the options of `rigsim calibrate plan` by name.

    Raises:
        InvalidRange: a word cannot be read, or is out of bounds.
    """
    return {
        "board": board(typed["board"]),
        "poses": poses(typed["poses"]),
        "range_m": tolerance_range(typed["board_range"]),
        "tilt_deg": quantity.value(typed["tilt"], TILT),
        "corner_noise_px": quantity.value(typed["corner_noise"], CORNER_NOISE),
        "noise_px": pixel_noise(typed["noise"], typed["disparity_noise"]).std_px,
        "model": typed["model"],
        "fix": fixed(typed["fix"]),
        "warp": typed["warp"],
        "flatness_mm": quantity.value(typed["flatness"], FLATNESS),
        **_goal(typed["depth_error"]),
        "at_m": tuple(mm / 1e3 for mm in quantity.distances(typed["at"])),
        **_witnesses(typed),
        "seed": typed["seed"],
    }


def poses(text: str) -> int | str:
    """A number of poses, or the path of a poses.json."""
    return int(text) if re.fullmatch(r"\s*[-+]?\d{1,9}\s*", text) else text


def fixed(words: list[str] | None) -> tuple[str, ...]:
    """The names of what a calibration holds, of one or several lists."""
    names = tuple(name.strip() for word in words or [] for name in word.split(","))
    if "" in names:
        raise InvalidRange(
            f"fix {','.join(names)}: a name is empty; write names between commas, as k3,aspect"
        )
    return names


def _goal(text: str | None) -> dict[str, float]:
    if text is None:
        return {}
    asked = tolerance_requirement(text)
    return {("depth_error_at_m" if name == "at_m" else name): value for name, value in asked.items()}


def _witnesses(typed: Mapping[str, Any]) -> dict[str, Any]:
    simulate = typed["simulate"]
    if simulate is None:
        simulate = SIMULATED if typed["verify"] else 0
    measure = MEASURED if typed["verify"] else 0
    warps = () if typed["true_warp"] is None else quantity.values(typed["true_warp"], TRUE_WARP)
    if len(warps) > 2:
        raise InvalidRange(
            f"true warp {typed['true_warp']}: must be one length, or two, of rows and columns: 0.3,0.1mm"
        )
    if not (simulate or measure) and (warps or typed["true_model"]):
        option = "--true-warp" if warps else "--true-model"
        raise InvalidRange(f"{option} says what whole calibrations meet: add --verify, or --simulate 300")
    return {
        "simulate": simulate,
        "measure": measure,
        "true_model": typed["true_model"],
        "true_warp_mm": warps[0] if len(warps) == 1 else warps or 0.0,
    }
