"""A tolerance study as a document and as a table; docs/tolerance.md says what each key means."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from rigsim.rig.arrays import Array
from rigsim.study.tolerance import UNITS, Sensitivity
from rigsim.study.tolerance_words import interactions_sentence, recalibration_sentence
from rigsim.study.tolerance_yield import DepthErrors, Rigs, ToleranceResult

if TYPE_CHECKING:
    import pandas as pd


def tolerance_document(result: ToleranceResult) -> dict[str, Any]:
    """The study with stable keys and units in their names; null where a number has no bound."""
    rig = result.rig
    return {
        "rig": {
            "baseline_mm": rig.baseline_m * 1e3,
            "focal_px": rig.left.fx,
            "width_px": rig.left.width,
            "height_px": rig.left.height,
        },
        "required": {
            "depth_error_mm": result.required.error_m * 1e3,
            "distance_mm": result.required.depth_m * 1e3,
            "statistic": "p95" if result.required.p95 else "rms",
        },
        "noise_px": result.noise_px,
        "rigs": result.n_rigs,
        "points": result.n_points,
        "yield": {
            "as_built": result.yield_before,
            "recalibrated": result.yield_after,
            "recalibrated_informed": result.yield_informed,
        },
        "yield_build_alone": {
            name: None if rigs is None else float(rigs.good_alone.mean())
            for name, rigs in _states(result.judged).items()
        },
        "quantities": [
            {
                **_head(result, item),
                "depth_error_mm": list(item.depth_rms_mm),
                **_rest(result, item),
                "needed_alone": _finite(item.needed_alone),
                "needed_equal_share": _finite(item.needed_equal_share),
            }
            for item in result.sensitivities
        ],
        "interactions": {
            "noticed": []
            if result.interactions is None
            else [result.interactions.keys[place] for place in result.interactions.error.noticed],
            "says": interactions_sentence(result),
        },
        "recalibration": _recalibration(result),
        "depths": [_depth(item) for item in result.depths],
    }


def tolerance_table(result: ToleranceResult) -> pd.DataFrame:
    """One row a quantity, the worst first; the columns of docs/tolerance.md."""
    import pandas as pd  # a document needs none of it

    distances = [item.depth_m * 1e3 for item in result.depths]
    return pd.DataFrame(
        [
            {
                **_head(result, item),
                **{
                    f"depth_error_at_{distance:.10g}_mm": error
                    for distance, error in zip(distances, item.depth_rms_mm, strict=True)
                },
                **_rest(result, item),
                "needed_alone": item.needed_alone,
                "needed_equal_share": item.needed_equal_share,
            }
            for item in result.sensitivities
        ]
    ).replace(math.inf, math.nan)


def percentile_mm(per_rig_mm: Array, percent: float) -> float:
    """A percentile over rigs; infinite where that many lose a point."""
    return float(np.percentile(per_rig_mm, percent, method="higher"))


def _head(result: ToleranceResult, item: Sensitivity) -> dict[str, Any]:
    given = result.tolerances
    return {
        "quantity": item.key,
        "unit": UNITS[item.key],
        "tolerance": item.tolerance,
        "form": "bound" if given.is_bound(item.key) else "std",
        "source": given.source(item.key),
    }


def _rest(result: ToleranceResult, item: Sensitivity) -> dict[str, Any]:
    found: dict[str, Any] = {
        "common_mm": item.common_mm,
        "differing_mm": item.differing_mm,
        "variance_share": item.share,
    }
    both = result.interactions
    place = 0 if both is None else both.place(item.key)
    for name, indices in (
        ("sobol", None if both is None else both.error),
        ("sobol_bias", None if both is None else both.bias),
    ):
        for kind in ("first", "first_se", "total", "total_se"):
            found[f"{name}_{kind}"] = None if indices is None else float(getattr(indices, kind)[place])
    return found


def _recalibration(result: ToleranceResult) -> dict[str, Any] | None:
    session, length_m = result.recalibration, result.known_length_m
    if session is None or length_m is None:
        return None
    return {
        "features": session.features,
        "pictures": session.pictures,
        "noise_px": session.noise_px,
        "averaged_noise_px": session.averaged_px,
        "known_length_mm": length_m * 1e3,
        "length_std_mm": session.length_std_mm,
        "says": recalibration_sentence(result),
    }


def _states(item: DepthErrors) -> dict[str, Rigs | None]:
    return {
        "as_built": item.built,
        "recalibrated": item.recalibrated,
        "recalibrated_informed": item.informed,
    }


def _depth(item: DepthErrors) -> dict[str, Any]:
    found: dict[str, Any] = {
        "distance_mm": item.depth_m * 1e3,
        "noise_mm": item.noise_mm,
        "first_order_rms_mm": item.first_order_mm,
        "simulated_rms_mm": _finite(item.rms_mm),
        "first_over_simulated": item.first_over_simulated,
        "flagged": item.parts,
    }
    for state, name in (
        ("as_built", "per_rig"),
        ("recalibrated", "recalibrated"),
        ("recalibrated_informed", "informed"),
    ):
        rigs = _states(item)[state]
        for head, errors in (
            (name, None if rigs is None else rigs.build_mm),
            (f"{name}_with_noise", None if rigs is None else rigs.whole_mm),
        ):
            for level in (50, 95):
                found[f"{head}_p{level}_mm"] = (
                    None if errors is None else _finite(percentile_mm(errors, level))
                )
    return found


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
