"""Depths of a calibration, as plans and calibrated pictures tell them."""

from __future__ import annotations

from collections.abc import Sequence

from rigsim.interop.documents.calibrate.plan_models import PlanDepth, PlanDepthPlace
from rigsim.study.calibrate.depths import DepthStd


def axis_depths(rows: Sequence[DepthStd]) -> list[PlanDepth]:
    """Those on the left optical axis."""
    return [PlanDepth(**_numbers(row)) for row in rows if row.place == "axis"]


def place_depths(rows: Sequence[DepthStd]) -> list[PlanDepthPlace]:
    """All of them."""
    return [
        PlanDepthPlace(**_numbers(row), place=row.place, calibration_from_camera_mm=row.in_camera_m * 1e3)
        for row in rows
    ]


def _numbers(row: DepthStd) -> dict[str, float]:
    return {
        "z_m": row.z_m,
        "calibration_mm": row.calibration_m * 1e3,
        "observation_mm": row.observation_m * 1e3,
        "joint_mm": row.joint_m * 1e3,
    }
