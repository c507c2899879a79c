"""A disparity for every pixel, by OpenCV's semi-global matcher or by any other.

What is handed back is always ``u_left - u_right`` in px at the pixels of the left image, NaN where the
matcher knows none.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from rigsim.errors import InvalidRange, MeasurementFailed
from rigsim.pixels.dense.matcher import Matcher, MatcherFunction, run_command, run_function, run_named
from rigsim.pixels.dense.views import AxialView
from rigsim.pixels.images import grey, same_size
from rigsim.pixels.opencv import load_cv2
from rigsim.pixels.patches.patches import fits_rig
from rigsim.rig.arrays import AnyImage, Array
from rigsim.rig.stereo import StereoRig

_BLOCK = 5
_SUBPIXEL_STEPS = 16  # OpenCV counts disparities in sixteenths
_COUNT_STEP = 16  # and searches them by sixteens

_LARGEST_PX = 1e6  # no picture is as wide


def dense_disparity(
    image_left: AnyImage,
    image_right: AnyImage,
    rig: StereoRig,
    matcher: Matcher = "sgbm",
    *,
    disparity_range: tuple[float, float] | None = None,
    timeout_s: float = 120.0,
) -> Array:
    """Disparity (H, W) px of a rectified pair, NaN where unknown.

    Args:
        image_left: left picture, (H, W) or (H, W, 3), 8 or 16 bit or floating point.
        image_right: right picture, of the same size.
        rig: the calibration of both.
        matcher: ``"sgbm"``; a callable ``(left, right, rig) -> (H, W)``, which gets the pictures as they are;
            the name of one, ``package.module:function``, which runs in a process of its own; or a command
            with ``{left}``, ``{right}`` and ``{out}`` in it, which gets two PNG files and writes a PFM or NPY
            (`rigsim.pixels.dense.matcher`). Not-finite values count as unknown.
        disparity_range: least and largest disparity that ``sgbm`` searches, px; by default an eighth of
            the width from infinity on (`disparity_search` finds it from distances, and
            `PatchMatches.disparity_range` from matches).
        timeout_s: a named function or a command that takes longer is killed; a callable is not.

    Raises:
        InvalidImage: a picture cannot be measured, or does not fit the other or the rig.
        InvalidRange: the disparity range or the time limit is none.
        MeasurementFailed: the rig is not rectified; or the matcher is unknown, fails, hangs, or returns
            something else than one finite number at least in an (H, W) array.
    """
    if not (math.isfinite(timeout_s) and timeout_s > 0):
        raise InvalidRange(f"time limit {timeout_s:g} s: must be > 0 and finite")
    left, right = grey(image_left, "left image"), grey(image_right, "right image")
    same_size(left, right)
    fits_rig(left, rig)
    if not (rig.is_rectified or isinstance(rig.left.lens, AxialView)):
        raise MeasurementFailed(
            "the rig is not rectified: its rows do not correspond; rectify the pair first "
            "(rigsim.pixels.dense.rectify), or measure patches"
        )
    if matcher == "sgbm":
        return _sgbm(left, right, _search(rig, disparity_range))
    if callable(matcher):
        found = run_function(matcher, image_left, image_right, rig)
    elif "{left}" in matcher or "{right}" in matcher or "{out}" in matcher:
        found = run_command(matcher, image_left, image_right, timeout_s)
    elif ":" in matcher:
        found = run_named(matcher, image_left, image_right, rig, timeout_s)
    else:
        raise MeasurementFailed(
            f"unknown matcher {matcher!r}: choose sgbm, package.module:function, or a command with "
            "{left}, {right} and {out} in it"
        )
    return _checked(found, left.shape, matcher)


def _search(rig: StereoRig, disparity_range: tuple[float, float] | None) -> tuple[int, int]:
    """First disparity and their count, a multiple of 16."""
    if disparity_range is None:
        low, high = -rig.doffs_px, -rig.doffs_px + rig.left.width / 8
    else:
        low, high = disparity_range
        if not (math.isfinite(low) and math.isfinite(high) and low < high):
            raise InvalidRange(f"disparities {low:g} to {high:g} px: must be finite and rise")
        low, high = max(low, -rig.left.width), min(high, rig.left.width)
        if low >= high:
            raise InvalidRange(f"disparities: none lies on an image {rig.left.width} px wide")
    first = math.floor(low) - 1
    count = math.ceil((high + 2 - first) / _COUNT_STEP) * _COUNT_STEP
    return first, count


def _sgbm(left: Array, right: Array, search: tuple[int, int]) -> Array:
    cv2 = load_cv2()
    first, count = search
    width = left.shape[1]
    eight_bit = _eight_bit(left, right)
    # OpenCV leaves out every pixel whose whole search range is not on the right image: widen both
    before, after = max(0, first + count), max(0, -first)
    padded = [cv2.copyMakeBorder(image, 0, 0, before, after, cv2.BORDER_REPLICATE) for image in eight_bit]
    matcher = cv2.StereoSGBM_create(
        minDisparity=first,
        numDisparities=count,
        blockSize=_BLOCK,
        P1=8 * _BLOCK**2,
        P2=32 * _BLOCK**2,
        disp12MaxDiff=1,
        preFilterCap=31,
        uniquenessRatio=10,
        speckleWindowSize=100,
        speckleRange=2,
        mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY,
    )
    try:
        found = matcher.compute(*padded)
    except cv2.error as error:
        raise MeasurementFailed(f"sgbm cannot match {width} x {left.shape[0]} px: {error.err}") from None
    steps = found[:, before : before + width].astype(np.float64)
    disparity = steps / _SUBPIXEL_STEPS
    u_right = np.arange(width) - disparity
    known = (steps >= first * _SUBPIXEL_STEPS) & (u_right >= -0.5) & (u_right <= width - 0.5)
    if not known.any():
        raise MeasurementFailed(
            f"sgbm found no disparity between {first} and {first + count - 1} px: check that left and right"
            " are not swapped, and the search range"
        )
    return np.where(known, disparity, np.nan)


def _eight_bit(left: Array, right: Array) -> list[npt.NDArray[np.uint8]]:
    """Both images in 0 to 255; deeper or brighter ones are scaled, both alike."""
    low, high = min(left.min(), right.min()), max(left.max(), right.max())
    if low < 0 or high > 255:
        left, right = ((image - low) * (255 / (high - low)) for image in (left, right))
    return [np.round(image).astype(np.uint8) for image in (left, right)]


def _checked(found: Any, shape: tuple[int, ...], matcher: str | MatcherFunction) -> Array:
    name = matcher if isinstance(matcher, str) else getattr(matcher, "__name__", repr(matcher))
    try:
        disparity = np.array(found, dtype=np.float64)
    except (TypeError, ValueError):
        raise MeasurementFailed(
            f"matcher {name} returned {type(found).__name__}: must be an array of numbers, (H, W) = {shape}"
        ) from None
    if disparity.shape != shape:
        raise MeasurementFailed(f"matcher {name} returned shape {disparity.shape}: must be (H, W) = {shape}")
    disparity[~np.isfinite(disparity)] = np.nan
    if np.isnan(disparity).all():
        raise MeasurementFailed(f"matcher {name} returned no finite disparity: nothing is matched")
    largest = float(np.nanmax(np.abs(disparity)))
    if largest > _LARGEST_PX:
        raise MeasurementFailed(
            f"matcher {name} returned a disparity of {largest:.3g} px: must be within +-{_LARGEST_PX:g} px, "
            "or NaN where nothing is matched"
        )
    return disparity
