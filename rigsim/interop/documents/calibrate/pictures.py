"""The document that `rigsim calibrate pictures --json` prints, made from what was calibrated."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from rigsim.interop.documents.base import RemarkPart, Written, finite
from rigsim.interop.documents.calibrate.covariance import camera_part, covariance_part
from rigsim.interop.documents.calibrate.depths import axis_depths, place_depths
from rigsim.interop.documents.calibrate.pictures_models import (
    CalibratedCamera,
    CalibratedPose,
    CalibrationNextPose,
    CalibrationPicture,
    CalibrationWarp,
    CalibrationWithoutSuspects,
    OpencvRig,
    PicturesDocument,
)
from rigsim.study.calibrate.pictures.result import CalibratedPictures, PictureCheck


@dataclass(frozen=True, slots=True)
class PicturesSays:
    """Who puts what into words."""

    headline: Callable[[CalibratedPictures], str]
    picture: Callable[[PictureCheck], str]
    next_pose: Callable[[CalibratedPictures], str]


def pictures_document(
    result: CalibratedPictures, says: PicturesSays, command: str = "", written: Written | None = None
) -> dict[str, Any]:
    """Everything that was found as one JSON document; null where there is no number."""
    parameters = result.covariance.parameters
    free = set(parameters.free_names(result.rig))
    return PicturesDocument(
        command=command,
        headline=says.headline(result),
        verdict=result.verdict,
        board=result.asked.board.text,
        model=result.asked.model,
        held=[name for name in parameters.names if name not in free],
        rms_px=result.fit.rms_px,
        corner_noise_px=result.fit.noise_px,
        claimed_noise_px=finite(result.fit.sightings.claimed_rms_px),
        leave_one_out_ratio=finite(result.ratio),
        baseline_mm=result.rig.baseline_m * 1e3,
        baseline_std_mm=result.baseline_std_m * 1e3,
        left=_camera(result, 0),
        right=_camera(result, 1),
        right_from_left=_pose(result),
        pictures=[_picture(check, says) for check in result.pictures],
        depth_std=axis_depths(result.depths),
        depth_std_places=place_depths(result.depths),
        warp=_warp(result),
        opencv=OpencvRig(
            rms_px=result.opencv.rms_px,
            baseline_mm=result.opencv.rig.baseline_m * 1e3,
            focal_px=[result.opencv.rig.left.fx, result.opencv.rig.right.fx],
        ),
        without_suspects=_without(result),
        next_pose=_next(result, says),
        covariance=covariance_part(result.covariance, covariance_source_of(result)),
        remarks=[RemarkPart(code=remark.code, text=remark.text) for remark in result.remarks],
        written=written,
    ).model_dump()


def covariance_source_of(result: CalibratedPictures) -> dict[str, Any]:
    """What the covariance of a calibration comes from."""
    return {
        "of": "pictures",
        "board": result.asked.board.text,
        "pictures": int(result.kept.sum()),
        "corner_noise_px": result.fit.noise_px,
    }


def _camera(result: CalibratedPictures, side: int) -> CalibratedCamera:
    name, camera = ("left", "right")[side], (result.rig.left, result.rig.right)[side]
    covariance = result.covariance
    std = {
        full.partition(".")[2]: float(value)
        for full, value in zip(covariance.names, covariance.std, strict=True)
        if full.startswith(f"{name}.")
    }
    part = camera_part(camera).model_dump()
    return CalibratedCamera(**part, std=std, coverage_pct=100 * result.coverage.shares[side])


def _pose(result: CalibratedPictures) -> CalibratedPose:
    pose, std = result.rig.right_from_left, result.covariance.std[result.covariance.parameters.pose]
    return CalibratedPose(
        rotvec_deg=np.degrees(pose.rotvec_rad).tolist(),
        t_mm=(1e3 * pose.t).tolist(),
        rotvec_std_deg=np.degrees(std[:3]).tolist(),
        t_std_mm=(1e3 * std[3:]).tolist(),
    )


def _picture(check: PictureCheck, says: PicturesSays) -> CalibrationPicture:
    return CalibrationPicture(
        name=check.name,
        rms_px=finite(check.rms_px),
        leave_one_out_ratio=finite(check.ratio),
        verdict=check.verdict,
        reason=check.reason,
        says=says.picture(check),
        corners=list(check.corners),
    )


def _warp(result: CalibratedPictures) -> CalibrationWarp:
    warp = result.warp
    return CalibrationWarp(
        rise_mm=[finite(1e3 * value) for value in warp.rise_m],
        std_mm=[finite(1e3 * value) for value in warp.std_m],
        chance=warp.chance if math.isfinite(warp.chance) else 1.0,
        estimated=result.asked.warp,
    )


def _without(result: CalibratedPictures) -> CalibrationWithoutSuspects | None:
    found = result.without_suspects
    if found is None:
        return None
    return CalibrationWithoutSuspects(
        names=list(found.names),
        baseline_mm=found.baseline_m * 1e3,
        baseline_shift_std=found.baseline_stds,
        z_m=found.z_m,
        depth_shift_mm=found.depth_shift_m * 1e3,
        depth_shift_std=found.depth_shift_stds,
        calibration_mm=found.depth_std_m[1] * 1e3,
        beyond_chance=found.beyond_chance,
    )


def _next(result: CalibratedPictures, says: PicturesSays) -> CalibrationNextPose | None:
    found = result.next_pose
    if found is None:
        return None
    return CalibrationNextPose(
        left_from_board=[float(value) for value in found.left_from_board],
        seen=list(found.seen),
        gain=found.gain,
        says=says.next_pose(result),
    )
