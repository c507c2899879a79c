"""The metrics of Intel's RealSense Depth Quality Tool, for any disparity map of a flat target.

Definitions as in the tool's own documentation (librealsense, tools/depth-quality). A plane is fitted
to the points of the region by orthogonal least squares; then the nearest and the farthest 0.5 % of them
are left out. With ``e_i`` the distance of point i from the plane, positive behind it, and ``P_i`` its
foot on the plane::

    fill rate      100 * points / pixels of the region
    plane-fit RMS  sqrt(mean e_i^2)
    sub-pixel RMS  sqrt(mean (b f / Z_i - b f / Z(P_i))^2)
    Z accuracy     100 * median(Z_plane - Z_truth + e_i) / Z_truth

``Z_plane`` is where the plane meets the middle of the image, so a tilted target must have its true
distance measured there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRange, MeasurementFailed
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import rms

_TRIMMED = 200  # one in 200 at either end: 0.5 %


@dataclass(frozen=True, slots=True)
class DepthQuality:
    """Metrics of one flat target."""

    fill_rate_pct: float
    """Share of the region's pixels with a disparity in front of the camera, percent."""
    distance_mm: float
    """Depth at which the fitted plane meets the middle of the image, mm."""
    plane_fit_rms_mm: float
    """RMS distance from the fitted plane, mm."""
    plane_fit_rms_pct: float
    """The same as a share of `distance_mm`, percent."""
    subpixel_rms_px: float
    """RMS disparity error against the fitted plane, px."""
    z_accuracy_pct: float
    """Median error against the true distance, percent of it; positive is too far. NaN without truth."""


def depth_quality(
    disparity: Array, rig: StereoRig, region: Mask | None = None, *, truth_m: float | None = None
) -> DepthQuality:
    """Judge a disparity map (H, W), NaN unknown, of a flat target that fills `region` (H, W).

    Args:
        disparity: ``u_left - u_right``, px.
        rig: the rectified rig it was measured with.
        region: the target's pixels; all by default.
        truth_m: the target's true depth in the middle of the image, m.

    Raises:
        InvalidRange: the true distance is not positive.
        MeasurementFailed: fewer than three points, or all on a line: they span no plane.
    """
    if truth_m is not None and not (math.isfinite(truth_m) and truth_m > 0):
        raise InvalidRange(f"true distance {truth_m * 1e3:g} mm: must be > 0")
    inside = np.ones(disparity.shape, dtype=bool) if region is None else region
    focal_baseline = rig.left.fx * rig.baseline_m
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = focal_baseline / (disparity + rig.doffs_px)
        measured = inside & np.isfinite(depth) & (depth > 0)
    v, u = np.nonzero(measured)
    z = depth[measured]
    normalized = rig.left.normalize(np.stack([u, v], axis=1))
    points = np.concatenate([normalized * z[:, None], z[:, None]], axis=1)
    normal, middle = _plane(points)

    axis = np.append(rig.left.normalize(np.array([(rig.left.width - 1) / 2, (rig.left.height - 1) / 2])), 1.0)
    distance = float(middle @ normal / (axis @ normal))
    order = np.argsort(z, kind="stable")
    cut = len(order) // _TRIMMED
    kept = points[order[cut : len(order) - cut]]
    error = (kept - middle) @ normal
    foot_z = kept[:, 2] - error * normal[2]
    off_m = rms(error)
    accuracy = math.nan
    if truth_m is not None:
        accuracy = 100.0 * float(np.median(distance - truth_m + error)) / truth_m
    return DepthQuality(
        fill_rate_pct=100.0 * len(z) / max(int(inside.sum()), 1),
        distance_mm=distance * 1e3,
        plane_fit_rms_mm=off_m * 1e3,
        plane_fit_rms_pct=100.0 * off_m / distance,
        subpixel_rms_px=rms(focal_baseline / kept[:, 2] - focal_baseline / foot_z),
        z_accuracy_pct=accuracy,
    )


def _plane(points: Array) -> tuple[Array, Array]:
    """Unit normal (3,), pointing away from the camera, and a point (3,) of the plane nearest to `points`."""
    if len(points) >= 3:
        middle = points.mean(axis=0)
        spread, axes = np.linalg.eigh(np.cov((points - middle).T))
        if spread[1] > 1e-9 * spread[2] and abs(axes[2, 0]) > 1e-6:
            return axes[:, 0] * np.sign(axes[2, 0]), middle
    raise MeasurementFailed(f"{len(points)} points of the region span no plane: at least three are needed")
