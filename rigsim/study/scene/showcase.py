"""The one configuration of a sweep that is shown in detail."""

from __future__ import annotations

from dataclasses import dataclass

from rigsim.pixels.dense.views import RowView
from rigsim.rig.arrays import Array, Image, Mask
from rigsim.rig.noise import PixelNoise
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig


@dataclass(frozen=True, slots=True, eq=False)
class Showcase:
    """The one configuration that is shown in detail: its pictures and its points."""

    row: int
    """Its place in `SweepResult.rows`."""
    rig: StereoRig
    """The rig."""
    noise: PixelNoise
    """Noise of the simulated observations."""
    image_left: Image
    """Rendered left image, (H, W, 3)."""
    image_right: Image
    """Rendered right image, (H, W, 3)."""
    points_left: Array
    """Truth points in the left camera's frame, (N, 3), m."""
    visible: Mask
    """Whether the point is seen by both cameras, (N,)."""
    sensor: Sensor
    """Lens and sensor that the pictures were taken with; the default is the ideal pinhole."""
    depth_rmse_m: Array
    """Simulated RMS depth error of each point over the trials, (N,), m; NaN where it was not triangulated."""
    view: RowView = "perspective"
    """What the pictures were turned into before they were matched, where they had to be."""
