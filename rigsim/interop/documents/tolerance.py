"""What `rigsim tolerance --json` prints and tolerance.json holds."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from rigsim.interop.documents.base import Part, Rig


class Required(Part):
    """The depth error that one rig may have."""

    depth_error_mm: float
    """Root mean square over the image, mm."""
    distance_mm: float
    """At this distance, mm."""


class Yield(Part):
    """Share of the built rigs that meet the requirement, 0 to 1."""

    as_built: float
    """With the calibration they were meant to have."""
    recalibrated: float | None
    """After recalibration; null without it."""


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
    """At the required distance, what differs by place in the image, mm."""
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
    """Tolerance that just meets the requirement alone, in its unit; null when any does."""
    needed_equal_share: float | None
    """The same when every quantity takes an equal part of the variance; null when any does."""


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
    first_order_rms_mm: float
    """RMS depth error over rigs and image, to first order, mm."""
    simulated_rms_mm: float | None
    """The same simulated, mm; null where a rig loses a point."""
    first_over_simulated: float
    """Their ratio for the same rigs."""
    flagged: bool
    """Whether it is more than 2 % from 1."""
    per_rig_p50_mm: float | None
    """Median over rigs of each one's RMS depth error, mm."""
    per_rig_p95_mm: float | None
    """95th percentile over rigs, mm."""
    recalibrated_p50_mm: float | None
    """Median after recalibration, mm; null without it."""
    recalibrated_p95_mm: float | None
    """95th percentile after recalibration, mm; null without it."""


class ToleranceDocument(Part):
    """What must be held how tightly, and how many built rigs are good."""

    rig: Rig
    required: Required
    rigs: int
    """How many were built."""
    points: int
    """Points that each was judged by."""
    yields: Yield = Field(alias="yield")
    quantities: list[Quantity]
    """The worst first."""
    interactions: Interactions
    recalibration: Recalibration | None
    """Null without recalibration."""
    depths: list[Depth]
    """Near to far."""
