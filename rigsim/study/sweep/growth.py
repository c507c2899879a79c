"""How the depth error of one rig grows with the distance."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from rigsim.study.scene import columns as col

_SQUARE = (1.9, 2.1)
_MISFIT = 0.25  # the edges of a bin are that far apart, squared half of it either way
_FEWEST_BINS = 3


@dataclass(frozen=True, slots=True)
class Growth:
    """How an error grows over the depth bins of one row."""

    times: float
    """The error in the last bin over that in the first."""
    farther: float
    """The distance of the last bin over that of the first."""
    power: float | None
    """Exponent of the distance; None where a bin lies a quarter off the fit, or there are too few."""

    @property
    def is_square(self) -> bool:
        """Whether the exponent is within 0.1 of 2."""
        return self.power is not None and _SQUARE[0] <= self.power <= _SQUARE[1]


def growth_of(bins: pd.DataFrame) -> Growth | None:
    """How the error grows over the depth bins of one row; None where there is no error or one distance.

    ``log(RMS) = p log(Z) + c`` by least squares over the bins' median depths.
    """
    depth_mm, error_mm = (
        bins[name].to_numpy(dtype=np.float64) for name in (col.DEPTH_MEDIAN, col.DEPTH_RMSE)
    )
    known = (depth_mm > 0) & (error_mm > 0)
    depth_mm, error_mm = depth_mm[known], error_mm[known]
    if len(depth_mm) < 2 or depth_mm[-1] < 1.1 * depth_mm[0]:
        return None
    x, y = np.log(depth_mm), np.log(error_mm)
    power, start = np.polyfit(x, y, 1)
    misfit = float(np.abs(y - power * x - start).max())
    fits = len(depth_mm) >= _FEWEST_BINS and misfit <= math.log1p(_MISFIT)
    return Growth(
        float(error_mm[-1] / error_mm[0]),
        float(depth_mm[-1] / depth_mm[0]),
        float(power) if fits else None,
    )
