"""The part of depth errors that is no noise: mean errors, as two calibration errors would make them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array

_FEWEST = 3


@dataclass(frozen=True, slots=True)
class BiasPart:
    """The mean errors, as two calibration errors would make them: ``-K(Z) offset + scale Z``."""

    disparity_offset_px: float
    """Measured minus true disparity, px: yaw or a principal point that is off."""
    disparity_offset_se_px: float
    """Its standard error; NaN where nothing is left over to tell it by."""
    scale: float
    """Share of the distance: a baseline or focal length that is off; NaN where one distance is known."""
    scale_se: float
    """Its standard error."""
    left_rms_m: float
    """RMS of what neither explains, m."""
    share: float
    """Share of the bias in the mean squared error, over all distances, each relative to its distance."""


def bias_part(depths: Array, stds: Array, counts: Array | None, gains: Array, biases_m: Array) -> BiasPart:
    """Least squares of the relative bias on both calibration errors; the offset alone under three points.

    All are arrays (N,): distances, standard deviations and biases in m, `gains` in m/px, `counts` of
    measurements. Every distance weighs as much as its own std says. The standard errors are those of the
    scatter about the fit; with counts, which say how sure each mean is, they are never smaller than those
    allow.
    """
    weights = 1 / stds if counts is None else np.sqrt(counts) / stds
    columns = np.column_stack([-gains, depths])
    if len(depths) < _FEWEST or np.ptp(depths) < 1e-9 * depths.max():
        columns = columns[:, :1]
    scaled = columns * weights[:, None]
    sizes = np.linalg.norm(scaled, axis=0)
    solution = np.linalg.lstsq(scaled / sizes, biases_m * weights, rcond=None)[0] / sizes
    left = biases_m - columns @ solution
    freedom = len(depths) - columns.shape[1]
    unit_variance = float(((left * weights) ** 2).sum()) / freedom if freedom else math.nan
    if counts is not None:
        unit_variance = 1.0 if math.isnan(unit_variance) else max(unit_variance, 1.0)
    inverse = np.linalg.pinv(scaled / sizes)
    ses = np.sqrt((inverse**2).sum(axis=1) * unit_variance) / sizes
    mean_square = (biases_m / depths) ** 2
    total = mean_square + (stds / depths) ** 2
    return BiasPart(
        float(solution[0]),
        float(ses[0]),
        float(solution[1]) if len(solution) > 1 else math.nan,
        float(ses[1]) if len(solution) > 1 else math.nan,
        float(np.sqrt(np.mean(left**2))),
        float(mean_square.sum() / total.sum()),
    )
