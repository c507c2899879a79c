"""A planned calibration as its document."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from rigsim.interop.documents.base import RemarkPart, Written, finite, seen_rig
from rigsim.interop.documents.calibrate.covariance import covariance_part
from rigsim.interop.documents.calibrate.depths import axis_depths, place_depths
from rigsim.interop.documents.calibrate.plan_models import (
    PlanBoard,
    PlanCurve,
    PlanDocument,
    PlanDrift,
    PlanDriftDepth,
    PlanInseparable,
    PlanNext,
    PlanParameter,
    PlanPose,
    PlanProjection,
    PlanRemedy,
    PlanRequest,
    PlanTrueDepth,
    PlanWitness,
    PlanWitnessDepth,
    UndeterminedDocument,
)
from rigsim.interop.documents.text import clean
from rigsim.rig.remark import Remark
from rigsim.study.agreement.agreement import Agreement
from rigsim.study.calibrate.drift import Drift, drift
from rigsim.study.calibrate.enough import enough
from rigsim.study.calibrate.estimated import estimates
from rigsim.study.calibrate.holding import Holding, holdings
from rigsim.study.calibrate.plan.result import CalibrationPlan, NextPose
from rigsim.study.calibrate.projection import FAR_M, projection_map
from rigsim.study.calibrate.witness.result import CalibrationWitness, WitnessedDepth
from rigsim.study.calibrate.witness.truth import TrueDepth, true_depth
from rigsim.theory.calibration.boards import BoardPoses


class PlanSays(Protocol):
    """The sentences of the document, made by whoever calls: `present.calibrate.plan_words` has them."""

    def headline(self, plan: CalibrationPlan) -> str:
        """The answer in one sentence."""

    def true_sentence(self, plan: CalibrationPlan, witnesses: Sequence[CalibrationWitness]) -> str:
        """What witnesses that met another lens or board found; empty where there are none."""

    def sentences(self, plan: CalibrationPlan) -> list[str]:
        """What else there is to say."""

    def holding_words(self, held: Holding) -> str:
        """How a board is held."""

    def parameter(self, name: str) -> str:
        """A parameter's name."""

    def agreement_words(self, agreement: Agreement) -> str:
        """Why witnesses do not agree; empty where they do."""


@dataclass(frozen=True, slots=True, eq=False)
class PlanTold:
    """What a plan's document tells besides."""

    command: str = ""
    """What made it."""
    witnesses: Sequence[CalibrationWitness] = ()
    """Whole calibrations."""
    remarks: Sequence[Remark] = ()
    """What is odd about it."""
    complete: bool = True
    """Whether all witnesses that were asked for are there."""
    written: Written | None = None
    """The files; None where none were written."""


def plan_document(plan: CalibrationPlan, says: PlanSays, told: PlanTold) -> dict[str, Any]:
    """The plan with stable keys and units in their names; null where a number has no bound."""
    asked, needed = plan.asked, plan.needed
    board = asked.board
    square_mm = clean(board.square_m * 1e3)
    return PlanDocument(
        command=told.command,
        headline=_said(f"{says.headline(plan)} {says.true_sentence(plan, told.witnesses)}".rstrip()),
        sentences=[_said(sentence) for sentence in says.sentences(plan)],
        rig=seen_rig(asked.rig),
        board=PlanBoard(text=board.text, columns=board.cols, rows=board.rows, square_mm=square_mm),
        asked=_request(plan),
        depth_std=axis_depths(plan.depths),
        depth_std_places=place_depths(plan.depths),
        pictures=len(plan.poses),
        pictures_needed=needed.count,
        hindrance=needed.hindrance,
        remedies=[
            PlanRemedy.model_validate({"change": one.code, "joint_mm": one.joint_m * 1e3})
            for one in needed.remedies
        ],
        pictures_enough=enough(plan),
        curve=[
            PlanCurve(
                pictures=point.pictures,
                calibration_mm=finite(point.calibration_m * 1e3),
                random_mm=finite(point.random_m * 1e3),
                joint_mm=finite(point.joint_m * 1e3),
            )
            for point in plan.curve
        ],
        best_first=isinstance(asked.poses, int),
        poses=_poses(plan, says),
        next_pose=None if plan.next_pose is None else _next(plan, plan.next_pose, says),
        parameters=[
            PlanParameter(
                name=one.name, says=says.parameter(one.name), value=one.value, std=one.std, unit=one.unit
            )
            for one in estimates(plan)
        ],
        inseparable=[
            PlanInseparable(first=one.first, second=one.second, correlation=one.correlation)
            for one in plan.inseparable
        ],
        projection=_projections(plan),
        witnesses=[_witness(one, says) for one in told.witnesses],
        true_depth=_true(true_depth(plan, told.witnesses)),
        complete=told.complete,
        drift=[_drift(one) for one in drift(asked.rig, asked.at_m)],
        covariance=covariance_part(plan.covariance, covariance_source(plan)),
        remarks=[RemarkPart(code=remark.code, text=remark.text) for remark in told.remarks],
        written=told.written,
    ).model_dump()


def covariance_source(plan: CalibrationPlan) -> dict[str, Any]:
    """What the covariance of a plan comes from."""
    return {
        "of": "plan",
        "board": plan.asked.board.text,
        "pictures": len(plan.poses),
        "corner_noise_px": plan.asked.corner_noise_px,
    }


def undetermined_document(error: str, reason: str) -> dict[str, Any]:
    """What stands in a document's place where the boards leave the rig open."""
    return UndeterminedDocument(error=" ".join(error.split()), reason=reason).model_dump()


def _request(plan: CalibrationPlan) -> PlanRequest:
    asked = plan.asked
    parameters = asked.parameters
    free = set(parameters.free_names(asked.rig))
    return PlanRequest(
        poses=asked.poses if isinstance(asked.poses, int) else None,
        near_mm=clean(asked.reach.near_m * 1e3),
        far_mm=clean(asked.reach.far_m * 1e3),
        tilt_deg=clean(math.degrees(asked.reach.tilt_rad)),
        corner_noise_px=asked.corner_noise_px,
        noise_px=asked.noise_px,
        flatness_mm=clean(asked.flatness_m * 1e3),
        depth_error_mm=None if asked.goal is None else clean(asked.goal.error_m * 1e3),
        at_m=asked.chosen_for_m,
        lens_models=[None if lens is None else lens.model for lens in parameters.lenses],
        held=[name for name in parameters.names if name not in free],
        seed=asked.seed,
    )


def _poses(plan: CalibrationPlan, says: PlanSays) -> list[PlanPose]:
    held = holdings(plan.asked.rig, plan.asked.board, plan.poses, plan.seen)
    return [PlanPose(**_pose(row, one, says)) for row, one in zip(plan.poses.rows, held, strict=True)]


def _next(plan: CalibrationPlan, found: NextPose, says: PlanSays) -> PlanNext:
    poses = BoardPoses.of([found.left_from_board])
    (held,) = holdings(plan.asked.rig, plan.asked.board, poses, np.array([found.seen]))
    return PlanNext(**_pose(found.left_from_board, held, says), gain=found.gain)


def _pose(row: Any, held: Holding, says: PlanSays) -> dict[str, Any]:
    return {
        "left_from_board": [float(value) for value in row],
        "seen": list(held.seen),
        "distance_mm": held.distance_m * 1e3,
        "across": held.across,
        "down": held.down,
        "tilt_deg": math.degrees(held.tilt_rad),
        "away": held.away,
        "turn_deg": math.degrees(held.turn_rad),
        "says": says.holding_words(held),
    }


def _projections(plan: CalibrationPlan) -> list[PlanProjection]:
    found = []
    for distance_m in (plan.asked.chosen_for_m, FAR_M):
        for side in (0, 1):
            std = projection_map(plan.covariance, side, distance_m).std_px
            known = std[np.isfinite(std)]
            least, median, most = np.quantile(known, [0, 0.5, 1]) if known.size else [math.nan] * 3
            found.append(
                PlanProjection(
                    camera=("left", "right")[side],
                    distance_m=None if distance_m == FAR_M else distance_m,
                    least_px=finite(least),
                    median_px=finite(median),
                    largest_px=finite(most),
                )
            )
    return found


def _drift(one: Drift) -> PlanDrift:
    depths = [
        PlanDriftDepth(z_m=z_m, axis_mm=axis_m * 1e3, image_mm=finite(image_m * 1e3))
        for z_m, axis_m, image_m in zip(one.z_m, one.axis_m, one.image_m, strict=True)
    ]
    return PlanDrift.model_validate(
        {
            "cause": one.cause,
            "amount": one.amount,
            "unit": one.unit,
            "source": one.source,
            "depths": depths,
        }
    )


def _witness(one: CalibrationWitness, says: PlanSays) -> PlanWitness:
    return PlanWitness.model_validate(
        {
            "name": one.name,
            "calibrations": one.calibrations,
            "failed": one.failed,
            "corner_noise_px": finite(one.corner_noise_px),
            "rms_px": finite(one.rms_px),
            "misfit": finite(one.misfit),
            "parameter_ratio": finite(one.parameter_ratio),
            "parameter_ratio_low": finite(one.parameter_interval[0]),
            "parameter_ratio_high": finite(one.parameter_interval[1]),
            "boards": one.boards,
            "unfound": one.unfound,
            "by_opencv": one.by_opencv,
            "depths": [_witnessed(row) for row in one.depths],
            "agreement": one.agreement.kind,
            "says": says.agreement_words(one.agreement),
        }
    )


def _true(found: TrueDepth | None) -> PlanTrueDepth | None:
    if found is None:
        return None
    return PlanTrueDepth(
        z_m=found.row.z_m,
        mean_mm=found.row.mean_m * 1e3,
        rms_mm=found.rms_m * 1e3,
        met=found.met,
        true_lens=found.witness.true_lens,
        true_board=found.witness.true_board,
    )


def _witnessed(row: WitnessedDepth) -> PlanWitnessDepth:
    return PlanWitnessDepth(
        z_m=row.z_m,
        predicted_mm=finite(row.predicted_m * 1e3),
        std_mm=finite(row.std_m * 1e3),
        mean_mm=finite(row.mean_m * 1e3),
        ratio=finite(row.ratio),
        ratio_low=finite(row.interval[0]),
        ratio_high=finite(row.interval[1]),
    )


def _said(text: str) -> str:
    """Prose without the code marks that pages set."""
    return text.replace("`", "")
