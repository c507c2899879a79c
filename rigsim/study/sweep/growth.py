"""How the depth error of one rig grows with the distance: a fit, and what may be said of it."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

_SQUARE = (1.9, 2.1)
_MISFIT = 0.25  # the edges of a bin are that far apart, squared half of it either way
_FEWEST_BINS = 3


def growth_words(bins: pd.DataFrame) -> str:
    """How the error grows over the depth bins of one row, as a clause; empty where there is no error.

    ``log(RMS) = p log(Z) + c`` by least squares over the bins' median depths. "With the distance squared"
    is said of an exponent within 0.1 of 2, and of any exponent only when no bin lies a quarter off the fit.
    """
    depth_mm, error_mm = (
        bins[name].to_numpy(dtype=np.float64) for name in ("depth_median_mm", "depth_rmse_mm")
    )
    known = (depth_mm > 0) & (error_mm > 0)
    depth_mm, error_mm = depth_mm[known], error_mm[known]
    if len(depth_mm) < 2 or depth_mm[-1] < 1.1 * depth_mm[0]:
        return ""
    x, y = np.log(depth_mm), np.log(error_mm)
    power, start = np.polyfit(x, y, 1)
    misfit = float(np.abs(y - power * x - start).max())
    if len(depth_mm) >= _FEWEST_BINS and misfit <= math.log1p(_MISFIT):
        if _SQUARE[0] <= power <= _SQUARE[1]:
            return "it grows with the distance squared"
        return f"it grows with the distance to the power {power:.2g}, not squared"
    times, farther = error_mm[-1] / error_mm[0], depth_mm[-1] / depth_mm[0]
    return (
        f"{times:.3g} times the error at {farther:.3g} times the distance "
        f"(its square would be {farther**2:.3g} times)"
    )
