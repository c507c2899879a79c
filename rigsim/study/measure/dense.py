"""Dense disparities of somebody's pair, whatever rig it was taken with."""

from __future__ import annotations

import numpy as np

from rigsim.pixels.dense.dense import dense_disparity
from rigsim.pixels.dense.matcher import Matcher
from rigsim.pixels.dense.pair import where_seen
from rigsim.pixels.dense.quality import DepthQuality, depth_quality
from rigsim.pixels.dense.rectify import Rectification, rectify
from rigsim.pixels.dense.views import RowView
from rigsim.rig.arrays import AnyImage, Array, Mask
from rigsim.rig.stereo import StereoRig
from rigsim.study.measure.result import DenseMap, Target
from rigsim.study.measure.truth import dense_errors


def dense_map(
    pair: tuple[AnyImage, AnyImage],
    rig: StereoRig,
    *,
    matcher: Matcher,
    disparity_range: tuple[float, float] | None,
    timeout_s: float,
    truth: Array | None,
    view: RowView | None = None,
) -> DenseMap:
    """Dense disparities of a pair, which is rectified first when its rig is not; see `measure_pair`.

    Raises:
        MeasurementFailed: the pair cannot be rectified, or the matcher failed.
    """
    image_left, image_right = pair
    rectification = rectify(rig, view)
    rectified = rectification.rig is not rig
    on_both = None
    if rectified:
        image_left, image_right, on_left, on_right = _warped(rectification, image_left, image_right)
        on_both = on_left, on_right
    disparity = dense_disparity(
        image_left,
        image_right,
        rectification.rig,
        matcher,
        disparity_range=disparity_range,
        timeout_s=timeout_s,
    )
    if on_both is not None:
        disparity = where_seen(disparity, *on_both)
    return DenseMap(
        matcher=matcher if isinstance(matcher, str) else getattr(matcher, "__name__", repr(matcher)),
        disparity=disparity,
        rig=rectification.rig,
        rectified=rectified,
        view=rectification.view,
        image_left=image_left,
        image_right=image_right,
        left_from_rectified=rectification.rectified_from_left.T,
        errors=None
        if truth is None or rectified
        else dense_errors(disparity, truth, rectification.rig, image_left),
    )


def _warped(
    rectification: Rectification, image_left: AnyImage, image_right: AnyImage
) -> tuple[AnyImage, AnyImage, Mask, Mask]:
    """Both pictures rectified, in their own type, and where each lies on its original."""
    layers_left = image_left.reshape(*image_left.shape[:2], -1).astype(np.float64)
    layers_right = image_right.reshape(*image_right.shape[:2], -1).astype(np.float64)
    n = min(layers_left.shape[2], layers_right.shape[2])
    warped = [rectification.warp(layers_left[..., i], layers_right[..., i]) for i in range(n)]
    left = _like(image_left, [layer[0] for layer in warped])
    right = _like(image_right, [layer[1] for layer in warped])
    return left, right, warped[0][2], warped[0][3]


def _like(image: AnyImage, layers: list[Array]) -> AnyImage:
    picture = np.stack(layers, axis=-1).squeeze()
    if image.dtype.kind == "u":
        picture = np.clip(np.round(picture), 0, np.iinfo(image.dtype).max)
    return picture.astype(image.dtype)


def target_quality(dense: DenseMap, truth: Array | None, target: Target) -> DepthQuality:
    """The Depth Quality Tool's metrics of a flat target; a truth gives its distance."""
    u, v, width, height = target
    region = np.zeros(dense.disparity.shape, dtype=bool)
    region[v : v + height, u : u + width] = True
    true_m = None
    if truth is not None:
        true_m = depth_quality(truth, dense.rig, region).distance_mm / 1e3
    return depth_quality(dense.disparity, dense.rig, region, truth_m=true_m)
