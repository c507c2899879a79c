"""One case of a verification: what a triangulator is given, and what is true."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from rigsim.rig.arrays import Array, Mask
from rigsim.rig.stereo import StereoRig
from rigsim.study.saying import Saying

CaseKind: TypeAlias = Literal["exact", "noisy", "measured", "nowhere"]
"""What a case asks: the point itself, an error of the size that noise allows, the same for pixels that
were found in pictures, or no point at all."""


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """Pixels for a triangulator and the truth that they came from; one row a point."""

    name: str
    """Unique within a suite, as ``verged exact``."""
    group: str
    """What cases of one geometry share, as ``verged``."""
    kind: CaseKind
    """What must hold."""
    about: Saying
    """What it shows."""
    rig: StereoRig
    """The rig that the triangulator is given."""
    uv_left: Array
    """Pixels in the left image, (N, 2), px."""
    uv_right: Array
    """Pixels in the right image, (N, 2), px."""
    points_left: Array
    """True points, (N, 3), m; NaN where the pixels belong to no point in front of both cameras."""
    covariance_px2: Array | None = None
    """Covariance of (u_left, v_left, u_right, v_right), (4, 4) or one for each row, (N, 4, 4), px^2; None
    where the pixels are exact."""

    @property
    def answerable(self) -> Mask:
        """Whether a row has an answer, (N,)."""
        return np.asarray(np.isfinite(self.points_left).all(axis=1))

    def __len__(self) -> int:
        return len(self.uv_left)
