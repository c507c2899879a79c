"""What the two cameras of a rig see."""

from __future__ import annotations

from dataclasses import dataclass

from rigsim.rig.arrays import Array, Ids, Image


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """One camera's picture."""

    image: Image
    """Colour, (H, W, 3)."""
    depth: Array
    """Depth along the optical axis (not ray length) at the pixel centres, (H, W), m; NaN for nothing."""
    segmentation: Ids
    """MuJoCo geom id, (H, W); -1 for nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class StereoFrame:
    """Both cameras' pictures."""

    left: View
    """The left camera's."""
    right: View
    """The right camera's."""
