"""Where a disparity map is judged: the regions of Middlebury's evaluation.

Definitions and constants are those of Scharstein & Szeliski, "A taxonomy and evaluation of dense
two-frame stereo correspondence algorithms" (IJCV 2002), section 5.1 and table 3.
"""

from __future__ import annotations

import numpy as np

from rigsim.rig.arrays import Array, Mask

TEXTURELESS_WIDTH_PX = 3
TEXTURELESS_THRESHOLD = 4.0
DISPARITY_GAP_PX = 2.0
DISCONTINUITY_WIDTH_PX = 9

_SAME_SURFACE_PX = 1.0
_PARTS = 3  # neighbours within the gap of 2 px land at most 3 px from each other


def occluded(truth: Array) -> Mask:
    """Left pixels (H, W) that the right image does not show, from the true disparity (H, W), NaN unknown.

    A pixel is occluded when another one of its row lands on the same pixel of the right image with a
    larger (nearer) disparity, or when it lands outside that image. Disparities within 1 px are one surface,
    which a slanted one seen at a steeper angle from the right needs. Unknown pixels are not occluded.
    """
    height, width = truth.shape
    known = np.isfinite(truth)
    nearest = np.full((height, width), -np.inf)
    step = np.diff(truth, axis=1, append=np.nan)
    with np.errstate(invalid="ignore"):
        joined = np.abs(step) <= DISPARITY_GAP_PX
    for part in range(_PARTS):
        # a surface stretched in the right image must leave no holes to look through: go on to the next pixel
        rows, columns = np.nonzero(known if part == 0 else joined)
        share = part / _PARTS
        disparity = truth[rows, columns] + (share * step[rows, columns] if part else 0.0)
        landing = np.round(columns + share - disparity)
        on_image = (landing >= 0) & (landing < width)
        at = landing[on_image].astype(np.intp)
        np.maximum.at(nearest, (rows[on_image], at), disparity[on_image])
    rows, columns = np.nonzero(known)
    landing = np.round(columns - truth[known])
    outside = (landing < 0) | (landing >= width)
    in_front = nearest[rows, np.clip(landing, 0, width - 1).astype(np.intp)]
    hidden = np.zeros(truth.shape, dtype=bool)
    hidden[known] = outside | (in_front > truth[known] + _SAME_SURFACE_PX)
    return hidden


def textureless(image_left: Array) -> Mask:
    """Pixels (H, W) where the squared horizontal gradient, averaged over 3 x 3 px, is below 4 grey^2.

    The gradient is the difference to the pixel on the right, in levels of 8 bit.
    """
    step = np.diff(image_left, axis=1, append=image_left[:, -1:])
    return np.asarray(_box_mean(step**2, TEXTURELESS_WIDTH_PX) < TEXTURELESS_THRESHOLD)


def near_discontinuity(truth: Array) -> Mask:
    """Pixels (H, W) within a 9 x 9 px window of a step of more than 2 px between neighbours' disparities."""
    edge = np.zeros(truth.shape, dtype=bool)
    with np.errstate(invalid="ignore"):
        across = np.abs(np.diff(truth, axis=1)) > DISPARITY_GAP_PX
        down = np.abs(np.diff(truth, axis=0)) > DISPARITY_GAP_PX
    edge[:, 1:] |= across
    edge[:, :-1] |= across
    edge[1:] |= down
    edge[:-1] |= down
    return np.asarray(_box_mean(edge.astype(np.float64), DISCONTINUITY_WIDTH_PX) > 1e-9)


def regions(truth: Array, image_left: Array, *, hidden: Mask | None = None) -> dict[str, Mask]:
    """The regions by name, each (H, W): all, non-occluded, occluded, textureless, near-discontinuity.

    As in the paper, textureless and near-discontinuity leave the occluded pixels out.

    Args:
        truth: true disparity, (H, W), px, NaN unknown.
        image_left: left image, (H, W), grey in levels of 8 bit.
        hidden: occluded pixels when they are known better than `occluded` can tell, (H, W).
    """
    hidden = occluded(truth) if hidden is None else hidden
    known = np.isfinite(truth)
    seen = known & ~hidden
    return {
        "all": known,
        "non-occluded": seen,
        "occluded": known & hidden,
        "textureless": seen & textureless(image_left),
        "near-discontinuity": seen & near_discontinuity(truth),
    }


def _box_mean(values: Array, side: int) -> Array:
    """Mean over `side` x `side` px about each pixel, (H, W); the border's pixels are repeated outwards."""
    half = side // 2
    for axis in (0, 1):
        padding = [(0, 0), (0, 0)]
        padding[axis] = (half + 1, half)
        total = np.cumsum(np.pad(values, padding, mode="edge"), axis=axis)
        values = (
            np.take(total, range(side, total.shape[axis]), axis)
            - np.take(total, range(total.shape[axis] - side), axis)
        ) / side
    return values
