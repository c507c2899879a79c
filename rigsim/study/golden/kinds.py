"""Which quantity gets which tolerance, by the name that it has in tables and documents.

========== =============================================================================================
kind       what it may differ by
========== =============================================================================================
exact      1e-9 of itself: what was asked, and closed forms of it
predicted  1e-7 of itself where the same points were drawn: closed forms over points of the scene, which rays
           find to 1e-9 m; the noise of the draw where other points were
simulated  1e-6 of itself where the same versions, seed, points and trials made the same noise; else 3
           standard errors of the difference
measured   the same, its standard error being that of the matches in the pictures
share      the same, its standard error being that of a share of so many
count      the same, of a count
label      a word: equal
finding    a word that noise may change: equal where the same noise was made, else not compared
left out   prose, times, versions, and what other numbers of the record say as well
========== =============================================================================================
"""

from __future__ import annotations

from typing import Literal, TypeAlias

Kind: TypeAlias = Literal[
    "exact", "predicted", "simulated", "measured", "share", "count", "label", "finding", "left out"
]

EXACT_RELATIVE = 1e-9
"""What a closed form may differ by, relative."""
POINTS_RELATIVE = 1e-7
"""What a closed form over points that rays found may differ by, relative."""
SMALLEST = 1e-12
"""What any number may differ by, in its own unit: what cancels leaves rounding."""

LEFT_OUT = frozenset(
    (
        "command", "verdict.headline", "verdict.sentences", "says", "reason", "noise_says", "lens_note",
        "remarks", "provenance", "written", "golden", "diagnosis", "compared", "source",
        "complete", "swept", "title", "note",
    )
)  # fmt: skip
"""Keys, or ends of paths, that hold nothing to compare."""

IDENTITY: dict[str, tuple[str, ...]] = {
    "rows": ("rig", "z_mm"),
    "by_depth": ("depth_near_mm", "depth_far_mm"),
    "quantities": ("quantity",),
    "requirements": ("requirement", "statistic", "at_mm"),
    "depths": ("distance_mm",),
    "at": ("z",),
    "tried": ("says",),
}
"""By which keys, besides the swept ones, the rows of a list are told apart; else by their place."""

_OF_SWEEP: dict[str, Kind] = {
    "limited_by": "finding",
    "requirement": "finding",
    "recommended": "left out",
    "verdict": "finding",
    "depth_error_mm": "simulated",
    "ci_low_mm": "simulated",
    "ci_high_mm": "simulated",
    "n_visible": "count",
    "measured_n": "count",
    "scene_fraction": "share",
    "visible_fraction": "share",
    "overlap_fraction": "share",
    "failed_fraction": "share",
    "low_disparity_fraction": "share",
    "measured_outlier_fraction": "share",
    "measured_within_3_sigma": "share",
    "depth_median_mm": "predicted",
    "depth_of_rmse_mm": "predicted",
    "predicted_depth_rmse_mm": "predicted",
    "predicted_depth_rmse_image_mm": "predicted",
    "predicted_far_inverse_depth_rmse_per_m": "predicted",
    "depth_bias_mm": "simulated",
    "depth_rmse_mm": "simulated",
    "depth_rmse_ci_low_mm": "simulated",
    "depth_rmse_ci_high_mm": "simulated",
    "depth_abs_p50_mm": "simulated",
    "depth_abs_p95_mm": "simulated",
    "depth_rmse_pct": "simulated",
    "point_rmse_mm": "simulated",
    "predicted_over_simulated": "simulated",
    "nees": "simulated",
    "depth_rmse_image_mm": "simulated",
    "far_inverse_depth_rmse_per_m": "simulated",
    "measured_pixel_rms_px": "measured",
    "measured_disparity_std_px": "measured",
    "measured_depth_bias_mm": "measured",
    "measured_depth_rmse_mm": "measured",
    "measured_depth_abs_p95_mm": "measured",
    "predicted_from_measured_rmse_mm": "measured",
    "measured_over_predicted": "measured",
    "measured_scale": "measured",
    "measured_scale_ci_low": "measured",
    "measured_scale_ci_high": "measured",
    "agreement": "finding",
    "agreement_witness": "finding",
    "agrees": "finding",
    "best": "finding",
}
_OF_DESIGN: dict[str, Kind] = {
    "limited_by": "finding",
    "simulated": "simulated",
    "measured": "measured",
    "points_n": "count",
    "measured_n": "count",
    "nearest_mm": "finding",
    "farthest_mm": "finding",
    "met": "finding",
    "verdict": "finding",
    "verified": "finding",
    "yield_pct": "share",
    "class": "finding",
    "class_state": "finding",
    "as_built": "share",
    "recalibrated": "share",
    "recalibrated_informed": "share",
    "yield": "share",
    "as_built_enough": "finding",
    "recalibrated_enough": "finding",
    "enough": "finding",
    "as_built_rigs": "finding",
    "recalibrated_rigs": "finding",
}
_OF_TOLERANCE: dict[str, Kind] = {
    "as_built": "share",
    "recalibrated": "share",
    "recalibrated_informed": "share",
    "noticed": "finding",
    "flagged": "finding",
    "first_order_rms_mm": "exact",
    "simulated_rms_mm": "simulated",
    "first_over_simulated": "simulated",
    "sobol_first": "simulated",
    "sobol_total": "simulated",
    "sobol_bias_first": "simulated",
    "sobol_bias_total": "simulated",
    "as_built_px": "simulated",
    "not_rectified_px": "simulated",
    "recalibrated_px": "simulated",
    "recalibrated_informed_px": "simulated",
    "simulated_row_px": "simulated",
    "not_rectified_row_px": "simulated",
    **{
        f"{who}_row_p{level}_px": "simulated"
        for who in ("per_rig", "recalibrated", "informed")
        for level in (50, 95)
    },
    **{
        f"{who}{noise}_p{level}_mm": "simulated"
        for who in ("per_rig", "recalibrated", "informed")
        for noise in ("", "_with_noise")
        for level in (50, 95)
    },
}
_KINDS: dict[str, dict[str, Kind]] = {
    "sweep": _OF_SWEEP,
    "design": _OF_DESIGN | {key: kind for key, kind in _OF_TOLERANCE.items() if key not in _OF_DESIGN},
    "tolerance": _OF_TOLERANCE,
    "table": {key: kind for key, kind in _OF_SWEEP.items() if kind != "finding"},
}


def kind_of(command: str, key: str, path: str, is_word: bool) -> Kind:
    """What a key of a command's rows is; closed forms and labels unless something else is known.

    Args:
        command: as ``sweep`` or ``calc depth``.
        key: the column.
        path: it and those that it stands in, with dots.
        is_word: whether its value is a word.
    """
    if key in LEFT_OUT or path in LEFT_OUT or key.endswith("_se"):
        return "left out"
    return _KINDS.get(command, {}).get(key, "label" if is_word else "exact")
