"""Dense disparities of a pair that may have to be rectified first."""

from __future__ import annotations

import numpy as np

from rigsim.pixels.dense.dense import dense_disparity
from rigsim.pixels.dense.rectify import Rectification, rectify
from rigsim.pixels.dense.views import RowView
from rigsim.pixels.images import grey, same_size
from rigsim.pixels.patches.patches import fits_rig
from rigsim.rig.arrays import AnyImage, Array, Mask
from rigsim.rig.stereo import StereoRig


def dense_of_any(
    image_left: AnyImage, image_right: AnyImage, rig: StereoRig, *, view: RowView | None = None
) -> tuple[Array, Rectification]:
    """Disparities (H, W) px by sgbm on the rectified left picture, NaN where unknown; and what it is.

    A rectified rig's pictures are taken as they are.

    Args:
        image_left: left picture, (H, W) or (H, W, 3), 8 or 16 bit or floating point.
        image_right: right picture, of the same size.
        rig: the calibration of both.
        view: what the pair is turned into, see `rigsim.pixels.dense.rectify.rectify`.

    Raises:
        InvalidImage: a picture cannot be measured, or does not fit the other or the rig.
        MeasurementFailed: the pair cannot be rectified, or nothing is matched.
    """
    rectification = rectify(rig, view)
    if rectification.rig is rig:
        return dense_disparity(image_left, image_right, rig), rectification
    left, right = grey(image_left, "left image"), grey(image_right, "right image")
    same_size(left, right)
    fits_rig(left, rig)
    left, right, on_left, on_right = rectification.warp(left, right)
    disparity = dense_disparity(left, right, rectification.rig)
    return where_seen(disparity, on_left, on_right), rectification


def where_seen(disparity: Array, on_left: Mask, on_right: Mask) -> Array:
    """The disparities (H, W) of what lies on both pictures; NaN on the made-up rim of a rectified pair."""
    v, u = np.indices(disparity.shape)
    landing = np.round(u - np.where(np.isfinite(disparity), disparity, 0.0)).astype(np.intp)
    on_image = (landing >= 0) & (landing < disparity.shape[1])
    seen = on_left & on_image & on_right[v, np.where(on_image, landing, 0)]
    return np.where(seen, disparity, np.nan)
