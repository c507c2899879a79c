"""`rigsim sweep --calibration`: every trial has another calibration; prediction and verdict know of it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import rigsim
from rigsim.cli.app import run
from rigsim.errors import InvalidRange, TriangulatorError
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.agreement.agreement import Agreement
from rigsim.study.agreement.simulated import Part, compare, image_parts
from rigsim.study.agreement.views import rays_ahead, views
from rigsim.study.calibrate.drawn import calibrated_views, calibrations
from rigsim.study.scene.statistics import ErrorStatistics, summarize
from rigsim.study.scene.trials import Prediction, predict, run_trials
from rigsim.theory.calibration.covariance import CalibrationCovariance
from tests.helpers.calibrate.covariances import calibrated, written

NOISE = PixelNoise(0.1)
RIG = StereoRig.rectified(Intrinsics.from_focal(640, 480, 500.0), 0.1)
LEFT = calibrated(RIG, fix=("lens",), noise_px=0.5, pictures=20)
"""More of a calibration's error than of noise."""


def _points() -> Array:
    rng = np.random.default_rng(5)
    z = rng.uniform(0.8, 2.0, 300)
    return np.column_stack([rng.uniform(-0.4, 0.3, 300) * z, rng.uniform(-0.35, 0.35, 300) * z, z])


POINTS = _points()


def _tried(
    seed: int, *, drawn: CalibrationCovariance = LEFT, trials: int = 100, method: str = "optimal"
) -> tuple[Prediction, ErrorStatistics]:
    rng = np.random.default_rng(seed)
    predicted = predict(RIG, POINTS, NOISE, method, LEFT)
    found = run_trials(
        (RIG, calibrations(drawn, RIG, trials, rng)),
        POINTS,
        NOISE,
        {"one": predicted},
        np.zeros(len(POINTS), dtype=np.int32),
        trials,
        rng,
    )["one"]
    assert not isinstance(found, TriangulatorError)
    return predicted, found


def _verdict(predicted: Prediction, stats: ErrorStatistics) -> Agreement:
    bins = [Part(None, POINTS[:, 2] < 1.4), Part(None, POINTS[:, 2] >= 1.4)]
    return compare(predicted, stats, bins, image_parts(RIG.project(POINTS)[0], 640, 480))[0]


def test_noise_and_calibration_add_as_squares_and_trials_show_it() -> None:
    both, noise = predict(RIG, POINTS, NOISE, "optimal", LEFT), predict(RIG, POINTS, NOISE)
    left = LEFT.depth_std(POINTS, from_camera=True)
    assert (left > 0.7 * noise.depth_rmse_m).all()
    np.testing.assert_allclose(both.depth_rmse_m, np.hypot(noise.depth_rmse_m, left), rtol=0.01)
    _, stats = _tried(1, trials=1500)
    # 1500 trials tell a standard deviation to 1.8 %
    ratio = stats.depth_rmse_m / both.depth_rmse_m
    assert np.abs(ratio - 1).max() < 0.09
    assert abs(ratio.mean() - 1) < 0.05
    assert stats.sum_nees.sum() / stats.count.sum() == pytest.approx(3, rel=0.1)


@pytest.mark.parametrize("wide", [False, True])
def test_the_views_covariance_is_that_of_whole_calibrations(wide: bool) -> None:
    from rigsim.rig.lens.kannala_brandt import KannalaBrandt
    from rigsim.theory.triangulation import triangulate

    rig = RIG
    covariance = calibrated(RIG, fix=("lens",), noise_px=0.05, pictures=20)
    if wide:
        covariance = calibrated(lens=KannalaBrandt(0.01), model=KannalaBrandt, fix=("lens",), noise_px=0.05)
        rig = covariance.rig
    points = POINTS[:3]
    axes = rays_ahead(rig, points) if wide else None
    assert (axes is None) is not wide
    found = np.array(
        [
            views(triangulate(one, *rig.project(points)), axes) - views(points, axes)
            for one in calibrations(covariance, rig, 400, np.random.default_rng(0))
        ]
    )
    expected, _ = calibrated_views(covariance, rig, points, axes)
    for k in range(len(points)):
        scale = np.sqrt(np.diagonal(expected[k]))
        np.testing.assert_allclose(
            np.cov(found[:, k].T) / scale / scale[:, None], expected[k] / scale / scale[:, None], atol=0.25
        )


def test_a_right_covariance_is_never_flagged_and_a_wrong_one_is() -> None:
    assert {_verdict(*_tried(seed)).kind for seed in range(12)} == {"agrees"}
    worse = replace(LEFT, matrix=9 * LEFT.matrix)
    assert {_verdict(*_tried(seed, drawn=worse)).kind for seed in range(4)} == {"flagged"}
    # as if the points of a trial were independent, a right one would be
    predicted, stats = _tried(0)
    assert _verdict(replace(predicted, shares_calibration=False), stats).kind == "flagged"


def test_what_cannot_be_told_is_untold() -> None:
    few = _verdict(*_tried(0, trials=20))
    assert (few.kind, few.reason, few.count) == ("untold", "too-few-trials", (20, 50))
    other = _verdict(*_tried(0, method="midpoint"))
    assert (other.kind, other.reason) == ("untold", "calibration")


def test_the_interval_of_a_pooled_error_holds_what_points_share() -> None:
    predicted, stats = _tried(3)
    everything = np.ones(len(POINTS), dtype=bool)
    shared = summarize(stats, POINTS[:, 2], everything, slice(0, 1))
    stats.shared = False
    alone = summarize(stats, POINTS[:, 2], everything, slice(0, 1))
    assert shared is not None
    assert alone is not None
    assert shared.mean_square_se_m2 > 5 * alone.mean_square_se_m2
    expected = np.sqrt((predicted.depth_rmse_m**2).mean())
    assert shared.ci_low_m < expected < shared.ci_high_m


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    rig = StereoRig.rectified(Intrinsics.from_hfov(160, 120, 60.0), 0.1)
    covariance = calibrated(rig, fix=("lens",), noise_px=0.1, pictures=20)
    return written(covariance, tmp_path_factory.mktemp("calibration") / "covariance.json")


FEW = ["sweep", "--measure", "none", "--renderer", "rays", "--points", "80", "--trials", "60"]


def test_a_sweep_of_the_calibrated_rig(capsys: pytest.CaptureFixture[str], file: Path) -> None:
    assert run([*FEW, "--supersample", "1", "--calibration", str(file), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    (row,) = said["rows"]
    assert row["baseline_mm"] == pytest.approx(100.0)
    assert row["agreement"] == "agrees"
    (remark,) = (one for one in said["remarks"] if one["code"] == "calibration")
    assert "(covariance.json, 12 planned pictures)" in remark["text"]


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (("--preset", "oak-d"), 1, "covariance.json: is the calibration of another rig"),
        (("--preset", "oak-d", "--baseline", "50,75"), 2, "2 rigs and covariance.json"),
        (("--preset", "oak-d", "--assume", "ASSUMED"), 2, "and an assumed rig or a perturbation both given"),
    ],
)
def test_slips_of_a_calibrated_sweep_are_one_line(
    capsys: pytest.CaptureFixture[str],
    file: Path,
    tmp_path: Path,
    words: tuple[str, ...],
    code: int,
    message: str,
) -> None:
    rigsim.write_rig(tmp_path / "assumed.toml", rigsim.preset("oak-d").rig)
    typed = [str(tmp_path / "assumed.toml") if word == "ASSUMED" else word for word in words]
    assert run([*FEW, "--calibration", str(file), "--out", str(tmp_path / "out"), *typed]) == code
    said = capsys.readouterr()
    assert message in said.err
    assert said.err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_draw_that_is_no_rig_is_said_so() -> None:
    loose = replace(LEFT, matrix=1e12 * LEFT.matrix)
    with pytest.raises(InvalidRange, match="drawn from the covariance is no rig"):
        calibrations(loose, RIG, 50, np.random.default_rng(0))
