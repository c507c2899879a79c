"""What the columns of the tables are called and how their values read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rigsim.present.kit import format as fmt


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a table for people."""

    name: str
    """Column of `SweepResult.rows`."""
    heading: str
    """What a person calls it."""
    unit: str
    """Unit of the shown number, "" when it has none."""
    show: Callable[[Any], str]
    """A value as text, without its unit."""

    @property
    def label(self) -> str:
        """Heading and unit, for an axis or a legend: ``baseline, mm``."""
        return f"{self.heading}, {self.unit}" if self.unit else self.heading


def _short(value: float) -> str:
    return fmt.plain(value, 4)


def _column(name: str, heading: str, unit: str, show: Callable[[Any], str] = fmt.number) -> Column:
    return Column(name, heading, unit, show)


COLUMNS: dict[str, Column] = {
    column.name: column
    for column in (
        _column("scene", "scene", "", str),
        _column("baseline_mm", "baseline", "mm", _short),
        _column("focal_px", "focal length", "px", _short),
        _column("hfov_deg", "field of view", "°", lambda value: fmt.plain(value, 3)),
        _column("width_px", "image width", "px", _short),
        _column("height_px", "image height", "px", _short),
        _column("vergence_deg", "vergence", "°", _short),
        _column("noise_px", "pixel noise", "px", _short),
        _column("triangulator", "triangulator", "", str),
        _column("sensor", "sensor", "", str),
        _column("n_points", "points", "", fmt.count),
        _column("n_visible", "points seen by both", "", fmt.count),
        _column("n_trials", "trials", "", fmt.count),
        _column("scene_fraction", "share of the image", "%", fmt.percent),
        _column("visible_fraction", "seen by both", "%", fmt.percent),
        _column("overlap_fraction", "overlap", "%", fmt.percent),
        _column("failed_fraction", "failed", "%", fmt.percent),
        _column("low_disparity_fraction", "low disparity", "%", fmt.percent),
        _column("depth_near_mm", "from depth", "m", lambda value: fmt.number(value / 1e3)),
        _column("depth_far_mm", "to depth", "m", lambda value: fmt.number(value / 1e3)),
        _column("depth_median_mm", "median depth", "m", lambda value: fmt.number(value / 1e3)),
        _column("depth_bias_mm", "bias", "mm"),
        _column("depth_rmse_mm", "depth error RMS", "mm"),
        _column("depth_rmse_ci_low_mm", "95 % from", "mm"),
        _column("depth_rmse_ci_high_mm", "95 % to", "mm"),
        _column("depth_abs_p50_mm", "p50", "mm"),
        _column("depth_abs_p95_mm", "p95", "mm"),
        _column("depth_rmse_pct", "relative RMS", "%"),
        _column("point_rmse_mm", "3-D error RMS", "mm"),
        _column("predicted_depth_rmse_mm", "predicted RMS", "mm"),
        _column("predicted_over_simulated", "predicted / simulated", "", fmt.ratio),
        _column("nees", "NEES", ""),
        _column("depth_rmse_image_mm", "RMS per pixel", "mm"),
        _column("predicted_depth_rmse_image_mm", "predicted RMS per pixel", "mm"),
        _column("measured_method", "measured by", "", str),
        _column("measured_n", "measured points", "", fmt.count),
        _column("measured_outlier_fraction", "outliers", "%", fmt.percent),
        _column("measured_pixel_rms_px", "measured pixel RMS", "px"),
        _column("measured_disparity_std_px", "measured disparity noise", "px"),
        _column("measured_depth_bias_mm", "measured bias", "mm"),
        _column("measured_depth_rmse_mm", "measured RMS", "mm"),
        _column("measured_depth_abs_p95_mm", "measured p95", "mm"),
        _column("predicted_from_measured_rmse_mm", "predicted from measured", "mm"),
        _column("measured_over_predicted", "measured / predicted", "", fmt.ratio),
        _column("measured_scale", "measured / claimed", "", fmt.ratio),
        _column("agreement", "agreement", "", str),
    )
}
"""Every column a report may show, by its name in the table."""
