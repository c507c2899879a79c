"""The columns of sweep.csv and sweep_by_depth.csv, each once: name, heading, unit, format and meaning.

The files' order, what pages and consoles call them, the JSON document and the docs are made from here. Code
names a column by its constant: a rename is one line of this file.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, TypeAlias

from rigsim.study.scene.axes import baseline, focal, hfov, noise, registry, resolution, sensor, vergence
from rigsim.study.scene.axes import triangulator as method
from rigsim.study.scene.column import Column, ColumnList

Row: TypeAlias = dict[str, Any]
"""One row of a table before it becomes one; `agreement` is an `Agreement`, all else words and numbers."""

_TABLE = ColumnList()

# what a row is about
SCENE = _TABLE.add("scene", "scene", "", "text", "Name of the scene.", empty=False)
_TABLE.columns.extend(column for axis in registry.ALL for column in axis.columns)
BASELINE = baseline.AXIS.columns[0].name
FOCAL = focal.AXIS.columns[0].name
HFOV = hfov.AXIS.columns[0].name
WIDTH, HEIGHT = (column.name for column in resolution.AXIS.columns)
VERGENCE = vergence.AXIS.columns[0].name
NOISE = noise.AXIS.columns[0].name
TRIANGULATOR = method.AXIS.columns[0].name
SENSOR = sensor.AXIS.columns[0].name
# the edges of a row's bin of depth, which sweep.csv has not
DEPTH_NEAR = _TABLE.add(
    "depth_near_mm", "from depth", "mm", "metres", "Near edge of the bin, mm.", empty=False
)
DEPTH_FAR = _TABLE.add("depth_far_mm", "to depth", "mm", "metres", "Far edge of the bin, mm.", empty=False)

# how many, and how much is seen
N_POINTS = _TABLE.add("n_points", "points", "", "count", "Truth points.", empty=False)
N_VISIBLE = _TABLE.add(
    "n_visible", "points seen by both", "", "count", "Truth points that both cameras see.", empty=False
)
N_TRIALS = _TABLE.add("n_trials", "trials", "", "count", "Noisy repetitions of each.", empty=False)
SCENE_FRACTION = _TABLE.add(
    "scene_fraction",
    "share of the image",
    "",
    "percent",
    "Pixels of the left image that show the scene (within the range, or the bin), of all.",
    empty=False,
)
VISIBLE_FRACTION = _TABLE.add(
    "visible_fraction",
    "seen by both",
    "",
    "percent",
    "Of these pixels, those that show what the right camera sees too.",
    empty=False,
)
OVERLAP_FRACTION = _TABLE.add(
    "overlap_fraction",
    "overlap",
    "",
    "percent",
    "Of these pixels, those that show what lies within the right camera's field of view, hidden or not.",
    empty=False,
)
FAILED_FRACTION = _TABLE.add(
    "failed_fraction",
    "failed",
    "",
    "percent",
    "Triangulations of visible points that gave no point in front of both cameras.",
)
LOW_DISPARITY_FRACTION = _TABLE.add(
    "low_disparity_fraction",
    "low disparity",
    "",
    "percent",
    "Of the pixels that show what both see, those with a depth under 4 of its sigmas; in no RMS.",
)

# the simulation beside the prediction
DEPTH_MEDIAN = _TABLE.add(
    "depth_median_mm",
    "median depth",
    "mm",
    "metres",
    "Median true depth of the points in the statistics, mm.",
)
DEPTH_OF_RMSE = _TABLE.add(
    "depth_of_rmse_mm",
    "depth of the RMS",
    "mm",
    "metres",
    "Depth at which an error that grows by the square of the depth is the RMS: fourth root of the mean "
    "fourth power of the depths in the statistics, mm.",
)
DEPTH_BIAS = _TABLE.add("depth_bias_mm", "bias", "mm", "number", "Simulated mean depth error, mm.")
DEPTH_RMSE = _TABLE.add(
    "depth_rmse_mm",
    "depth error RMS",
    "mm",
    "number",
    "Simulated RMS depth error over the truth points, which are balanced over depth, mm; without the"
    " trials at infinity (1/Z below one standard deviation).",
)
DEPTH_RMSE_CI_LOW = _TABLE.add(
    "depth_rmse_ci_low_mm", "95 % from", "mm", "number", "Lower end of its 95 % confidence interval, mm."
)
DEPTH_RMSE_CI_HIGH = _TABLE.add(
    "depth_rmse_ci_high_mm", "95 % to", "mm", "number", "Upper end of its 95 % confidence interval, mm."
)
DEPTH_ABS_P50 = _TABLE.add("depth_abs_p50_mm", "p50", "mm", "number", "Median absolute depth error, mm.")
DEPTH_ABS_P95 = _TABLE.add(
    "depth_abs_p95_mm", "p95", "mm", "number", "95th percentile of the absolute depth error, mm."
)
DEPTH_RMSE_PCT = _TABLE.add(
    "depth_rmse_pct",
    "relative RMS",
    "%",
    "number",
    "RMS of the depth error over the point's own depth, percent.",
)
POINT_RMSE = _TABLE.add(
    "point_rmse_mm", "3-D error RMS", "mm", "number", "RMS distance between triangulated and true point, mm."
)
PREDICTED_DEPTH_RMSE = _TABLE.add(
    "predicted_depth_rmse_mm",
    "predicted RMS",
    "mm",
    "number",
    "The closed forms' answer for the same points, mm.",
)
PREDICTED_OVER_SIMULATED = _TABLE.add(
    "predicted_over_simulated", "predicted / simulated", "", "ratio", "Ratio of the two."
)
NEES = _TABLE.add(
    "nees",
    "NEES",
    "",
    "number",
    "Mean normalised squared error of (1/Z, X/Z, Y/Z): 3 when the predicted covariance is right.",
)
DEPTH_RMSE_IMAGE = _TABLE.add(
    "depth_rmse_image_mm",
    "RMS per pixel",
    "mm",
    "number",
    "Simulated RMS depth error per pixel of the left image, as of a depth map, mm.",
)
PREDICTED_DEPTH_RMSE_IMAGE = _TABLE.add(
    "predicted_depth_rmse_image_mm",
    "predicted RMS per pixel",
    "mm",
    "number",
    "The closed forms' answer for it, mm.",
)
FAR_INVERSE_DEPTH_RMSE = _TABLE.add(
    "far_inverse_depth_rmse_per_m",
    "far 1/Z RMS",
    "1/m",
    "number",
    "Simulated RMS error of 1/Z of the points kept out of the RMS of depth, 1/m; null without any.",
)
PREDICTED_FAR_INVERSE_DEPTH_RMSE = _TABLE.add(
    "predicted_far_inverse_depth_rmse_per_m",
    "predicted far 1/Z RMS",
    "1/m",
    "number",
    "The closed forms' answer for them, 1/m.",
)

# what the two rendered pictures say: "none", 0 and NaN where nothing was measured
MEASURED_METHOD = _TABLE.add(
    "measured_method",
    "measured by",
    "",
    "text",
    "What was measured in the two pictures: corners, patches, dense or none.",
    empty=False,
)
MEASURED_N = _TABLE.add(
    "measured_n",
    "measured points",
    "",
    "count",
    "Matches that count; 0 when nothing was measured.",
    empty=False,
)
MEASURED_OUTLIER_FRACTION = _TABLE.add(
    "measured_outlier_fraction",
    "outliers",
    "",
    "percent",
    "Matches of nothing that both cameras see, or more than 3 px of disparity off.",
)
MEASURED_PIXEL_RMS = _TABLE.add(
    "measured_pixel_rms_px",
    "measured pixel RMS",
    "px",
    "number",
    "Measured RMS error of one pixel coordinate, px.",
)
MEASURED_DISPARITY_STD = _TABLE.add(
    "measured_disparity_std_px",
    "measured disparity noise",
    "px",
    "number",
    "Measured standard deviation of the disparity's error, px; over sqrt(2) it is a --noise.",
)
MEASURED_DEPTH_BIAS = _TABLE.add(
    "measured_depth_bias_mm",
    "measured bias",
    "mm",
    "number",
    "Mean depth error of the triangulated matches, mm.",
)
MEASURED_DEPTH_RMSE = _TABLE.add(
    "measured_depth_rmse_mm",
    "measured RMS",
    "mm",
    "number",
    "RMS depth error of the triangulated matches, mm.",
)
MEASURED_DEPTH_ABS_P95 = _TABLE.add(
    "measured_depth_abs_p95_mm",
    "measured p95",
    "mm",
    "number",
    "95th percentile of their absolute depth error, mm.",
)
PREDICTED_FROM_MEASURED_RMSE = _TABLE.add(
    "predicted_from_measured_rmse_mm",
    "predicted from measured",
    "mm",
    "number",
    "The closed forms' answer for them, from the accuracy that the measurement claims for itself, mm.",
)
MEASURED_OVER_PREDICTED = _TABLE.add(
    "measured_over_predicted", "measured / predicted", "", "ratio", "Ratio of the two."
)
MEASURED_WITHIN_3_SIGMA = _TABLE.add(
    "measured_within_3_sigma",
    "within 3 sigma",
    "",
    "percent",
    "Share of the matches whose pixel error is within three of the standard deviations they claim.",
)
MEASURED_SCALE = _TABLE.add(
    "measured_scale",
    "measured / claimed",
    "",
    "ratio",
    "Within what nine of ten errors lie, over where the claim puts it: 1 when the claim holds.",
)
MEASURED_SCALE_CI_LOW = _TABLE.add(
    "measured_scale_ci_low",
    "99 % from",
    "",
    "ratio",
    "Lower end of its 99 % interval; 0 with too few points.",
)
MEASURED_SCALE_CI_HIGH = _TABLE.add(
    "measured_scale_ci_high",
    "99 % to",
    "",
    "ratio",
    "Upper end of its 99 % interval; null with too few points.",
)
AGREEMENT = _TABLE.add(
    "agreement",
    "agreement",
    "",
    "text",
    "agrees; flagged: and why; or untold: and why there is not enough to tell.",
    empty=False,
    pattern="^(agrees$|flagged: |untold: )",
)
AGREEMENT_WITNESS = _TABLE.add(
    "agreement_witness",
    "witness",
    "",
    "text",
    "Which witness the reason speaks of: simulated, measured, or neither alone.",
    empty=False,
)

COLUMNS: Mapping[str, Column] = MappingProxyType({column.name: column for column in _TABLE.columns})
"""All of them, by name."""

AXES: tuple[str, ...] = tuple(column.name for axis in registry.ALL for column in axis.columns)
"""Columns that say which configuration a row is about."""

DEPTH_COLUMNS: tuple[str, ...] = tuple(COLUMNS)
"""Columns of sweep_by_depth.csv, in order: those of sweep.csv within one bin of true depth."""

ROW_COLUMNS: tuple[str, ...] = tuple(name for name in COLUMNS if name not in (DEPTH_NEAR, DEPTH_FAR))
"""Columns of sweep.csv, in order."""

ERROR_COLUMNS: tuple[str, ...] = ROW_COLUMNS[ROW_COLUMNS.index(DEPTH_MEDIAN) :]
"""Those that a row without any usable point leaves empty."""

MEASURED_COLUMNS: tuple[str, ...] = ROW_COLUMNS[
    ROW_COLUMNS.index(MEASURED_METHOD) : ROW_COLUMNS.index(AGREEMENT)
]
"""What the two rendered pictures say."""
