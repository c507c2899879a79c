"""The parts of tolerance.json: what its keys mean. Keys stand in the order in which they are written."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from rigsim.interop.documents.base import Golden, Part, RemarkPart, Rig
from rigsim.interop.documents.rows import row_model
from rigsim.study.tolerance.columns import HEAD, REST


class Required(Part):
    """The depth error that one rig may have."""

    depth_error_mm: float
    """Over the image and the pixel noise, mm."""
    distance_mm: float
    """At this distance, mm."""
    statistic: Literal["rms", "p95"]
    """Its root mean square, or what 95 of 100 errors stay under."""
    row_px: float | None
    """Largest RMS row misalignment of a rig over the image, at every distance, px; null for any."""


class Yield(Part):
    """Share of the built rigs that meet the requirement, 0 to 1."""

    as_built: float
    """With the calibration they were meant to have."""
    recalibrated: float | None
    """After a recalibration that does not use the tolerances; null without it."""
    recalibrated_informed: float | None
    """After one that knows the tolerances beforehand; null without it."""


class YieldAlone(Part):
    """Share of the built rigs whose build alone meets the requirement, 0 to 1."""

    as_built: float
    """With the calibration they were meant to have."""
    recalibrated: float | None
    """After a recalibration that does not use the tolerances; null without it."""
    recalibrated_informed: float | None
    """After one that knows the tolerances beforehand; null without it."""


if TYPE_CHECKING:

    class Quantity(Part):
        """The columns of tolerance.csv, with one list of depth errors."""

else:

    class _Errors(row_model("Head", "What a quantity is.", HEAD)):
        depth_error_mm: list[float]
        """RMS depth error that it makes alone at each of the distances, mm."""

    Quantity = row_model("Quantity", "One quantity that is held within a tolerance.", REST, _Errors)


class Rows(Part):
    """How far right rows are off left ones where that is most, root mean square over rigs and image."""

    distance_mm: float
    """The distance where it is most, mm."""
    as_built_px: float | None
    """In the pair that the calibration it was meant to have rectifies, px; null where no rows correspond."""
    not_rectified_px: float | None
    """In the images as they are seen, px."""
    recalibrated_px: float | None
    """After a recalibration that does not use the tolerances, px; null without it."""
    recalibrated_informed_px: float | None
    """After one that knows the tolerances beforehand, px; null without it."""
    kept: Yield | None
    """Share of the rigs that keep the row misalignment asked for, at every distance; null for any."""
    says: str
    """The same in words."""


class Interactions(Part):
    """What quantities do together that none does alone."""

    noticed: list[str]
    """Quantities that act on others; empty when none does, or it was not found out."""
    says: str
    """The same in words; may be empty."""


class Motion(Part):
    """What a time offset between the two pictures acts on."""

    speed_m_s: float
    """Speed along the baseline, m/s."""
    forward_speed_m_s: float
    """Speed straight ahead, m/s."""
    turn_rate_deg_s: float
    """How fast the rig turns to the right, deg/s."""
    moving: Literal["rig", "object"]
    """What the two speeds are of."""


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
    known_lengths_mm: list[float]
    """Lengths that are known, mm: three across the image, near to far, and one along the depth."""
    length_std_mm: float
    """Standard deviation of each, mm."""
    says: str
    """The same in words."""


class OfCalibration(Part):
    """What a calibration leaves, all of its parameters together."""

    file: str
    """The file's name."""
    source: str
    """What it comes from."""
    in_camera_mm: float
    """Standard deviation of the depth that it leaves on the left axis at the required distance, mm, as the
    left camera counts depth: what rigs are judged by."""
    against_boards_mm: float
    """The same against the calibration's boards, mm: where the left lens's centre lies does not count."""
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
    """Median after a recalibration that does not use the tolerances, mm; null without it."""
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
    first_order_row_px: float | None
    """RMS row misalignment over rigs and image as built, first order, px; null where no rows correspond."""
    simulated_row_px: float | None
    """The same simulated, px."""
    not_rectified_row_px: float | None
    """The same in the images as they are seen, px."""
    per_rig_row_p50_px: float | None
    """Median over rigs of the RMS row misalignment of each, px."""
    per_rig_row_p95_px: float | None
    """95th percentile over rigs, px."""
    recalibrated_row_p50_px: float | None
    """Median after a recalibration that does not use the tolerances, px; null without it."""
    recalibrated_row_p95_px: float | None
    """95th percentile after it, px."""
    informed_row_p50_px: float | None
    """Median after a recalibration that knows the tolerances beforehand, px; null without it."""
    informed_row_p95_px: float | None
    """95th percentile after it, px."""


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
    rows: Rows
    interactions: Interactions
    recalibration: Recalibration | None
    """Null without recalibration."""
    calibration: OfCalibration | None
    """Null where a class of tolerances is taken, and no calibration's covariance."""
    depths: list[Depth]
    """Near to far."""
    motion: Motion | None
    """Null where no time offset is among the quantities."""
    remarks: list[RemarkPart]
    """What is odd about what was asked."""
    golden: Golden | None
    """Null without --golden and --update."""
