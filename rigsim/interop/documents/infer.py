"""What `rigsim infer --json` prints."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal

from rigsim.interop.documents.base import Part, RemarkPart, Rig, finite, plain_rig
from rigsim.rig.remark import Remark
from rigsim.study.infer.run import CONFIDENCE, Inference
from rigsim.study.infer.run import Transfer as CarriedOver


class Fit(Part):
    """How the errors grow with distance."""

    best: Literal["quadratic", "linear", "constant"]
    """The law that fits best."""
    exponent: float
    """Power of the distance."""
    exponent_ci_low: float
    """Lower end of its interval."""
    exponent_ci_high: float
    """Upper end of its interval."""
    quadratic_misfit_pct: float
    """Relative RMS misfit of the quadratic law, percent."""
    linear_misfit_pct: float
    """Relative RMS misfit of the linear law, percent."""
    constant_misfit_pct: float
    """Relative RMS misfit of a constant, percent."""


class Bias(Part):
    """The mean errors, which are no noise."""

    disparity_offset_px: float
    """Disparity offset that explains them, measured minus true, px."""
    disparity_offset_se_px: float | None
    """Its standard error, px; null where nothing tells it."""
    disparity_offset_ci_low_px: float | None
    """Lower end of its interval, px."""
    disparity_offset_ci_high_px: float | None
    """Upper end of its interval, px."""
    scale_pct: float | None
    """Share of the distance that explains them, percent."""
    scale_se_pct: float | None
    """Its standard error, percent."""
    scale_ci_low_pct: float | None
    """Lower end of its interval, percent."""
    scale_ci_high_pct: float | None
    """Upper end of its interval, percent."""
    left_rms_mm: float
    """RMS that neither explains, mm."""
    share_of_mean_square_pct: float
    """Their share of the mean squared error, percent."""


class Distance(Part):
    """One distance of the claim or test."""

    distance_mm: float
    """The distance, mm."""
    depth_std_mm: float
    """Standard deviation of the depth, as given, mm."""
    explained_depth_std_mm: float
    """What the inferred noise explains, mm."""
    disparity_std_px: float
    """Disparity noise that this distance alone implies, px."""


class Carried(Part):
    """One distance of the rig that the noise is carried over to, which may be the same."""

    distance_mm: float
    """The distance, mm."""
    depth_std_mm: float
    """Standard deviation of the depth, mm."""
    depth_std_ci_low_mm: float | None
    """Lower end of its interval, mm."""
    depth_std_ci_high_mm: float | None
    """Upper end of its interval, mm."""
    trusted: bool
    """Whether the disparity is at least four times its noise."""


class Transfer(Part):
    """The same noise on another rig, or at other distances."""

    rig: Rig
    rows: list[Carried]
    """One for each distance."""


class InferDocument(Part):
    """The disparity noise that explains depth errors at known distances."""

    disparity_std_px: float
    """Standard deviation of the disparity, px."""
    disparity_std_ci_low_px: float | None
    """Lower end of its interval, px; null for fewer than three claims."""
    disparity_std_ci_high_px: float | None
    """Upper end of its interval, px; null for fewer than three claims."""
    confidence_level: float
    """Of the intervals, 0 to 1."""
    interval_from: Literal["samples", "fit", "none"]
    """What they follow from: the counts, the scatter between distances, or nothing."""
    noise_px: float
    """Standard deviation of one pixel coordinate, px: what --noise takes."""
    verdict: Literal["consistent", "inconsistent", "untested"]
    """Whether stereo noise can be behind the errors."""
    says: str
    """The same in a sentence."""
    fit: Fit | None
    """Null when untested."""
    bias: Bias | None
    """Null without mean errors."""
    rig: Rig
    rows: list[Distance]
    """One for each distance."""
    transfer: Transfer | None
    """Null without --to and --at."""
    remarks: list[RemarkPart]
    """What is odd about it; also on standard error."""


def inference_document(
    inference: Inference, says: str, carried: CarriedOver | None = None, remarks: Sequence[Remark] = ()
) -> dict[str, Any]:
    """The document that ``rigsim infer --json`` prints; docs/reference/infer.md describes it.

    Args:
        inference: the noise inferred.
        says: its verdict in a sentence.
        carried: the noise carried over to another rig.
        remarks: what is odd about it.
    """
    errors, sigma = inference.errors, inference.disparity_std_px
    return InferDocument(
        disparity_std_px=sigma,
        disparity_std_ci_low_px=finite(inference.low_px),
        disparity_std_ci_high_px=finite(inference.high_px),
        confidence_level=CONFIDENCE,
        interval_from=inference.interval_from,
        noise_px=sigma / math.sqrt(2),
        verdict=inference.verdict,
        says=says,
        fit=_fit(inference),
        bias=_bias(inference),
        rig=plain_rig(inference.rig),
        rows=[
            Distance(
                distance_mm=float(depth) * 1e3,
                depth_std_mm=float(std) * 1e3,
                explained_depth_std_mm=float(sigma * gain) * 1e3,
                disparity_std_px=float(std / gain),
            )
            for depth, std, gain in zip(errors.depths_m, errors.stds_m, inference.gains_m_per_px, strict=True)
        ],
        transfer=None if carried is None else _transfer(carried),
        remarks=[RemarkPart(code=remark.code, text=remark.text) for remark in remarks],
    ).model_dump()


def _fit(inference: Inference) -> Fit | None:
    fit = inference.fit
    if fit is None:
        return None
    return Fit(
        best=fit.best,
        exponent=fit.exponent,
        exponent_ci_low=fit.exponent_low,
        exponent_ci_high=fit.exponent_high,
        quadratic_misfit_pct=100 * fit.misfit["quadratic"],
        linear_misfit_pct=100 * fit.misfit["linear"],
        constant_misfit_pct=100 * fit.misfit["constant"],
    )


def _bias(inference: Inference) -> Bias | None:
    bias = inference.bias
    if bias is None:
        return None
    return Bias(
        disparity_offset_px=bias.disparity_offset_px,
        disparity_offset_se_px=finite(bias.disparity_offset_se_px),
        disparity_offset_ci_low_px=finite(bias.offset_interval_px[0]),
        disparity_offset_ci_high_px=finite(bias.offset_interval_px[1]),
        scale_pct=finite(100 * bias.scale),
        scale_se_pct=finite(100 * bias.scale_se),
        scale_ci_low_pct=finite(100 * bias.scale_interval[0]),
        scale_ci_high_pct=finite(100 * bias.scale_interval[1]),
        left_rms_mm=bias.left_rms_m * 1e3,
        share_of_mean_square_pct=100 * bias.share,
    )


def _transfer(carried: CarriedOver) -> Transfer:
    return Transfer(
        rig=plain_rig(carried.rig),
        rows=[
            Carried(
                distance_mm=float(carried.depths_m[i]) * 1e3,
                depth_std_mm=float(carried.stds_m[i]) * 1e3,
                depth_std_ci_low_mm=finite(float(carried.lows_m[i]) * 1e3),
                depth_std_ci_high_mm=finite(float(carried.highs_m[i]) * 1e3),
                trusted=bool(carried.trusted[i]),
            )
            for i in range(len(carried.depths_m))
        ],
    )
