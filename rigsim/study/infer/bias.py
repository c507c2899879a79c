"""The part of depth errors that is no noise: mean errors, as two calibration errors would make them.

The rig measures the disparity ``d + offset`` where d is true, and its depth is ``1 + scale`` times what
that triangulates to: ``Z_measured = (1 + scale) f B / (d + offset)`` when rectified. It is solved as it
stands, not to first order: errors as large as the distance are split as well as small ones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array
from rigsim.study.infer.random_effects import Effects, random_effects

_FEWEST = 3
_STEPS = 60
_STILL = 1e-11
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)

Gain = Callable[[Array], Array]
"""Depth error per pixel of disparity (N,) m/px at depths (N,) m."""


@dataclass(frozen=True, slots=True)
class BiasPart:
    """The mean errors, as two calibration errors would make them."""

    disparity_offset_px: float
    """Measured minus true disparity, px: yaw or a principal point that is off."""
    disparity_offset_se_px: float
    """Its standard error; NaN where nothing is left over to tell it by."""
    scale: float
    """Share of the distance: a baseline or focal length that is off; NaN where one distance is known."""
    scale_se: float
    """Its standard error."""
    reach: float
    """Standard errors from either to the ends of its 95 % interval."""
    left_rms_m: float
    """RMS of what neither explains, m."""
    share: float
    """Share of the bias in the mean squared error, over all distances, each relative to its distance."""

    @property
    def offset_interval_px(self) -> tuple[float, float]:
        """95 % interval of the offset, px; NaN where nothing tells it."""
        half = self.reach * self.disparity_offset_se_px
        return self.disparity_offset_px - half, self.disparity_offset_px + half

    @property
    def scale_interval(self) -> tuple[float, float]:
        """95 % interval of the scale; NaN where nothing tells it."""
        half = self.reach * self.scale_se
        return self.scale - half, self.scale + half


def disparity_between(gain: Gain, from_m: Array, to_m: Array) -> Array:
    """Disparity (N,) px at depths `to_m` minus that at `from_m`; ``f B (1/to - 1/from)`` when rectified.

    The integral of ``1/K`` over depth, in inverse depth, where it is a constant for a rectified rig.
    """
    middle, half = (1 / from_m + 1 / to_m) / 2, (1 / to_m - 1 / from_m) / 2
    depths = 1 / (middle[:, None] + half[:, None] * _NODES)
    per_inverse = depths**2 / gain(depths.ravel()).reshape(depths.shape)
    return np.asarray(half * (per_inverse @ _WEIGHTS))


def split_bias(
    gain: Gain, depths: Array, steady: Array, variances_px2: Array | None
) -> tuple[Effects, Array]:
    """Offset px and scale behind the depths (N,) m that stand for `depths`, and the px (N,) left over.

    `steady` are the measured mean depths without what noise adds to them, `variances_px2` the variances of
    their disparities, None where no counts tell them. The offset alone under three distances.

    Raises:
        InvalidRange: the measured depths do not grow with the distance.
    """
    both = len(depths) >= _FEWEST and np.ptp(depths) > 1e-9 * depths.max()
    ones = np.ones_like(depths)
    # true disparities: free of noise, they stand for the measured ones that the scale multiplies
    instruments = np.column_stack([ones, depths / gain(depths)])
    scale = 0.0
    for _ in range(_STEPS):
        found = steady / (1 + scale)
        moved = disparity_between(gain, depths, found)
        if not both:
            fit = random_effects(ones[:, None], moved, variances_px2)
            return fit, moved - fit.values[0]
        slope = found / gain(found) / (1 + scale)
        columns = np.column_stack([ones, -slope])
        fit = random_effects(columns, moved - slope * scale, variances_px2, instruments)
        change, scale = float(fit.values[1]) - scale, float(fit.values[1])
        if not -1 < scale < 1e3:
            raise InvalidRange(
                "depth bias: the measured depth does not grow with the distance, and no disparity offset"
                " and scale make it so; check depth_bias_mm (measured minus true)"
            )
        if abs(change) <= _STILL * (1 + scale):
            break
    return fit, moved - slope * scale - columns @ fit.values


def bias_share(depths: Array, stds: Array, biases: Array) -> float:
    """Share of the bias in the mean squared error, each relative to its distance."""
    mean_square = (biases / depths) ** 2
    return float(mean_square.sum() / (mean_square + (stds / depths) ** 2).sum())
