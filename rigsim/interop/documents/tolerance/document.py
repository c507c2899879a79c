"""A tolerance study as its document."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Protocol

from rigsim.interop.documents.base import RemarkPart, finite, golden_part, plain_rig
from rigsim.interop.documents.tolerance.models import (
    Depth,
    Interactions,
    Motion,
    OfCalibration,
    Quantity,
    Recalibration,
    Required,
    Rows,
    ToleranceDocument,
    Yield,
    YieldAlone,
)
from rigsim.rig.remark import Remark
from rigsim.study.golden.compare import GoldenReport
from rigsim.study.tolerance.built import percentile_mm
from rigsim.study.tolerance.inputs import Tolerances
from rigsim.study.tolerance.run import DepthErrors, Rigs, ToleranceResult
from rigsim.study.tolerance.table import quantity_head, quantity_rest


class Words(Protocol):
    """The sentences of the document, made by whoever calls: `rigsim.present.tolerance.words` has them."""

    def interactions_sentence(self, result: ToleranceResult) -> str:
        """Whether quantities act on one another; empty where that was not asked."""

    def rows_sentence(self, result: ToleranceResult) -> str:
        """How far apart rows are, as built and after recalibration."""

    def calibration_sentence(self, result: ToleranceResult) -> str:
        """What the calibration leaves of the depth; empty without one."""

    def recalibration_sentence(self, result: ToleranceResult) -> str:
        """What the recalibration has to work with; empty without one."""


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
        calibration=_calibration(result, words),
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


def _calibration(result: ToleranceResult, words: Words) -> OfCalibration | None:
    calibration = result.tolerances.calibration
    if calibration is None:
        return None
    in_camera, to_boards = (1e3 * value for value in result.calibration_axis_m)
    return OfCalibration(
        file=calibration.name,
        source=calibration.source,
        in_camera_mm=in_camera,
        against_boards_mm=to_boards,
        says=words.calibration_sentence(result),
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
