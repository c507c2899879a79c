"""What `rigsim calibrate pictures` is asked for, as typed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rigsim.errors import InvalidRange
from rigsim.typed import quantity
from rigsim.typed.board import board
from rigsim.typed.calibrate import fixed
from rigsim.typed.noise import pixel_noise


def pictures_arguments(typed: Mapping[str, Any]) -> dict[str, Any]:
    """What `rigsim.calibrate_pictures` is asked for, from the command's options by name.

    Raises:
        InvalidRange: a word cannot be read, or is out of bounds.
    """
    if not typed["pictures"] and not typed["corners"]:
        raise InvalidRange(
            "pictures are missing: give those of both cameras, as left*.png right*.png, or --corners"
        )
    sizes = None if typed["size"] is None else quantity.resolutions(typed["size"], "size")
    if sizes is not None and len(sizes) != 1:
        raise InvalidRange(f"size {typed['size']}: must be one, as 640x480")
    return {
        "pictures": typed["pictures"] or (),
        "board": board(typed["board"]),
        "model": typed["model"],
        "fix": fixed(typed["fix"]),
        "warp": typed["warp"],
        "at_m": tuple(mm / 1e3 for mm in quantity.distances(typed["at"])),
        "noise_px": pixel_noise(typed["noise"], typed["disparity_noise"]).std_px,
        "corners": typed["corners"] or None,
        "size": None if sizes is None else sizes[0],
    }
