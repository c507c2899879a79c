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
from rigsim.pixels.dense.rectify import rectify
from rigsim.pixels.images import grey, quantization_var, same_size
from rigsim.pixels.patches.coarse import Blurred, Correlations, correlate, whole_windows
from rigsim.pixels.patches.epipolar import epipolar_offsets
from rigsim.pixels.patches.interest import estimate_noise, interest_points
from rigsim.pixels.patches.neighbours import borne_out
from rigsim.pixels.patches.refine import Fits, fit_patches
from rigsim.pixels.patches.spline import Indices, RowSpline, derivative_noise_gain
from rigsim.rig.arrays import AnyImage, Array, Mask
from rigsim.rig.observations import Observations
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import inner_range

_LEAST_SCORE = 0.7  # by chance alone the best of a thousand places reaches 0.6
_UNIQUENESS = 0.1  # half a pixel of phase alone lowers a correlation by nearly as much
_LEFT_RIGHT_PX = 1.5
_WORST_STD_PX = 0.5
_NOISE_EXCESS = 4.0  # a residual this many times the noise's variance ...
_UNEXPLAINED = 0.05  # ... and this share of the squared gradient is another surface, not noise
_MOST_NOISE_SHARE = 0.6  # of the gradient's energy: beyond, a match's accuracy is a guess
_LEAST_ON_PLANE = 0.2  # share of neighbours on a match's own plane; below it, the plane spans two surfaces
_OFF_PLANE_FACTOR = 1.3  # how much less to trust a match none of whose neighbours is on its plane
_ONE_WAY = 1.5  # what is bent one way only, as a branch, shows less of its bend to neighbours all around
_UNKNOWN_FACTOR = 2.0  # and one without neighbours
_EXCESS_FROM = 1.15  # a residual's variance scatters by a tenth; beyond this it is texture that does not fit,
_EXCESS_STD = 1.5  # which is no white noise: it adds up to so many times what the noise does
_JACKKNIFE_NOISE = 2.0  # of nine blocks the variance scatters by half: this much may be chance
_CURVATURE_NOISE = 4.0
_MODEL_SHARE = 0.4  # of what leaving out and bending move the answer by; fitted to the bundled scenes' truth
_INTERPOLATION_PX = 5e-4
_INTERPOLATION_SHARE = 0.1  # of the spline's error that its correction leaves
_ALIASED_SHARE = 1.0  # and what aliasing makes of the same fine texture, where half of the fits leave over
_ALIASED = (1.1, 0.1)  # a tenth more than noise, or more: of noise alone it would be a twentieth
_TEXTURE_SHARE = 0.25  # where fine texture is everywhere it is taken for noise: not for more than this
_ROUNDING = 1e-8
_ENOUGH = 20
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

    Raises:
        InvalidImage: a picture cannot be measured, or does not fit the other or the rig.
        InvalidRange: the window, the number of points or the disparity range is none.
        MeasurementFailed: nothing to match, or nothing matched.
    """
    _check(n_points, window, disparity_range)
    radius = window // 2
    left, right = grey(image_left, "left image"), grey(image_right, "right image")
    same_size(left, right)
    fits_rig(left, rig)
    rounding_var = (quantization_var(image_left) + quantization_var(image_right)) / 2
    rectification = rectify(rig)
    left, right, on_left, on_right = rectification.warp(left, right)
    low, high = _search_range(rectification.rig, disparity_range)
    height, width = left.shape
    if min(height, width) < window + 2:
        raise MeasurementFailed(
            f"images of {width} x {height} px hold no {window} x {window} px window and its border: choose a "
            "smaller window"
        )

    gradient = RowSpline.through(left).derivative()
    rough_noise_var = (estimate_noise(left) ** 2 + estimate_noise(right) ** 2) / 2
    gradient_noise_var = min(
        derivative_noise_gain() * rough_noise_var, _TEXTURE_SHARE * float(np.mean(gradient**2))
    )
    uv = interest_points(
        gradient,
        whole_windows(on_left, radius + 1),
        n_points,
        radius=radius,
        noise_var=max(gradient_noise_var, _ROUNDING * float(np.var(left))),
    )
    if not len(uv):
        raise MeasurementFailed(f"left image: no texture along the rows in any {window} x {window} px window")

    coarse, kept = _coarse(
        Blurred.of(left, on_left, radius), Blurred.of(right, on_right, radius), uv, low, high
    )
    if not kept.any():
        raise MeasurementFailed(
            f"none of {len(uv)} points of the left image was found in the right one at disparities {low} to "
            f"{high} px: check that left and right are not swapped and that the rig fits them"
        )
    right_spline = RowSpline.through(right)
    fits = fit_patches(
        left,
        gradient,
        right_spline,
        uv[kept],
        coarse.disparity[kept],
        radius=radius,
        noise_var=gradient_noise_var / derivative_noise_gain(),
    )
    noise_var = max(_noise_var(fits, rough_noise_var), rounding_var)
    std, noise_std = predicted_std(fits, noise_var)
    same_surface = (fits.noise_var < _NOISE_EXCESS * noise_var) | (
        fits.noise_var < _UNEXPLAINED * fits.gradient_energy
    )
    trusted = np.isfinite(fits.disparity) & same_surface & (std < _WORST_STD_PX)
    trusted &= noise_share(fits, noise_var) < _MOST_NOISE_SHARE
    outvoted, on_plane, bend = borne_out(fits, trusted, std, noise_std, window=window)
    trusted &= ~outvoted & ~(on_plane < _LEAST_ON_PLANE)
    std = np.hypot(std, _ONE_WAY * bend)
    std *= np.where(np.isnan(on_plane), _UNKNOWN_FACTOR, 1 + _OFF_PLANE_FACTOR * (1 - on_plane))
    if not trusted.any():
        raise MeasurementFailed(
            f"none of {int(kept.sum())} matches could be refined: the images differ by more than shifts along"
            " the rows; check that the pair is rectified as the rig says"
        )
    epipolar = epipolar_offsets(left, right_spline, uv[kept], fits, radius=radius)

    where = np.flatnonzero(kept)[trusted]
    valid = np.zeros(len(uv), dtype=bool)
    valid[where] = True

    def spread(values: Array) -> Array:
        full = np.full((len(uv), *values.shape[1:]), np.nan)
        full[where] = values[trusted]
        return full

    uv_left = fits.uv_left
    uv_right = uv_left - np.stack([fits.disparity, np.zeros_like(fits.disparity)], axis=1)
    if rectification.rig is not rig:
        uv_left, uv_right = rectification.left_pixels(uv_left), rectification.right_pixels(uv_right)
    return PatchMatches(
        observations=Observations(spread(uv_left), spread(uv_right), valid),
        disparity=spread(fits.disparity),
        disparity_std_px=spread(std),
        noise_disparity_std_px=spread(noise_std),
        score=spread(coarse.score[kept]),
        epipolar_px=spread(epipolar),
        noise_std_grey=float(np.sqrt(noise_var)),
    )


def predicted_std(fits: Fits, noise_var: float) -> tuple[Array, Array]:
    """Standard deviation of the disparities, and the part of it that noise explains, (N,) each, px.

    Args:
        fits: the fits.
        noise_var: least variance of one image's noise, grey^2; a fit that leaves more over has more.
    """
    local_var = np.maximum(fits.noise_var, noise_var)
    residual_std = np.sqrt(local_var * fits.noise_weight)
    # the template's gradient is noisy too: what it adds to the energy carries no information
    share = np.minimum(noise_share(fits, noise_var), 0.9)
    noise_std = fits.noise_std * residual_std / (1 - share)
    bend_std = fits.curvature_noise_std * residual_std
    parts = np.maximum(fits.jackknife_std**2 - _JACKKNIFE_NOISE * noise_std**2, 0)
    bend = np.maximum(fits.curvature_px**2 - _CURVATURE_NOISE * bend_std**2, 0)
    excess = np.clip(fits.noise_var / noise_var - _EXCESS_FROM, 0, 1)
    misfit = excess * (_EXCESS_STD * fits.noise_std) ** 2 * noise_var * fits.noise_weight
    known = fits.noise_var[np.isfinite(fits.noise_var)]
    typical = float(np.median(known)) / noise_var if len(known) >= _ENOUGH and noise_var > 0 else 1.0
    aliased = float(np.clip((typical - _ALIASED[0]) / _ALIASED[1], 0, 1))
    fine = (_INTERPOLATION_SHARE + _ALIASED_SHARE * aliased) * fits.interpolation_px
    spline = _INTERPOLATION_PX**2 + fine**2
    return np.sqrt(noise_std**2 + _MODEL_SHARE * (parts + bend) + misfit + spline), noise_std


def noise_share(fits: Fits, noise_var: Array | float) -> Array:
    """Share of the gradient's energy that is noise of variance `noise_var` grey^2, (N,)."""
    return np.asarray(derivative_noise_gain() * noise_var / fits.gradient_energy)


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


def _coarse(left: Blurred, right: Blurred, uv: Indices, low: int, high: int) -> tuple[Correlations, Mask]:
    """Whole-pixel matches of `uv`, and which are good, alone, and the same from right to left."""
    there = correlate(left, right, uv, low, high)
    kept = _is_unique(there)
    uv_right = uv[kept]
    uv_right[:, 0] -= there.disparity[kept].astype(np.intp)
    back = correlate(right, left, uv_right, -high, -low)
    # a repeating texture's hidden part is found elsewhere: only the way back sees that there are two
    same = np.abs(there.disparity[kept] + back.disparity) <= _LEFT_RIGHT_PX
    kept[kept] = same & _is_unique(back)
    return there, kept


def _is_unique(found: Correlations) -> Mask:
    return (found.score > _LEAST_SCORE) & (found.score - found.second_score > _UNIQUENESS)


def _noise_var(fits: Fits, fallback: float) -> float:
    """Variance of one image's noise, grey^2: what the best quarter of the fits leaves over."""
    left_over = fits.noise_var[np.isfinite(fits.disparity)]
    return float(np.quantile(left_over, 0.25)) if len(left_over) >= _ENOUGH else fallback
