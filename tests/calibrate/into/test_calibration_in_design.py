"""`rigsim design --calibration`: what a calibration leaves counts in a depth error, as squares with noise."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rigsim
from rigsim.api.kit.cameras import cameras_tried
from rigsim.api.kit.requirements import DesignOptions, specified
from rigsim.cli.app import run
from rigsim.interop.documents.design.document import design_document
from rigsim.present.design import words
from rigsim.present.design.console import sentences
from rigsim.present.design.page import design_html
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.statistics import rms
from rigsim.study.calibrate.counted import calibration_remarks, design_calibration
from rigsim.study.design.checks import RigInScene, check
from rigsim.study.design.solve import Design, solve
from rigsim.study.tolerance.joint.cause import CalibrationTolerance
from rigsim.study.tolerance.sensitivities import shared_points
from rigsim.theory.calibration.boards import BoardPoses
from rigsim.theory.calibration.covariance import CalibrationCovariance, covariance_of
from rigsim.theory.calibration.disparity import CalibrationDisparity
from rigsim.theory.calibration.information import board_information
from rigsim.theory.calibration.parameters import RigParameters
from rigsim.theory.inverse import Camera, Requirement
from rigsim.theory.inverse_error import P95_OVER_STD
from tests.helpers.calibrate.covariances import BOARD, random_poses, written

CAMERA = Camera(1280, 960, 1000.0)
EVEN = CalibrationDisparity(np.array([5.0, 50.0]), np.array([0.3, 0.3]))
"""0.3 px at any distance."""
ASKED = Requirement("depth_error", 0.020, 2.0)
COUNTED = replace(ASKED, calibration=EVEN)


def _tolerance(covariance: CalibrationCovariance) -> CalibrationTolerance:
    return CalibrationTolerance("some.json", "20 planned pictures", covariance)


def test_noise_and_calibration_add_as_squares_by_hand() -> None:
    # Z^2 / (f B) = 4 / 200 m/px = 20 mm/px: 0.4 px of noise are 8 mm, 0.3 px of calibration 6 mm, both 10 mm
    assert ASKED.achieved(CAMERA, 0.2, 0.4) == pytest.approx(0.008)
    assert COUNTED.of_calibration(1000.0, 0.2) == pytest.approx(0.006)
    assert COUNTED.achieved(CAMERA, 0.2, 0.4) == pytest.approx(0.010)
    # 20 mm are met at half that baseline, where noise alone would do with 80 mm
    assert ASKED.baseline_m(CAMERA, 0.4) == pytest.approx(0.08)
    assert COUNTED.baseline_m(CAMERA, 0.4) == pytest.approx(0.10, rel=1e-6)
    p95 = replace(COUNTED, per_std=P95_OVER_STD)
    assert p95.of_calibration(1000.0, 0.2) == pytest.approx(0.006 * P95_OVER_STD)


def test_what_a_length_leaves_no_baseline_mends() -> None:
    # 1 px at 10 baselines and 0.1 px at 100 is a share of the disparity: 1 % of the depth, whatever the rig
    share = CalibrationDisparity(np.geomspace(10, 1000, 60), 10 / np.geomspace(10, 1000, 60))
    asked = replace(ASKED, calibration=share)
    for baseline_m in (0.05, 0.5, 5.0):
        errors = asked.of_calibration(1000.0, baseline_m)
        assert errors == pytest.approx(2.0 * 10 / 1000, rel=2e-3)
    assert replace(asked, limit=0.015).baseline_m(CAMERA, 0.4) == math.inf
    assert share.at(5.0) == pytest.approx(2.0)


def test_a_rig_of_twice_the_size_is_calibrated_to_the_same_pixels() -> None:
    # the law that a calibration is carried over by: rig, board and distances twice as large
    found = []
    for size in (1.0, 2.0):
        rig = StereoRig.rectified(Intrinsics.from_focal(640, 480, 500.0), 0.1 * size)
        parameters = RigParameters.of((None, None))
        board = replace(BOARD, square_m=BOARD.square_m * size)
        poses = random_poses(12, 3)
        poses = BoardPoses(poses.R, poses.t * size)
        told = board_information(rig, parameters, board, poses)
        covariance = covariance_of(rig, parameters, poses, told, 0.1)
        found.append(design_calibration(_tolerance(covariance)).disparity)
        z_m = 20 * rig.baseline_m
        std_m = rms(covariance.depth_std(shared_points(rig, z_m, 96), from_camera=True))
        assert found[-1].at(20.0) == pytest.approx(std_m * 500 * rig.baseline_m / z_m**2, rel=0.02)
    np.testing.assert_allclose(found[1].std_px, found[0].std_px, rtol=1e-6)
    np.testing.assert_allclose(found[1].baselines, found[0].baselines)


def test_what_was_simulated_gets_what_the_calibration_leaves() -> None:
    rig = StereoRig.rectified(Intrinsics.from_focal(1280, 960, 1000.0), 0.2)
    points = np.column_stack([np.zeros((200, 2)), np.full(200, 2.0)])
    sight = RigInScene(rig, 0.2, (1280, 960), points, np.full(200, 0.008), rigsim.PixelNoise(0.28), 50, None)
    rng = np.random.default_rng(0)
    assert check(ASKED, sight, rng).simulated == pytest.approx(0.008)
    assert check(COUNTED, sight, rng).simulated == pytest.approx(0.010)
    assert check(replace(COUNTED, limit=0.0095), sight, rng).is_met is False


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    rig = StereoRig(
        Intrinsics.from_hfov(1280, 960, 60.0), Intrinsics.from_hfov(1280, 960, 60.0), Pose(t=[-0.15, 0, 0])
    )
    parameters = RigParameters.of((None, None))
    poses = random_poses(20, 1)
    told = board_information(rig, parameters, BOARD, poses)
    return written(
        covariance_of(rig, parameters, poses, told, 0.6), tmp_path_factory.mktemp("plan") / "plan.json"
    )


def _design(limit_mm: float, file: Path | None, **more: Any) -> Design:
    options = DesignOptions(
        (1.0, 3.0),
        depth_error_mm=limit_mm,
        resolutions_px=(1280, 960),
        lenses_deg=60,
        calibration=file,
        prefer="smallest",
        **more,
    )
    return solve(specified(options), cameras_tried(options), options.prefer)


def test_the_answer_tells_noise_and_calibration_apart(file: Path) -> None:
    without, said = (design_document(_design(20, given), (), None, words) for given in (None, file))
    assert without["calibration"] is None
    assert without["requirements"][0]["by_noise"] is None
    assert without["recommended"]["calibration_share"] == 0
    assert said["calibration"] == {"file": "plan.json", "source": "12 planned pictures"}
    error = said["requirements"][0]
    assert error["by_calibration"] > 0
    assert error["achieved"] == pytest.approx(
        math.hypot(error["by_noise"], error["by_calibration"]), rel=1e-3
    )
    best = said["recommended"]
    assert best["noise_share"] == pytest.approx((error["by_noise"] / 20) ** 2, rel=1e-3)
    assert best["calibration_share"] == pytest.approx((error["by_calibration"] / 20) ** 2, rel=1e-3)
    # what the calibration takes, a longer baseline has to give
    assert said["binding"]["shortest"]["baseline_mm"] > 1.02 * without["binding"]["shortest"]["baseline_mm"]


def test_what_is_said_and_remarked(file: Path) -> None:
    found = _design(20, file, min_baseline_mm=300)
    said = " ".join(sentences(found, ()))
    assert "and what its calibration leaves" in design_html(found, (), None, "")
    assert "and what its calibration leaves" not in design_html(_design(20, None), (), None, "")
    assert "Noise and calibration add as squares, depth error at 3 m: " in said
    assert "(plan.json, 12 planned pictures)" in said
    pick = found.candidates[0]
    (remark,) = calibration_remarks(found.specification.calibration, pick.camera, pick.baseline_m)
    assert remark.code == "other_baseline"
    assert "plan.json is of a rig with 150 mm of baseline" in remark.text
    narrow = replace(pick.camera, focal_px=2 * pick.camera.focal_px)
    (remark,) = calibration_remarks(found.specification.calibration, narrow, 0.15)
    assert remark.code == "other_view"
    assert list(calibration_remarks(found.specification.calibration, pick.camera, 0.16)) == []


WORDS = ["design", "--range", "1:3m", "--resolution", "1280x960", "--lens", "60deg", "--no-proof"]


def test_a_requirement_that_the_calibration_alone_exceeds_is_said_so(
    capsys: pytest.CaptureFixture[str], file: Path, tmp_path: Path
) -> None:
    asked = ["--depth-error", "0.2mm@3m", "--calibration", str(file), "--out", str(tmp_path / "out")]
    assert run([*WORDS, *asked]) == 1
    said = capsys.readouterr().err
    assert "is less than the calibration alone leaves at any baseline" in said
    assert said.count("\n") == 1
    assert run([*WORDS, "--depth-error", "20mm@3m", "--calibration", "gone.json"]) == 1
    assert "gone.json: cannot be read" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
