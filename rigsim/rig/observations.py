"""Pixel positions of the same points in two images."""

from __future__ import annotations

from dataclasses import dataclass

from rigsim.rig.arrays import Array, Mask


@dataclass(frozen=True, slots=True)
class Observations:
    """One row a point; simulated or measured, the consumer cannot tell."""

    uv_left: Array
    """Positions in the left image, (N, 2), px."""
    uv_right: Array
    """Positions in the right image, (N, 2), px."""
    valid: Mask
    """Whether the point was seen in both images, (N,)."""
