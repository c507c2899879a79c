"""Points of the left image found again in the right one, each with the accuracy to expect of it.

Interest points, normalised correlation along the row, a left-right check, and a fit to a small part
of a pixel. A rig that is not rectified is turned into one first (`rigsim.pixels.dense.rectify`); the
positions handed back are always those of the images given.

What a match can be trusted for (Robinson & Milanfar, "Fundamental performance limits in image
registration", IEEE TIP 2004): with noise ``sigma_n`` in both images and the gradient ``g`` along the row,
``sigma_d >= sqrt(2) sigma_n / sqrt(sum g^2)``. The noise is what the fit leaves over, so texture the
warp cannot explain makes a match less trusted, not more. Where the surface is no plane, leaving out parts
of the window or bending the warp moves the answer, and what it moves by beyond the noise is added as
model error. A window across two surfaces is fitted well by a plane that is neither's: the fewer neighbours
lie on a match's plane, the less it is trusted, and with one in eight or none it is dropped.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidImage, InvalidRange, MeasurementFailed
from rigsim.pixels.dense.rectify import Rectification, rectify
from rigsim.pixels.dense.views import RowView
from rigsim.pixels.images import grey, quantization_var, same_size
from rigsim.pixels.patches.coarse import Blurred, Correlations, correlate, whole_windows
from rigsim.pixels.patches.epipolar import epipolar_offsets
from rigsim.pixels.patches.interest import estimate_noise, interest_points
from rigsim.pixels.patches.refine import Fits, fit_patches
from rigsim.pixels.patches.spline import Indices, RowSpline, derivative_noise_gain
from rigsim.pixels.patches.trust import ENOUGH, trust
from rigsim.rig.arrays import AnyImage, Array, Mask
from rigsim.rig.observations import Observations
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import inner_range

_LEAST_SCORE = 0.7  # by chance alone the best of a thousand places reaches 0.6
_UNIQUENESS = 0.1  # half a pixel of phase alone lowers a correlation by nearly as much
_LEFT_RIGHT_PX = 1.5
_TEXTURE_SHARE = 0.25  # where fine texture is everywhere it is taken for noise: not for more than this
_ROUNDING = 1e-8
_WINDOWS = (7, 63)


@dataclass(frozen=True, slots=True, eq=False)
class PatchMatches:
    """One row an interest point of the left image; NaN where no match is trusted."""

    observations: Observations
    """Positions in the images given and which matches are trusted, N rows. On a rectified rig the left
    ones are whole pixels: each window's pixel whose disparity is known best."""
    disparity: Array
    """``u_left - u_right``, (N,), px; of the rectified pair when the rig is not."""
    disparity_std_px: Array
    """Predicted standard deviation of `disparity`, model error included, (N,), px."""
    right_std_px: Array
    """The same along the epipolar line in the right image given, (N,), px: a wide lens shows a pixel of the
    rectified pair larger or smaller."""
    noise_disparity_std_px: Array
    """The part of it that image noise explains, (N,), px."""
    score: Array
    """Correlation of the two whole-pixel patches, -1 to 1, (N,)."""
    epipolar_px: Array
    """How far below its row the match really lies, (N,), px; see `epipolar_offsets`."""
    noise_std_grey: float
    """Noise of one image that the best quarter of the fits leaves over, grey."""

    @property
    def n_valid(self) -> int:
        """How many matches are trusted."""
        return int(self.observations.valid.sum())

    @property
    def disparity_range(self) -> tuple[float, float]:
        """Where a dense matcher should search, px: all but the outermost percent of the trusted
        disparities, and a tenth of their span, at least 8 px, beyond."""
        low, high = inner_range(self.disparity)
        margin = max(8.0, 0.1 * (high - low))
        return low - margin, high + margin


def match_patches(
    image_left: AnyImage,
    image_right: AnyImage,
    rig: StereoRig,
    *,
    n_points: int = 2000,
    window: int = 15,
    disparity_range: tuple[float, float] | None = None,
    view: RowView | None = None,
) -> PatchMatches:
    """Match interest points of the left image along their epipolar lines in the right one.

    Args:
        image_left: left picture, (H, W) or (H, W, 3), 8 or 16 bit or floating point.
        image_right: right picture, of the same size.
        rig: the calibration of both; not the truth, but what a user would have.
        n_points: how many interest points are tried at most.
        window: side of the square patches, px, odd.
        disparity_range: least and largest ``u_left - u_right`` to search, px, of the rectified pair; by
            default everything from infinity on that the image's width allows.
        view: what a pair that is not rectified is turned into, see `rigsim.pixels.dense.rectify.rectify`.

    Raises:
        InvalidImage: a picture cannot be measured, or does not fit the other or the rig.
        InvalidRange: the window, the number of points or the disparity range is none.
        MeasurementFailed: nothing to match, or nothing matched.
    """
    _check(n_points, window, disparity_range)
    radius = window // 2
    pair = _rectified(image_left, image_right, rig, window, view)
    low, high = _search_range(pair.rectification.rig, disparity_range)
    gradient = RowSpline.through(pair.left).derivative()
    noise_var, gradient_noise_var = _guessed_noise(pair, gradient)
    uv = _interest(pair, gradient, gradient_noise_var, n_points, window)
    coarse, kept = _coarse(pair, uv, low, high, radius)
    right_spline = RowSpline.through(pair.right)
    fits = fit_patches(
        pair.left,
        gradient,
        right_spline,
        uv[kept],
        coarse.disparity[kept],
        radius=radius,
        noise_var=gradient_noise_var / derivative_noise_gain(),
    )
    noise_var = max(_noise_var(fits, noise_var), pair.rounding_var)
    found = trust(fits, noise_var, window)
    if not found.trusted.any():
        raise MeasurementFailed(
            f"none of {int(kept.sum())} matches could be refined: the images differ by more than shifts along"
            " the rows; check that the pair is rectified as the rig says"
        )
    rows = _Rows(len(uv), np.flatnonzero(kept)[found.trusted], found.trusted)
    return PatchMatches(
        observations=rows.observations(*_in_the_images_given(fits, pair.rectification, rig)),
        disparity=rows.spread(fits.disparity),
        disparity_std_px=rows.spread(found.std),
        right_std_px=rows.spread(found.std * _right_scale(fits, pair.rectification)),
        noise_disparity_std_px=rows.spread(found.noise_std),
        score=rows.spread(coarse.score[kept]),
        epipolar_px=rows.spread(epipolar_offsets(pair.left, right_spline, uv[kept], fits, radius=radius)),
        noise_std_grey=float(np.sqrt(noise_var)),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Pair:
    """The two images, grey and rectified; which of their pixels the ones given show; their rounding."""

    rectification: Rectification
    left: Array
    right: Array
    on_left: Mask
    on_right: Mask
    rounding_var: float


def _rectified(
    image_left: AnyImage, image_right: AnyImage, rig: StereoRig, window: int, view: RowView | None
) -> _Pair:
    left, right = grey(image_left, "left image"), grey(image_right, "right image")
    same_size(left, right)
    fits_rig(left, rig)
    rounding_var = (quantization_var(image_left) + quantization_var(image_right)) / 2
    rectification = rectify(rig, view)
    pair = _Pair(rectification, *rectification.warp(left, right), rounding_var)
    height, width = pair.left.shape
    if min(height, width) < window + 2:
        raise MeasurementFailed(
            f"images of {width} x {height} px hold no {window} x {window} px window and its border: choose a "
            "smaller window"
        )
    return pair


def _guessed_noise(pair: _Pair, gradient: Array) -> tuple[float, float]:
    """Variance of one image's noise, grey^2, and of its gradient's, before any patch is fitted."""
    noise_var = (estimate_noise(pair.left) ** 2 + estimate_noise(pair.right) ** 2) / 2
    most = _TEXTURE_SHARE * float(np.mean(gradient**2))
    return noise_var, min(derivative_noise_gain() * noise_var, most)


@dataclass(frozen=True, slots=True, eq=False)
class _Rows:
    """Where the trusted ones among the fits stand among `n` interest points."""

    n: int
    where: Indices
    trusted: Mask

    def observations(self, uv_left: Array, uv_right: Array) -> Observations:
        """The trusted ones among these positions of the fits."""
        valid = np.zeros(self.n, dtype=bool)
        valid[self.where] = True
        return Observations(self.spread(uv_left), self.spread(uv_right), valid)

    def spread(self, values: Array) -> Array:
        """One row a point, NaN where it is not trusted."""
        full = np.full((self.n, *values.shape[1:]), np.nan)
        full[self.where] = values[self.trusted]
        return full


def _in_the_images_given(fits: Fits, rectification: Rectification, rig: StereoRig) -> tuple[Array, Array]:
    """Left and right positions, (N, 2) px, of the images before they were rectified."""
    uv_left = fits.uv_left
    uv_right = uv_left - np.stack([fits.disparity, np.zeros_like(fits.disparity)], axis=1)
    if rectification.rig is not rig:
        return rectification.left_pixels(uv_left), rectification.right_pixels(uv_right)
    return uv_left, uv_right


def _right_scale(fits: Fits, rectification: Rectification) -> Array:
    """Px of the right image given for one of the rectified, (N,); a planar lens's own distortion is small."""
    if not rectification.source.right.is_wide:
        return np.ones(len(fits.disparity))
    right = fits.uv_left - np.stack([fits.disparity, np.zeros_like(fits.disparity)], axis=1)
    return rectification.right_scale(right)


def fits_rig(image: Array, rig: StereoRig) -> None:
    """Check that a picture has the size of the rig's.

    Raises:
        InvalidImage: it has not.
    """
    height, width = image.shape
    for name, lens in (("left", rig.left), ("right", rig.right)):
        if (lens.width, lens.height) != (width, height):
            raise InvalidImage(
                f"images of {width} x {height} px: the rig's {name} camera has {lens.width} x {lens.height}; "
                "use the rig they were taken with"
            )


def _check(n_points: int, window: int, disparity_range: tuple[float, float] | None) -> None:
    if n_points < 1:
        raise InvalidRange(f"{n_points} points: at least 1 is needed")
    if not (window % 2 == 1 and _WINDOWS[0] <= window <= _WINDOWS[1]):
        raise InvalidRange(f"window {window} px: must be odd, {_WINDOWS[0]} to {_WINDOWS[1]}")
    if disparity_range is not None and not (
        np.isfinite(disparity_range).all() and disparity_range[0] < disparity_range[1]
    ):
        raise InvalidRange(
            f"disparities {disparity_range[0]:g} to {disparity_range[1]:g} px: must be finite and rise"
        )


def _search_range(rig: StereoRig, disparity_range: tuple[float, float] | None) -> tuple[int, int]:
    """Whole disparities to search: in front of the cameras and not further than the image is wide."""
    furthest = rig.left.width - 1
    if disparity_range is None:
        return int(np.clip(np.floor(-rig.doffs_px) - 1, -furthest, furthest - 1)), furthest
    low, high = np.clip(disparity_range, -furthest, furthest)
    if low >= high:
        raise InvalidRange(
            f"disparities {disparity_range[0]:g} to {disparity_range[1]:g} px: none lies on an image "
            f"{rig.left.width} px wide"
        )
    return int(np.floor(low)), int(np.ceil(high))


def _interest(pair: _Pair, gradient: Array, gradient_noise_var: float, n_points: int, window: int) -> Indices:
    """Pixels (N, 2) of the left image with texture along their rows."""
    uv = interest_points(
        gradient,
        whole_windows(pair.on_left, window // 2 + 1),
        n_points,
        radius=window // 2,
        noise_var=max(gradient_noise_var, _ROUNDING * float(np.var(pair.left))),
    )
    if not len(uv):
        raise MeasurementFailed(f"left image: no texture along the rows in any {window} x {window} px window")
    return uv


def _coarse(pair: _Pair, uv: Indices, low: int, high: int, radius: int) -> tuple[Correlations, Mask]:
    """Whole-pixel matches of `uv`, and which are good, alone, and the same from right to left."""
    left, right = Blurred.of(pair.left, pair.on_left, radius), Blurred.of(pair.right, pair.on_right, radius)
    there = correlate(left, right, uv, low, high)
    kept = _is_unique(there)
    uv_right = uv[kept]
    uv_right[:, 0] -= there.disparity[kept].astype(np.intp)
    back = correlate(right, left, uv_right, -high, -low)
    # a repeating texture's hidden part is found elsewhere: only the way back sees that there are two
    same = np.abs(there.disparity[kept] + back.disparity) <= _LEFT_RIGHT_PX
    kept[kept] = same & _is_unique(back)
    if not kept.any():
        raise MeasurementFailed(
            f"none of {len(uv)} points of the left image was found in the right one at disparities {low} to "
            f"{high} px: check that left and right are not swapped and that the rig fits them"
        )
    return there, kept


def _is_unique(found: Correlations) -> Mask:
    return (found.score > _LEAST_SCORE) & (found.score - found.second_score > _UNIQUENESS)


def _noise_var(fits: Fits, fallback: float) -> float:
    """Variance of one image's noise, grey^2: what the best quarter of the fits leaves over."""
    left_over = fits.noise_var[np.isfinite(fits.disparity)]
    return float(np.quantile(left_over, 0.25)) if len(left_over) >= ENOUGH else fallback
