"""What `rigsim tolerance --json` prints and tolerance.json holds."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Literal, Protocol

from pydantic import Field

from rigsim.interop.documents.base import Golden, Part, RemarkPart, Rig, finite, golden_part, plain_rig
from rigsim.interop.documents.rows import row_model
from rigsim.rig.remark import Remark
from rigsim.study.golden.compare import GoldenReport
from rigsim.study.tolerance.built import percentile_mm
from rigsim.study.tolerance.columns import HEAD, REST
from rigsim.study.tolerance.inputs import Tolerances
from rigsim.study.tolerance.run import DepthErrors, Rigs, ToleranceResult
from rigsim.study.tolerance.table import quantity_head, quantity_rest


class Words(Protocol):
    """The sentences of the document, made by whoever calls: `rigsim.present.tolerance.words` has them."""

    def interactions_sentence(self, result: ToleranceResult) -> str:
        """Whether quantities act on one another; empty where that was not asked."""

    def rows_sentence(self, result: ToleranceResult) -> str:
        """How far apart rows are, as built and after recalibration."""

    def recalibration_sentence(self, result: ToleranceResult) -> str:
        """What the recalibration has to work with; empty without one."""


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
    depths: list[Depth]
    """Near to far."""
    motion: Motion | None
    """Null where no time offset is among the quantities."""
    remarks: list[RemarkPart]
    """What is odd about what was asked."""
    golden: Golden | None
    """Null without --golden and --update."""


def tolerance_document(
    result: ToleranceResult,
    words: Words,
    remarks: Iterable[Remark] = (),
    golden: GoldenReport | None = None,
) -> dict[str, Any]:
    """The study with stable keys and units in their names; null where a number has no bound."""
    both = result.interactions
    return ToleranceDocument(
        rig=plain_rig(result.rig),
        required=required_part(result),
        noise_px=result.noise_px,
        rigs=result.n_rigs,
        points=result.n_points,
        yields=Yield(
            as_built=result.yield_before,
            recalibrated=result.yield_after,
            recalibrated_informed=result.yield_informed,
        ),
        yield_build_alone=YieldAlone(
            as_built=_share(result.judged.built),
            recalibrated=_share_if(result.judged.recalibrated),
            recalibrated_informed=_share_if(result.judged.informed),
        ),
        quantities=quantities_part(result),
        rows=_rows(result, words),
        interactions=Interactions(
            noticed=[] if both is None else [both.keys[place] for place in both.error.noticed],
            says=words.interactions_sentence(result),
        ),
        recalibration=_recalibration(result, words),
        depths=[_depth(item) for item in result.depths],
        motion=_motion(result.tolerances),
        remarks=[RemarkPart(code=remark.code, text=remark.text) for remark in remarks],
        golden=golden_part(golden),
    ).model_dump(by_alias=True)


def _motion(held: Tolerances) -> Motion | None:
    if not held.time_offset_ms:
        return None
    names = ("speed_m_s", "forward_speed_m_s", "turn_rate_deg_s", "moving")
    return Motion(**{name: getattr(held, name) for name in names})


def required_part(result: ToleranceResult) -> Required:
    """What one rig may err."""
    asked = result.required
    return Required(
        depth_error_mm=asked.error_m * 1e3,
        distance_mm=asked.depth_m * 1e3,
        statistic="p95" if asked.p95 else "rms",
        row_px=asked.row_px,
    )


def quantities_part(result: ToleranceResult) -> list[Quantity]:
    """Every quantity, the worst first."""
    return [
        Quantity.model_validate(
            quantity_head(result, item)
            | {"depth_error_mm": list(item.depth_rms_mm)}
            | {name: _known(value) for name, value in quantity_rest(result, item).items()}
        )
        for item in result.sensitivities
    ]


def _rows(result: ToleranceResult, words: Words) -> Rows:
    worst, limit_px = result.rows_worst, result.required.row_px
    states = [result.rows_px(state) for state in ("built", "recalibrated", "informed")]
    kept = None
    if limit_px is not None:
        shares = [None if rows is None else float((rows <= limit_px).mean()) for rows in states]
        kept = Yield(as_built=shares[0] or 0.0, recalibrated=shares[1], recalibrated_informed=shares[2])
    return Rows(
        distance_mm=worst.depth_m * 1e3,
        as_built_px=finite(worst.built.row_rms_px),
        not_rectified_px=finite(worst.row_as_seen_px),
        recalibrated_px=_row_px(worst.recalibrated),
        recalibrated_informed_px=_row_px(worst.informed),
        kept=kept,
        says=words.rows_sentence(result),
    )


def _row_px(rigs: Rigs | None) -> float | None:
    return None if rigs is None else finite(rigs.row_rms_px)


def _recalibration(result: ToleranceResult, words: Words) -> Recalibration | None:
    session = result.recalibration
    if session is None or not result.known_lengths_m:
        return None
    return Recalibration(
        features=session.features,
        pictures=session.pictures,
        noise_px=session.noise_px,
        averaged_noise_px=session.averaged_px,
        known_lengths_mm=[length_m * 1e3 for length_m in result.known_lengths_m],
        length_std_mm=session.length_std_mm,
        says=words.recalibration_sentence(result),
    )


def _known(value: float | None) -> float | None:
    return None if value is None else finite(value)


def _share(rigs: Rigs) -> float:
    """Of the rigs whose build alone is good."""
    return float(rigs.good_alone.mean())


def _share_if(rigs: Rigs | None) -> float | None:
    return None if rigs is None else _share(rigs)


def _depth(item: DepthErrors) -> Depth:
    spread: dict[str, float | None] = {}
    for name, rigs in (
        ("per_rig", item.built),
        ("recalibrated", item.recalibrated),
        ("informed", item.informed),
    ):
        for head, errors in (
            (name, None if rigs is None else rigs.build_mm),
            (f"{name}_with_noise", None if rigs is None else rigs.whole_mm),
        ):
            for level in (50, 95):
                spread[f"{head}_p{level}_mm"] = (
                    None if errors is None else finite(percentile_mm(errors, level))
                )
        for level in (50, 95):
            spread[f"{name}_row_p{level}_px"] = (
                None if rigs is None else finite(percentile_mm(rigs.row_px, level))
            )
    return Depth(
        distance_mm=item.depth_m * 1e3,
        noise_mm=item.noise_mm,
        first_order_rms_mm=item.first_order_mm,
        simulated_rms_mm=finite(item.rms_mm),
        first_over_simulated=item.first_over_simulated,
        flagged=item.parts,
        first_order_row_px=finite(item.first_order_row_px),
        simulated_row_px=finite(item.built.row_rms_px),
        not_rectified_row_px=finite(item.row_as_seen_px),
        **spread,
    )
