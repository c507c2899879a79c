"""An inference as a document."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.study.infer.run import CONFIDENCE, Inference, Transfer
from rigsim.study.infer.words import sentence


def inference_document(
    inference: Inference, carried: Transfer | None = None, remarks: Sequence[Remark] = ()
) -> dict[str, object]:
    """The document that ``rigsim infer --json`` prints; docs/reference/infer.md describes it."""
    fit, bias, errors = inference.fit, inference.bias, inference.errors
    sigma = inference.disparity_std_px
    return {
        "disparity_std_px": sigma,
        "disparity_std_ci_low_px": _finite(inference.low_px),
        "disparity_std_ci_high_px": _finite(inference.high_px),
        "confidence_level": CONFIDENCE,
        "interval_from": inference.interval_from,
        "noise_px": sigma / math.sqrt(2),
        "verdict": inference.verdict,
        "says": sentence(inference),
        "fit": None
        if fit is None
        else {
            "best": fit.best,
            "exponent": fit.exponent,
            "exponent_ci_low": fit.exponent_low,
            "exponent_ci_high": fit.exponent_high,
            **{f"{law}_misfit_pct": 100 * misfit for law, misfit in fit.misfit.items()},
        },
        "bias": None
        if bias is None
        else {
            "disparity_offset_px": bias.disparity_offset_px,
            "disparity_offset_se_px": _finite(bias.disparity_offset_se_px),
            "disparity_offset_ci_low_px": _finite(bias.offset_interval_px[0]),
            "disparity_offset_ci_high_px": _finite(bias.offset_interval_px[1]),
            "scale_pct": _finite(100 * bias.scale),
            "scale_se_pct": _finite(100 * bias.scale_se),
            "scale_ci_low_pct": _finite(100 * bias.scale_interval[0]),
            "scale_ci_high_pct": _finite(100 * bias.scale_interval[1]),
            "left_rms_mm": bias.left_rms_m * 1e3,
            "share_of_mean_square_pct": 100 * bias.share,
        },
        "rig": _rig(inference.rig),
        "rows": [
            {
                "distance_mm": float(depth) * 1e3,
                "depth_std_mm": float(std) * 1e3,
                "explained_depth_std_mm": float(sigma * gain) * 1e3,
                "disparity_std_px": float(std / gain),
            }
            for depth, std, gain in zip(errors.depths_m, errors.stds_m, inference.gains_m_per_px, strict=True)
        ],
        "transfer": None
        if carried is None
        else {
            "rig": _rig(carried.rig),
            "rows": [
                {
                    "distance_mm": float(carried.depths_m[i]) * 1e3,
                    "depth_std_mm": float(carried.stds_m[i]) * 1e3,
                    "depth_std_ci_low_mm": _finite(float(carried.lows_m[i]) * 1e3),
                    "depth_std_ci_high_mm": _finite(float(carried.highs_m[i]) * 1e3),
                    "trusted": bool(carried.trusted[i]),
                }
                for i in range(len(carried.depths_m))
            ],
        },
        "remarks": [{"code": remark.code, "text": remark.text} for remark in remarks],
    }


def _rig(rig: StereoRig) -> dict[str, object]:
    return {
        "baseline_mm": rig.baseline_m * 1e3,
        "focal_px": rig.left.fx,
        "width_px": rig.left.width,
        "height_px": rig.left.height,
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
