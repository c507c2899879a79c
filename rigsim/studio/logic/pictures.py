"""What pictures are wanted of a rig, and what they say."""

from __future__ import annotations

import base64
import math

from rigsim.present.kit.format import length, length_mm, number
from rigsim.rig.arrays import Array
from rigsim.studio.draw.request import Overlay, Pair, PairRequest
from rigsim.studio.logic.numbers import RigNumbers
from rigsim.study.calc.cloud import points_of_depth

OVERLAYS: dict[Overlay, str] = {
    "none": "none",
    "anaglyph": "anaglyph",
    "disparity": "disparity",
    "error": "depth error",
}
"""Overlays with what people read."""
NOTHING = "nothing there"
"""Of a pixel that shows no surface."""


def pair_wanted(found: RigNumbers, scene: str, overlay: Overlay, *, coarse: bool) -> PairRequest | None:
    """The pair that belongs to the numbers; None for no rig."""
    if found.shown is None:
        return None
    return PairRequest(
        found.shown.rig, scene, coarse=coarse, overlay=overlay, noise_px=found.shown.noise.std_px
    )


def points_seen(pair: Pair, request: PairRequest) -> Array:
    """Points (N, 3) m of the scene, spread over the left picture."""
    return points_of_depth(request.rig, pair.depth_m)


def at_pixel(pair: Pair, x: float, y: float) -> str:
    """What is known at a place of the left picture, in one line."""
    column, row = math.floor(x), math.floor(y)
    if not (0 <= column < pair.width and 0 <= row < pair.height):
        return ""
    depth, disparity, std = (
        float(values[row, column]) for values in (pair.depth_m, pair.disparity_px, pair.depth_std_m)
    )
    if not math.isfinite(depth):
        return NOTHING
    if not math.isfinite(disparity):
        return f"depth {length(depth)} · the right camera does not see it"
    return f"depth {length(depth, 4)} · disparity {number(disparity, 4)} px · std {length_mm(std * 1e3)}"


def source(picture: bytes) -> str:
    """A picture as an address that holds it."""
    kind = "png" if picture.startswith(b"\x89PNG") else "jpeg"
    return f"data:image/{kind};base64,{base64.b64encode(picture).decode()}"
