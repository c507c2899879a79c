"""What `rigsim tolerance --json` prints and tolerance.json holds."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from rigsim.interop.documents.base import Part, Rig


class Required(Part):
    """The depth error that one rig may have."""

    depth_error_mm: float
    """Over the image and the pixel noise, mm."""
    distance_mm: float
    """At this distance, mm."""
    statistic: Literal["rms", "p95"]
    """Its root mean square, or what 95 of 100 errors stay under."""


class Yield(Part):
    """Share of the built rigs that meet the requirement, 0 to 1."""

    as_built: float
    """With the calibration they were meant to have."""
    recalibrated: float | None
    """After a recalibration that knows nothing beforehand; null without it."""
    recalibrated_informed: float | None
    """After one that knows the tolerances beforehand; null without it."""


class YieldAlone(Part):
    """Share of the built rigs whose build alone meets the requirement, 0 to 1."""

    as_built: float
    """With the calibration they were meant to have."""
    recalibrated: float | None
    """After a recalibration that knows nothing beforehand; null without it."""
    recalibrated_informed: float | None
    """After one that knows the tolerances beforehand; null without it."""


class Quantity(Part):
    """One quantity that is held within a tolerance."""

    quantity: str
    """What it is; the name ends in its unit."""
    unit: str
    """Its unit; empty for a plain number."""
    tolerance: float
    """How tightly it is held, in that unit."""
    form: Literal["std", "bound"]
    """Whether that is one standard deviation or a bound."""
    source: str
    """Where the tolerance comes from."""
    depth_error_mm: list[float]
    """RMS depth error that it makes alone at each of the distances, mm."""
    common_mm: float
    """At the required distance, what all the image has in common, mm; signed, for a positive deviation."""
    differing_mm: float
    """At the required distance, what varies across the image, mm."""
    variance_share: float
    """Its share of the mean squared depth error there, 0 to 1."""
    sobol_first: float | None
    """First-order Sobol index of a rig's RMS depth error; null where a rig loses a point or not asked."""
    sobol_first_se: float | None
    """Its standard error."""
    sobol_total: float | None
    """Total Sobol index of the same."""
    sobol_total_se: float | None
    """Its standard error."""
    sobol_bias_first: float | None
    """First-order Sobol index of a rig's mean depth error; null where a rig loses a point or not asked."""
    sobol_bias_first_se: float | None
    """Its standard error."""
    sobol_bias_total: float | None
    """Total Sobol index of the same."""
    sobol_bias_total_se: float | None
    """Its standard error."""
    needed_alone: float | None
    """Tolerance with which 95 of 100 rigs meet it with their noise when nothing else is off, in its unit;
    null when any does, 0 where noise alone is too much."""
    needed_equal_share: float | None
    """The same when every quantity takes an equal part of the variance, all at once; null when any does."""


class Interactions(Part):
    """What quantities do together that none does alone."""

    noticed: list[str]
    """Quantities that act on others; empty when none does, or it was not found out."""
    says: str
    """The same in words; may be empty."""


class Recalibration(Part):
    """What each built rig looks at to calibrate itself."""

    features: int
    """Features of unknown place."""
    pictures: int
    """Pictures that are averaged."""
    noise_px: float
    """Noise of one pixel coordinate in one of them, px."""
    averaged_noise_px: float
    """What is left of it, px."""
    known_length_mm: float
    """Length that is known, mm."""
    length_std_mm: float
    """Its standard deviation, mm."""
    says: str
    """The same in words."""


class Depth(Part):
    """The built rigs at one distance."""

    distance_mm: float
    """The distance, mm."""
    noise_mm: float
    """RMS depth error that pixel noise alone makes, mm."""
    first_order_rms_mm: float
    """RMS depth error over rigs and image, to first order, mm."""
    simulated_rms_mm: float | None
    """The same simulated, mm; null where a rig loses a point."""
    first_over_simulated: float
    """Their ratio for the same rigs."""
    flagged: bool
    """Whether it is more than 2 % from 1."""
    per_rig_p50_mm: float | None
    """Median over rigs of the RMS depth error that each one's build alone makes, mm."""
    per_rig_p95_mm: float | None
    """95th percentile over rigs, mm."""
    per_rig_with_noise_p50_mm: float | None
    """Median with pixel noise, mm."""
    per_rig_with_noise_p95_mm: float | None
    """95th percentile with pixel noise, mm."""
    recalibrated_p50_mm: float | None
    """Median after a recalibration that knows nothing beforehand, mm; null without it."""
    recalibrated_p95_mm: float | None
    """95th percentile after it, mm."""
    recalibrated_with_noise_p50_mm: float | None
    """Median after it, with pixel noise, mm."""
    recalibrated_with_noise_p95_mm: float | None
    """95th percentile after it, with pixel noise, mm."""
    informed_p50_mm: float | None
    """Median after a recalibration that knows the tolerances beforehand, mm; null without it."""
    informed_p95_mm: float | None
    """95th percentile after it, mm."""
    informed_with_noise_p50_mm: float | None
    """Median after it, with pixel noise, mm."""
    informed_with_noise_p95_mm: float | None
    """95th percentile after it, with pixel noise, mm."""


class ToleranceDocument(Part):
    """What must be held how tightly, and how many built rigs are good."""

    rig: Rig
    required: Required
    noise_px: float
    """Standard deviation of one pixel coordinate when rigs measure, px."""
    rigs: int
    """How many were built."""
    points: int
    """Points that each was judged by."""
    yields: Yield = Field(alias="yield")
    """With pixel noise."""
    yield_build_alone: YieldAlone
    """As if pixels had no noise."""
    quantities: list[Quantity]
    """The worst first."""
    interactions: Interactions
    recalibration: Recalibration | None
    """Null without recalibration."""
    depths: list[Depth]
    """Near to far."""
