"""A tolerance study as a document and as a table; docs/reference/tolerance.md says what each key means."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from rigsim.study.tolerance.built import percentile_mm
from rigsim.study.tolerance.run import DepthErrors, Rigs, ToleranceResult
from rigsim.study.tolerance.table import quantity_head, quantity_rest
from rigsim.study.tolerance.words import interactions_sentence, recalibration_sentence

if TYPE_CHECKING:
    pass


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
                **quantity_head(result, item),
                "depth_error_mm": list(item.depth_rms_mm),
                **quantity_rest(result, item),
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
