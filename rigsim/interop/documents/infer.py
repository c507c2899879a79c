"""What `rigsim infer --json` prints."""

from __future__ import annotations

from typing import Literal

from rigsim.interop.documents.base import Part, RemarkPart, Rig


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
    """One distance of the rig that the noise is carried over to."""

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
    """The noise carried over to another rig."""

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
    """Null without --to."""
    remarks: list[RemarkPart]
    """What is odd about it; also on standard error."""
