"""What `rigsim calc ... --json` prints: flat, lengths in mm under names without a unit, as `unit` says."""

from __future__ import annotations

from typing import Literal

from rigsim.interop.documents.base import Part


class CalcDepthDocument(Part):
    """The depth error at a distance."""

    z: float
    """Depth on the left optical axis, mm."""
    focal_px: float
    """Focal length of the left camera, px."""
    disparity_px: float
    """``u_left - u_right``, px."""
    world_per_pixel: float
    """Width of a pixel at this depth, mm."""
    depth_std: float | None
    """Standard deviation of the depth for this noise, mm."""
    depth_near: float | None
    """Nearest depth when the disparity is off by its error, mm."""
    depth_far: float | None
    """Farthest depth when the disparity is off by its error, mm; null without bound."""
    depth_bias: float | None
    """Mean error of many noisy measurements, mm."""
    unit: Literal["mm"]
    """Unit of the keys that name none."""


class CalcPointDocument(Part):
    """A point seen in both images, in the left camera's frame."""

    x: float
    """Right of the left camera, mm."""
    y: float
    """Below the left camera, mm."""
    z: float
    """Depth, in front of the left camera, mm."""
    disparity_px: float
    """``u_left - u_right``, px."""
    world_per_pixel: float
    """Width of a pixel at this depth, mm."""
    depth_std: float | None
    """Standard deviation of the depth for this noise, mm."""
    depth_near: float | None
    """Nearest depth when the disparity is off by its error, mm."""
    depth_far: float | None
    """Farthest depth when the disparity is off by its error, mm; null without bound."""
    unit: Literal["mm"]
    """Unit of the keys that name none."""


class CalcLimitsDocument(Part):
    """What a rig can see at all."""

    focal_px: float
    """Focal length of the left camera, px."""
    hfov_deg: float
    """Horizontal field of view of the left camera, degrees."""
    min_depth: float | None
    """Depth of the largest disparity searched, mm; null for a rig that is not rectified."""
    max_depth: float | None
    """Depth of the smallest disparity searched, mm; null without bound or when not rectified."""
    overlap_fov_deg: float
    """Angle that both cameras see far away, degrees."""
    blind_zone: float | None
    """Nearer, no point is seen by both, mm; null when they never share a point."""
    overlap_width: float
    """Width that both see at --z, mm."""
    overlap_fraction: float
    """The same as a share of the left image."""
    dead_band_px: float
    """Left image columns unseen by the right camera at --z, px."""
    dead_band: float
    """Their width in the scene, mm."""
    depth_step: float | None
    """Depth of one pixel of disparity at --z, mm."""
    unit: Literal["mm"]
    """Unit of the keys that name none."""
