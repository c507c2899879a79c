"""What the best triangulator leaves of the noise, when some of the points do not come back."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.theory.uncertainty import predict_depth_std


def depth_reach(rig: StereoRig, points_left: Array, noise_px: float) -> Array:
    """How many standard deviations (N,) of 1/Z lie between points (N, 3) m and infinity.

    ``Z / sigma_Z``: for a rectified rig the disparity over its own standard deviation. 1/Z is Gaussian, so
    the noise puts a point behind the cameras with probability Phi(-reach), whatever the lenses.
    """
    return np.asarray(points_left[:, 2] / predict_depth_std(rig, points_left, PixelNoise(noise_px)))


@dataclass(frozen=True, slots=True)
class NoiseBound:
    """What the best unbiased triangulator leaves of a pixel noise, over the points that come back.

    Noise that pushes a point beyond infinity leaves none in front of the cameras. With a its `depth_reach`, a
    point comes back with probability Phi(a), and the error z along its epipolar line is then a Gaussian cut
    off at -a: E z = l, E z² = 1 - a l, E z⁴ = 3 - (3 a + a³) l with l = phi(a) / Phi(a). The other two of the
    three degrees of freedom are not cut.
    """

    failed_share: float
    """Share of points that do not come back."""
    failed_share_se: float
    """Its standard error."""
    squares: float
    """Mean squared pixel error, a third of the four coordinates' sum, in units of the noise's variance; 1
    where all come back."""
    squares_std: float
    """Standard deviation of that of one point."""
    depth_squares: float
    """Mean squared error of 1/Z, in its variances; 1 where all come back."""
    bias: float
    """Mean error of 1/Z, standard deviations, positive when too far; 0 where all come back."""


def bound(rig: StereoRig, points_left: Array, noise_px: float) -> NoiseBound:
    """The bound for points (N, 3) m and Gaussian noise of so many px in each of the four coordinates."""
    from scipy.stats import norm

    reach = depth_reach(rig, points_left, noise_px)
    back = norm.cdf(reach)
    weight = back / back.sum()
    cut = norm.pdf(reach) / back
    second = 1 - reach * cut
    fourth = 3 - (3 * reach + reach**3) * cut
    squares = float((weight * (2 + second)).sum()) / 3
    # of a chi-squared with two degrees of freedom: 2 and 8
    squares_of_squares = float((weight * (8 + 4 * second + fourth)).sum()) / 9
    return NoiseBound(
        float(1 - back.mean()),
        math.sqrt(float((back * (1 - back)).sum())) / len(back),
        squares,
        math.sqrt(max(squares_of_squares - squares**2, 0.0)),
        float((weight * second).sum()),
        -float((weight * cut).sum()),
    )
