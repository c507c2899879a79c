"""A planned calibration with poses at random, straight from the core: nothing is chosen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rigsim.rig.board import Board
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.noise import PixelNoise
from rigsim.rig.pose import rotation_from_rotvec
from rigsim.rig.presets import preset
from rigsim.rig.stereo import StereoRig
from rigsim.study.calibrate.depths import depth_stds
from rigsim.study.calibrate.plan.asked import DepthGoal, PlanAsked
from rigsim.study.calibrate.plan.result import (
    CalibrationPlan,
    CurvePoint,
    Inseparable,
    NextPose,
    PicturesNeeded,
)
from rigsim.theory.calibration.boards import BoardPoses, whole
from rigsim.theory.calibration.covariance import covariance_of
from rigsim.theory.calibration.information import board_information
from rigsim.theory.calibration.parameters import RigParameters


def board_poses(rig: StereoRig, board: Board, count: int, seed: int = 0) -> BoardPoses:
    """Poses that both cameras see whole, at 0.4 to 1.2 m, tilted up to 40 degrees."""
    rng = np.random.default_rng(seed)
    middle = np.append(np.array(board.size_m) / 2, 0)
    kept: list[np.ndarray] = []
    while len(kept) < count:
        tilt, about = np.radians(rng.uniform(5, 40)), rng.uniform(0, 2 * np.pi)
        vector = tilt * np.array([np.cos(about), np.sin(about), 0])
        z = rng.uniform(0.4, 1.2)
        uv = rng.uniform((0, 0), (rig.left.width, rig.left.height))
        at = np.append((uv - (rig.left.cx, rig.left.cy)) / (rig.left.fx, rig.left.fy), 1) * z
        row = np.append(vector, at - rotation_from_rotvec(vector) @ middle)
        pose = BoardPoses.of([row])
        if whole(rig, pose.project(rig, board), 5).all():
            kept.append(row)
    return BoardPoses.of(kept)


def made_plan(
    name: str = "oak-d",
    count: int = 12,
    error_m: float | None = 0.02,
    noise_px: float = 0.25,
    **asked: object,
) -> CalibrationPlan:
    """A plan for a preset's rig; `asked` goes to `PlanAsked`."""
    rig, board = preset(name).rig, Board(9, 6, 0.03)
    parameters = RigParameters.of((BrownConrady, BrownConrady))
    poses = board_poses(rig, board, count)
    told = board_information(rig, parameters, board, poses)
    goal = None if error_m is None else DepthGoal(error_m, 2.0)
    wanted = replace(PlanAsked(rig, parameters, board, count, noise_px=noise_px, goal=goal), **asked)
    at_m = wanted.chosen_for_m
    full = covariance_of(rig, parameters, poses, told, wanted.corner_noise_px)
    curve = []
    for n in range(3, count + 1):
        part = covariance_of(rig, parameters, poses.chosen(slice(n)), told.chosen(slice(n)), 0.1)
        (row,) = depth_stds(part, [at_m], PixelNoise(noise_px), ["axis"])
        curve.append(CurvePoint(n, row.calibration_m, 1.5 * row.calibration_m, row.joint_m))
    needed = next((point.pictures for point in curve if error_m and point.joint_m <= error_m), None)
    return CalibrationPlan(
        wanted,
        poses,
        np.ones((count, 2), dtype=bool),
        full,
        depth_stds(full, wanted.at_m, PixelNoise(noise_px)),
        tuple(curve),
        PicturesNeeded(needed, "" if needed or error_m is None else "observation"),
        NextPose(poses.rows[0], (True, False), 0.93),
        (Inseparable("left.cx", "ry_rad", 0.97), Inseparable("left.fx", "tz_m", -0.95)),
        (),
    )
