"""Pixel positions of the same points in two images."""

from __future__ import annotations

from dataclasses import dataclass

from rigsim.rig.arrays import Array, Mask


@dataclass(frozen=True, slots=True)
class Observations:
    """One row a point; simulated or measured, the consumer cannot tell.

    Example:
        >>> import numpy as np, rigsim
        >>> rig = rigsim.preset("bin").rig
        >>> uv_left, uv_right = rig.project([[0, 0, 2.0]])
        >>> seen = rigsim.Observations(uv_left, uv_right, np.array([True]))
        >>> float(seen.uv_left[0, 0] - seen.uv_right[0, 0])  # 1100 px * 60 mm / 2 m
        33.0
    """

    uv_left: Array
    """Positions in the left image, (N, 2), px."""
    uv_right: Array
    """Positions in the right image, (N, 2), px."""
    valid: Mask
    """Whether the point was seen in both images, (N,)."""
