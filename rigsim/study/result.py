"""What a sweep hands to those who draw and write it."""

from __future__ import annotations

from dataclasses import dataclass, field

import pandas as pd

from rigsim.rig.arrays import Array, Image, Mask
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig

AXES: tuple[str, ...] = (
    "baseline_mm",
    "focal_px",
    "hfov_deg",
    "width_px",
    "height_px",
    "vergence_deg",
    "noise_px",
    "triangulator",
)
"""Columns that say which configuration a row is about."""

ROW_COLUMNS: tuple[str, ...] = (
    "scene",
    *AXES,
    "n_points",
    "n_trials",
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
    "agreement",
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
    depth_rmse_m: Array
    """Simulated RMS depth error of each point over the trials, (N,), m; NaN where it was not triangulated."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """The answer in words, with numbers."""

    headline: str
    """One sentence: the answer."""
    sentences: tuple[str, ...]
    """What else must be known, a sentence each: what limits the rig, what was flagged."""
    agrees: bool
    """Whether no row was flagged."""


@dataclass(frozen=True, slots=True, eq=False)
class SweepResult:
    """Tables, pictures and words of one sweep."""

    rows: pd.DataFrame
    """One row a configuration; `ROW_COLUMNS`."""
    by_depth: pd.DataFrame
    """One row a configuration and bin of depth; `DEPTH_COLUMNS`."""
    swept: tuple[str, ...]
    """The axes that were varied, as columns of `AXES`; dependent ones (focal_px when the resolution
    grows behind a fixed lens) are left out."""
    best: tuple[int, ...]
    """Places in `rows` of the best configurations, best first."""
    limits: tuple[str, ...]
    """What limits each row, in the order of `rows`: "noise", "overlap", ..."""
    lens_note: str
    """What stayed and what changed between resolutions: the lens or the focal length in px."""
    showcase: Showcase
    """The best configuration in detail."""
    verdict: Verdict
    """The answer in words."""
    provenance: dict[str, object] = field(default_factory=dict)
    """Versions, renderer, seed, command: JSON values only."""
    complete: bool = True
    """False when the run was interrupted and holds only the rigs done until then."""
