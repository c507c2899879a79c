"""What the two cameras of a rig see."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array, Ids, Image, Light


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """One camera's picture."""

    light: Light
    """Linear light of each pixel's area, (H, W, 3), 0 to 1."""
    depth: Array
    """Depth along the optical axis (not ray length) at the pixel centres, (H, W), m; NaN for nothing."""
    segmentation: Ids
    """MuJoCo geom id, (H, W); -1 for nothing."""

    @property
    def image(self) -> Image:
        """Colour, (H, W, 3), grey levels 0 to 255."""
        return np.asarray(np.rint(np.clip(self.light, 0, 1) * 255), dtype=np.uint8)


@dataclass(frozen=True, slots=True, eq=False)
class StereoFrame:
    """Both cameras' pictures."""

    left: View
    """The left camera's."""
    right: View
    """The right camera's."""
