"""How far a triangulated point lies from the truth: covariance, bias and exact bounds, for any rig.

First and second order in the pixel noise, for the maximum-likelihood triangulator (`optimal`).
Outliers are no part of it. Points are metres in the left camera's frame; NaN where a camera shows none
(behind it, or beyond the fold of its lens). A noise is a `PixelNoise`, or its std per coordinate, px.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.rig import given
from rigsim.rig.arrays import Array
from rigsim.rig.noise import PixelNoise, as_noise
from rigsim.rig.stereo import StereoRig
from rigsim.theory.blocks import blocks
from rigsim.theory.bounds import extreme_depths
from rigsim.theory.epipolar import epipolar_motion
from rigsim.theory.matrices import inverse_symmetric

LEAST_DEPTH_SIGMAS = 4.0
"""Below this ``Z / sigma_Z`` the depth error has no useful moments, and "std" and "RMS" say little."""

_BLOCK = 8192
_RELATIVE_STEP = 1e-5


def predict_covariance(rig: StereoRig, points_left: npt.ArrayLike, noise: PixelNoise | float) -> Array:
    """Covariance (N, 3, 3) m^2 of triangulated points (N, 3).

    ``A S A^T`` with ``A = (J^T J)^-1 J^T`` and S the noise's covariance: least squares stays what the
    triangulator does when left and right noise are correlated, so this is exact to first order;
    without correlation it is the Cramer-Rao bound ``sigma^2 (J^T J)^-1``.

    Example:
        >>> import rigsim
        >>> covariance = rigsim.predict_covariance(rigsim.preset("bin").rig, [[0, 0, 2.0]], 0.25)
        >>> covariance.shape, round(float(covariance[0, 2, 2]) ** 0.5 * 1e3, 2)  # mm of depth
        ((1, 3, 3), 21.43)
    """
    points, noise = _checked(rig, points_left), as_noise(noise)
    covariance = np.empty((len(points), 3, 3))
    for block in blocks(len(points), _BLOCK):
        A = pixel_gain(rig, points[block])
        covariance[block] = A @ noise.covariance_px2 @ A.transpose(0, 2, 1)
    return covariance


def predict_depth_std(rig: StereoRig, points_left: npt.ArrayLike, noise: PixelNoise | float) -> Array:
    """Standard deviation (N,) m of the depth; ``Z^2/(f B) sigma_d`` when rectified.

    Example:
        >>> import rigsim
        >>> std_m = rigsim.predict_depth_std(rigsim.preset("bin").rig, [[0, 0, 2.0]], 0.25)
        >>> round(float(std_m[0]) * 1e3, 2)  # 2^2 / (1100 * .06) * .25 sqrt 2
        21.43
    """
    return np.asarray(np.sqrt(_depth_variance(rig, _checked(rig, points_left), as_noise(noise))))


def depth_in_sigmas(rig: StereoRig, points_left: npt.ArrayLike, noise: PixelNoise | float) -> Array:
    """Depth over its own standard deviation, ``Z / sigma_Z`` (N,); infinite without noise.

    To first order the distance of the point at infinity in standard deviations, ``d / sigma_d`` when
    rectified; from the point's own covariance it holds for any lenses, poses and correlation.

    Example:
        >>> import rigsim
        >>> z = rigsim.depth_in_sigmas(rigsim.preset("bin").rig, [[0, 0, 2.0]], 0.25)
        >>> round(float(z[0]), 2)  # the disparity over its own: 33 / (.25 sqrt 2)
        93.34
    """
    points, noise = _checked(rig, points_left), as_noise(noise)
    with np.errstate(divide="ignore"):
        return np.asarray(points[:, 2] / predict_depth_std(rig, points, noise))


def predict_depth_bias(rig: StereoRig, points_left: npt.ArrayLike, noise: PixelNoise | float) -> Array:
    """Mean depth error (N,) m to second order in the noise; ``Z (sigma_d/d)^2`` when rectified.

    Example:
        >>> import rigsim
        >>> bias_m = rigsim.predict_depth_bias(rigsim.preset("bin").rig, [[0, 0, 2.0]], 0.25)
        >>> round(float(bias_m[0]) * 1e3, 4)  # 2000 mm * (.25 sqrt 2 / 33)^2
        0.2296
    """
    return np.asarray(predict_bias(rig, points_left, noise)[:, 2])


def predict_bias(rig: StereoRig, points_left: npt.ArrayLike, noise: PixelNoise | float) -> Array:
    """Mean error (N, 3) m of triangulated points (N, 3) to second order in the noise.

    The normal equations expanded to second order, M = J^T J, H_i the Hessian of pixel coordinate i,
    C the covariance and ``D = (I - J A) S A^T``:
    ``bias = M^-1 (-1/2 J^T [tr(H_i C)]_i + sum_i H_i D_i)``.
    """
    points, noise = _checked(rig, points_left), as_noise(noise)
    S = noise.covariance_px2
    bias = np.empty((len(points), 3))
    for block in blocks(len(points), _BLOCK):
        X = points[block]
        J = rig.jacobian(X)
        transposed = J.transpose(0, 2, 1)
        M_inverse = inverse_symmetric(transposed @ J)
        A = M_inverse @ transposed
        S_At = S @ A.transpose(0, 2, 1)
        C = A @ S_At
        D = S_At - J @ C
        H = _hessian(rig, X)
        curvature = np.einsum("nijk,njk->ni", H, C)
        right_side = np.einsum("nijk,nik->nj", H, D) - 0.5 * np.einsum("nij,ni->nj", J, curvature)
        bias[block] = np.einsum("nij,nj->ni", M_inverse, right_side)
    return bias


def predict_depth_rmse(
    rig: StereoRig, points_left: npt.ArrayLike, noise: PixelNoise | float
) -> tuple[Array, Array]:
    """Root mean square depth error (N,) m, and the first term that was left out (N,) m.

    With ``a = S_ZZ / Z^2``, (sigma_d/d)^2 when rectified, ``E[(Z/Z0 - 1)^2] = a + 9 a^2 + 75 a^3 + ...``:
    the second term is the bias squared and the growth of the variance, 8 a^2. The series is asymptotic:
    trust it while the second array is small.

    Example:
        >>> import rigsim
        >>> rmse_m, left_out_m = rigsim.predict_depth_rmse(rigsim.preset("bin").rig, [[0, 0, 2.0]], 0.25)
        >>> round(float(rmse_m[0]) * 1e3, 1), bool(left_out_m[0] < 1e-4)
        (21.4, True)
    """
    points, noise = _checked(rig, points_left), as_noise(noise)
    variance = _depth_variance(rig, points, noise)
    with np.errstate(all="ignore"):
        a = variance / points[:, 2] ** 2
        mean_square = variance * (1 + 8 * a) + predict_depth_bias(rig, points, noise) ** 2
        rmse = np.sqrt(mean_square)
        return rmse, np.sqrt(mean_square + 75 * a**2 * variance) - rmse


def parallax_px(rig: StereoRig, points_left: npt.ArrayLike) -> Array:
    """Distance (N,) px in the right image between a point and the infinite end of its left ray.

    What a disparity is to a rectified rig, ``f B / Z``, for any rig, in pixels as they are seen; infinite
    where the right camera cannot show the ray's end. How certain a depth is, it does not say for
    unequal or distorted lenses: that is `depth_in_sigmas`.

    Example:
        >>> import rigsim
        >>> round(float(rigsim.parallax_px(rigsim.preset("bin").rig, [[0, 0, 2.0]])[0]), 6)
        33.0
    """
    points = _checked(rig, points_left)
    motion = epipolar_motion(rig, points)
    with np.errstate(all="ignore"):
        away = np.where(motion.infinity_depth <= 0, 0.0, motion.infinity_depth)
        ideal = np.asarray(motion.speed / (motion.depth_right * away))
        if rig.right.lens is None:
            return ideal
        end = rig.right.project(points @ rig.right_from_left.R.T)
        seen = np.linalg.norm(rig.project(points)[1] - end, axis=1)
    return np.where(np.isnan(seen) & ~np.isnan(ideal), np.inf, seen)


def depth_bounds(
    rig: StereoRig, points_left: npt.ArrayLike, disparity_error_px: npt.ArrayLike
) -> tuple[Array, Array]:
    """Nearest and farthest depth (N,) m when the disparity is off by up to `disparity_error_px` p.

    When rectified, exactly ``Z - Z^2 p / (f B + Z p)`` and ``Z + Z^2 p / (f B - Z p)``; the far bound is
    infinite once the point at infinity lies within the error. For any other rig the four seen pixel
    coordinates are off by p / sqrt(2) in all, as noise of that size in each makes a disparity's
    standard deviation p: the extremes of `rigsim.theory.bounds`. Either way the bounds for the disparity's
    standard deviation are, to first order, one standard deviation of the depth away.

    Raises:
        InvalidRange: the error is negative or NaN.

    Example:
        >>> import rigsim
        >>> near, far = rigsim.depth_bounds(rigsim.preset("bin").rig, [[0, 0, 2.0]], 1.0)
        >>> round(float(near[0]), 4), round(float(far[0]), 4)  # 66 / 34 and 66 / 32
        (1.9412, 2.0625)
    """
    error = np.asarray(disparity_error_px, dtype=np.float64)
    if not (error >= 0).all():
        raise InvalidRange(f"disparity error {error.min():g} px: must be >= 0")
    points = _checked(rig, points_left)
    if not rig.is_rectified:
        return extreme_depths(rig, points, error / math.sqrt(2))
    fx_b, z = rig.left.fx * rig.baseline_m, np.where(points[:, 2] > 0, points[:, 2], np.nan)
    z = z + 0 * points.sum(axis=1)
    with np.errstate(all="ignore"):
        room = fx_b - error * z
        near = z - error * z**2 / (fx_b + error * z)
        far = np.where(room > 0, z + error * z**2 / room, math.inf)
    return near, np.where(np.isnan(z), np.nan, far)


def pixel_gain(rig: StereoRig, points_left: Array) -> Array:
    """``A = (J^T J)^-1 J^T`` (N, 3, 4) m/px: how a triangulated point follows small pixel errors."""
    J = rig.jacobian(points_left)
    transposed = J.transpose(0, 2, 1)
    return np.asarray(inverse_symmetric(transposed @ J) @ transposed)


def _depth_variance(rig: StereoRig, points: Array, noise: PixelNoise) -> Array:
    variance = np.empty(len(points))
    for block in blocks(len(points), _BLOCK):
        gain = pixel_gain(rig, points[block])[:, 2]
        variance[block] = np.einsum("ni,ni->n", gain @ noise.covariance_px2, gain)
    return variance


def _hessian(rig: StereoRig, points: Array) -> Array:
    """Second derivatives (N, 4, 3, 3) px/m^2 of the four pixel coordinates."""
    # a step in proportion to the distance keeps truncation and rounding near 1e-10 at any range
    step = _RELATIVE_STEP * np.linalg.norm(points, axis=1)
    along = np.eye(3)[:, None, :] * step[:, None]
    ahead, behind = rig.jacobian(np.stack([points + along, points - along]))
    return np.asarray(np.moveaxis((ahead - behind) / (2 * step)[:, None, None], 0, -1))


def _checked(rig: StereoRig, points_left: npt.ArrayLike) -> Array:
    given.a(StereoRig, rig, "a StereoRig: the rig", InvalidRig)
    return given.points(points_left)


def _points(points_left: npt.ArrayLike) -> Array:
    return given.points(points_left)
