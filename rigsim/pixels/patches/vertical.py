"""How far one picture of a pair is too low: matches looked for on other rows than their own.

A pair that is a few rows off hardly matches along its rows, and what does match is chance. So a few hundred
windows of the left picture, made smaller, are looked for in a band of rows above and below, and vote.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from rigsim.errors import MeasurementFailed
from rigsim.pixels.dense.rectify import rectify
from rigsim.pixels.dense.views import RowView
from rigsim.pixels.images import grey
from rigsim.pixels.patches.coarse import Blurred, correlate, whole_windows
from rigsim.pixels.patches.interest import estimate_noise, interest_points
from rigsim.pixels.patches.patches import PatchMatches, match_patches
from rigsim.pixels.patches.spline import Indices, RowSpline
from rigsim.rig.arrays import AnyImage, Array, Mask
from rigsim.rig.stereo import StereoRig

BAND = 0.11
"""Rows looked at above and below, share of the picture's height."""

_WIDTH_PX = 320
_POINTS = 250
_RADIUS = 5
_LEAST_SCORE = 0.75
_LEAST_VOTES = 10
_LEAST_SHARE = 0.2  # of all that found something; chance gives three rows of a band of 50 a sixteenth
_NEAR = 1


@dataclass(frozen=True, slots=True, eq=False)
class VerticalShift:
    """Rows that a right picture is too low, and what matches once it is moved back."""

    rows_px: float
    """How far too low the right picture is, px of the rectified pair; negative is too high."""
    votes: int
    """How many windows say so."""
    voters: int
    """How many found something on some row."""
    matches: PatchMatches
    """Matches of the rectified pair with the right picture moved back by whole rows."""
    moved_px: int
    """By how many."""


def find_vertical_shift(
    image_left: AnyImage,
    image_right: AnyImage,
    rig: StereoRig,
    *,
    disparity_range: tuple[float, float] | None = None,
    view: RowView | None = None,
) -> VerticalShift | None:
    """The vertical shift, up to a tenth of the height, that the pictures agree on; None when there is none.

    Arguments as in `match_patches`.

    Raises:
        InvalidImage: a picture cannot be measured.
        MeasurementFailed: the pair cannot be rectified.
    """
    rectification = rectify(rig, view)
    rectified = rectification.rig
    left, right, on_left, on_right = rectification.warp(
        grey(image_left, "left image"), grey(image_right, "right image")
    )
    voted = _vote(left, right, on_left, on_right, rectified, disparity_range)
    if voted is None:
        return None
    rows, votes, voters = voted
    # what lies in row v + rows comes to row v
    moved = np.full_like(right, right.mean())
    kept = slice(max(0, -rows), len(right) - max(0, rows))
    moved[kept] = right[kept.start + rows : kept.stop + rows]
    try:
        matches = match_patches(left, moved, rectified, n_points=600, disparity_range=disparity_range)
    except MeasurementFailed:
        return None
    known = matches.epipolar_px[np.isfinite(matches.epipolar_px)]
    if len(known) < _LEAST_VOTES:
        return None
    return VerticalShift(rows + float(np.median(known)), votes, voters, matches, rows)


def _vote(
    left: Array,
    right: Array,
    on_left: Mask,
    on_right: Mask,
    rig: StereoRig,
    disparity_range: tuple[float, float] | None,
) -> tuple[int, int, int] | None:
    """Whole rows of the full picture, how many windows vote for them, and how many vote at all."""
    k = max(1, round(left.shape[1] / _WIDTH_PX))
    left, right = _smaller(left, k), _smaller(right, k)
    usable_left, usable_right = (_smaller(on.astype(float), k) == 1 for on in (on_left, on_right))
    height, width = left.shape
    if min(height, width) < 4 * _RADIUS:
        return None
    uv = _points(left, usable_left)
    if not len(uv):
        return None
    low, high = disparity_range or (-rig.doffs_px - 1, width * k)
    low, high = math.floor(max(low / k, 1 - width)), math.ceil(min(high / k, width - 1))
    band = math.ceil(BAND * height)
    template = Blurred.of(left, usable_left, _RADIUS)
    other = Blurred.of(right, usable_right, _RADIUS)
    offsets = np.arange(-band, band + 1)
    scores = np.stack(
        [
            correlate(template, _lowered(other, int(rows)), uv, low, max(high, low + 1)).score
            for rows in offsets
        ]
    )
    scores = np.nan_to_num(scores, nan=-1.0)
    best = scores.argmax(axis=0)
    voting = scores.max(axis=0) > _LEAST_SCORE
    counts = np.bincount(best[voting], minlength=len(offsets))
    near = np.convolve(counts, np.ones(2 * _NEAR + 1), mode="same")
    winner = int(near.argmax())
    votes, voters = int(near[winner]), int(voting.sum())
    if votes < max(_LEAST_VOTES, _LEAST_SHARE * voters):
        return None
    around = slice(max(0, winner - _NEAR), winner + _NEAR + 1)
    mean = float(np.average(offsets[around], weights=counts[around]))
    return round(k * mean), votes, voters


def _points(image: Array, usable: Mask) -> Indices:
    gradient = RowSpline.through(image).derivative()
    noise_var = min(2 * estimate_noise(image) ** 2, 0.25 * float(np.mean(gradient**2)))
    return interest_points(
        gradient,
        whole_windows(usable, _RADIUS + 1),
        _POINTS,
        radius=_RADIUS,
        noise_var=max(noise_var, 1e-8 * float(np.var(image))),
    )


def _lowered(image: Blurred, rows: int) -> Blurred:
    """The picture whose row v is row v + `rows` of `image`."""
    height = len(image.pixels)
    source = np.arange(height) + rows
    inside = (source >= 0) & (source < height)
    source = np.clip(source, 0, height - 1)
    deviation = np.where(inside[:, None], image.deviation[source], np.inf).astype(np.float32)
    return replace(image, pixels=image.pixels[source], deviation=deviation)


def _smaller(image: Array, k: int) -> Array:
    """The mean of every k x k pixels; what is left over at the far borders is cut off."""
    height, width = (size // k * k for size in image.shape)
    return np.asarray(image[:height, :width].reshape(height // k, k, width // k, k).mean(axis=(1, 3)))
