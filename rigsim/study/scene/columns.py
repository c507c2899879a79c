"""What a sweep hands to those who draw and write it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from rigsim.rig.arrays import Array, Image, Mask
from rigsim.rig.noise import PixelNoise
from rigsim.rig.sensor import Sensor
from rigsim.rig.stereo import StereoRig

Row: TypeAlias = dict[str, str | float | int]
"""One row of a table before it becomes one."""

AXES: tuple[str, ...] = (
    "baseline_mm",
    "focal_px",
    "hfov_deg",
    "width_px",
    "height_px",
    "vergence_deg",
    "noise_px",
    "triangulator",
    "sensor",
)
"""Columns that say which configuration a row is about."""

MEASURED_COLUMNS: tuple[str, ...] = (
    "measured_method",
    "measured_n",
    "measured_outlier_fraction",
    "measured_pixel_rms_px",
    "measured_disparity_std_px",
    "measured_depth_bias_mm",
    "measured_depth_rmse_mm",
    "measured_depth_abs_p95_mm",
    "predicted_from_measured_rmse_mm",
    "measured_over_predicted",
    "measured_within_3_sigma",
    "measured_scale",
    "measured_scale_ci_low",
    "measured_scale_ci_high",
)
"""What the two rendered pictures say: "none", 0 and NaN where nothing was measured. The prediction beside
it is made from the accuracy that the measurement claims for itself, not from `noise_px`."""

ROW_COLUMNS: tuple[str, ...] = (
    "scene",
    *AXES,
    "n_points",
    "n_visible",
    "n_trials",
    "scene_fraction",
    "visible_fraction",
    "overlap_fraction",
    "failed_fraction",
    "low_disparity_fraction",
    "depth_median_mm",
    "depth_bias_mm",
    "depth_rmse_mm",
    "depth_rmse_ci_low_mm",
    "depth_rmse_ci_high_mm",
    "depth_abs_p50_mm",
    "depth_abs_p95_mm",
    "depth_rmse_pct",
    "point_rmse_mm",
    "predicted_depth_rmse_mm",
    "predicted_over_simulated",
    "nees",
    "depth_rmse_image_mm",
    "predicted_depth_rmse_image_mm",
    "far_inverse_depth_rmse_per_m",
    "predicted_far_inverse_depth_rmse_per_m",
    *MEASURED_COLUMNS,
    "agreement",
    "agreement_witness",
)
"""Columns of sweep.csv, in order."""

DEPTH_COLUMNS: tuple[str, ...] = (
    *ROW_COLUMNS[: ROW_COLUMNS.index("n_points")],
    "depth_near_mm",
    "depth_far_mm",
    *ROW_COLUMNS[ROW_COLUMNS.index("n_points") :],
)
"""Columns of sweep_by_depth.csv: those of sweep.csv within one bin of true depth."""


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
