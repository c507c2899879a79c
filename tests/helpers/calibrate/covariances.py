"""Covariances of small board calibrations, for whoever takes one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from rigsim.interop.documents.calibrate.covariance import covariance_document
from rigsim.interop.documents.text import json_text
from rigsim.rig.board import Board
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.covariance import CalibrationCovariance, covariance_of
from rigsim.theory.calibration.information import board_information
from rigsim.theory.calibration.parameters import RigParameters

BOARD = Board(9, 6, 0.03)
SOURCE: Mapping[str, Any] = MappingProxyType(
    {"of": "plan", "board": BOARD.text, "pictures": 12, "corner_noise_px": 0.1}
)


def calibrated(
    rig: StereoRig | None = None,
    *,
    lens: Lens | None = None,
    model: type[Lens] = BrownConrady,
    fix: Sequence[str] = (),
    warped: bool = False,
    noise_px: float = 0.1,
    pictures: int = 12,
    seed: int = 0,
) -> CalibrationCovariance:
    """What so many random views of `BOARD` leave of a rig: by default one of 640 x 480 px, 100 mm wide."""
    if rig is None:
        camera = Intrinsics.from_focal(640, 480, 500.0, lens=lens)
        right = replace(camera, fx=505.0, cx=322.5)
        rig = StereoRig(camera, right, Pose.from_rotvec((0.01, -0.02, 0.005), (-0.1, 0.001, 0.002)))
    parameters = RigParameters.of((model, model), fix=fix, warped=warped)
    poses = random_poses(pictures, seed)
    information = board_information(rig, parameters, BOARD, poses)
    return covariance_of(rig, parameters, poses, information, noise_px)


def random_poses(count: int, seed: int) -> BoardPoses:
    """Tilted boards half a metre to a metre away."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(count):
        turn = Pose.from_rotvec(rng.uniform(-0.6, 0.6, 3))
        middle = np.array([*rng.uniform(-0.12, 0.12, 2), rng.uniform(0.5, 1.0)])
        found.append([*turn.rotvec_rad, *(middle - turn.R @ BOARD.points.mean(axis=0))])
    return BoardPoses.of(np.array(found))


def written(covariance: CalibrationCovariance, path: Path) -> Path:
    """The covariance as a file."""
    path.write_text(json_text(covariance_document(covariance, SOURCE)), encoding="utf-8")
    return path
