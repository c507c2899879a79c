"""`rigsim tolerance` with a calibration's covariance in place of a class: all parameters off together."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rigsim
from rigsim.cli.app import run
from rigsim.errors import InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.rational import Rational
from rigsim.rig.perturbation import Perturbation
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.batch import PARAMETERS, RigBatch, read_rays
from rigsim.study.tolerance.built import built_depths, draw
from rigsim.study.tolerance.count import count_good
from rigsim.study.tolerance.inputs import BuildRequirement, Tolerances, causes
from rigsim.study.tolerance.joint.cause import CalibrationTolerance, JointDraw
from rigsim.study.tolerance.joint.project import project_joint
from rigsim.study.tolerance.recalibration.session import Build
from rigsim.study.tolerance.rows import first_order_rows, row_errors_px
from rigsim.study.tolerance.run import run_tolerance
from rigsim.study.tolerance.sensitivities import first_order, shared_points
from rigsim.study.tolerance.sobol import combine, estimate
from rigsim.theory.calibration.covariance import CalibrationCovariance
from rigsim.theory.calibration.parameters import RigParameters
from tests.helpers.calibrate.covariances import calibrated, written
from tests.helpers.sampling import close

PLAIN = StereoRig.rectified(Intrinsics.from_focal(640, 480, 500.0), 0.1)


def _held(covariance: CalibrationCovariance, **more: float) -> Tolerances:
    return Tolerances(calibration=CalibrationTolerance("some.json", "12 pictures", covariance), **more)


def _only(rig: StereoRig, **std: float) -> CalibrationCovariance:
    """A calibration that leaves these parameters open alone, and independent."""
    parameters = RigParameters.of((None, None))
    variances = [std.get(name.replace(".", "_"), 0.0) ** 2 for name in parameters.names]
    return CalibrationCovariance(rig, parameters, np.diag([*variances, *[0.0] * 6]))


@pytest.mark.parametrize(
    ("lens", "model"),
    [
        (None, BrownConrady),
        (BrownConrady(k1=-0.12, k2=0.03, p1=0.001), BrownConrady),
        (KannalaBrandt(0.01, -0.002), KannalaBrandt),
        (Rational(k1=0.1, k4=0.12), Rational),
    ],
)
def test_rigs_of_a_batch_are_those_with_moved_parameters(lens: Lens | None, model: type[Lens]) -> None:
    camera = Intrinsics.from_focal(640, 480, 500.0, lens=lens)
    rig = StereoRig(
        camera, replace(camera, cx=330.0), Pose.from_rotvec((0.01, -0.03, 0.02), (-0.1, 0.002, 0))
    )
    parameters = RigParameters.of((model, model))
    rng = np.random.default_rng(1)
    size = np.where(np.char.startswith(parameters.names, "left.f"), 1.0, 1e-3)
    changes = rng.standard_normal((4, len(size))) * size
    points = np.column_stack([rng.uniform(-0.4, 0.4, (30, 2)), rng.uniform(1.0, 3.0, 30)])
    batch = RigBatch(rig, np.zeros((1, len(PARAMETERS))))
    found = project_joint(batch, JointDraw(parameters, changes), points)
    for row, pixels in zip(changes, found.transpose(1, 0, 2), strict=True):
        close(pixels.T, np.hstack(parameters.moved(rig, row).project(points)), atol=1e-9)


def test_a_longer_baseline_is_the_one_of_a_perturbation() -> None:
    # the sign: t of right_from_left is -0.1 m along x; 1 mm more of baseline is -1 mm of it
    parameters = RigParameters.of((None, None))
    change = np.zeros((1, len(parameters.names)))
    change[0, parameters.names.index("tx_m")] = -1e-3
    points = np.array([[0.1, 0.05, 2.0]])
    exact = np.zeros((1, len(PARAMETERS)))
    depth, pixels, _ = built_depths(PLAIN, exact, points, JointDraw(parameters, change))
    close(pixels[:, 0].T, np.hstack(Perturbation(baseline_m=1e-3).apply(PLAIN).project(points)), atol=1e-9)
    assert depth[0, 0] == pytest.approx(2.0 / 1.01, rel=1e-9)


def test_tolerances_come_on_top_of_a_calibration() -> None:
    parameters = RigParameters.of((None, None))
    change, theta = np.zeros((1, len(parameters.names))), np.zeros((1, len(PARAMETERS)))
    change[0, parameters.names.index("left.cx")] = 1.0
    theta[0, PARAMETERS.index("baseline_m")] = 1e-3
    points = np.array([[0.0, 0.0, 2.0]])
    depth, _, _ = built_depths(PLAIN, theta, points, JointDraw(parameters, change))
    # the disparity 500 x 0.101 / 2 = 25.25 px, and 1 px more
    assert depth[0, 0] == pytest.approx(50 / 26.25, rel=1e-9)


@pytest.mark.parametrize("lens", [None, BrownConrady(k1=-0.1, k2=0.02)])
def test_first_order_is_the_depth_std_from_the_camera_and_monte_carlo_agrees(
    lens: BrownConrady | None,
) -> None:
    covariance = calibrated(lens=lens, noise_px=0.02, pictures=30)
    off = causes(covariance.rig, _held(covariance))
    points = shared_points(covariance.rig, 1.5, 12)
    predicted = np.sqrt((first_order(covariance.rig, off, points) ** 2).sum(axis=1))
    close(predicted, covariance.depth_std(points, from_camera=True), rtol=1e-6)
    drawn = draw(off, 4000, np.random.default_rng(0))
    depths, _, _ = built_depths(covariance.rig, off.thetas(drawn), points, off.together(drawn))
    # 4000 draws tell a standard deviation to 1.1 %
    close(depths.std(axis=0), predicted, rtol=0.045)
    assert abs(depths.mean() - 1.5) < 0.1 * predicted.mean()
    # a second way to draw them: the covariance's own, on whole rigs
    errors = covariance.draws(150, np.random.default_rng(1))[:, :-6]
    moved = [covariance.parameters.moved(covariance.rig, -row) for row in errors]
    read = np.array([_read(covariance.rig, rig, points[:4]) for rig in moved])
    close(read.std(axis=0), predicted[:4], rtol=0.25)


def _read(assumed: StereoRig, true: StereoRig, points: Array) -> Array:
    return rigsim.triangulate(assumed, *true.project(points))[:, 2]


def test_rows_first_order_is_what_built_rigs_do() -> None:
    covariance = calibrated(lens=BrownConrady(k1=-0.1), noise_px=0.02, pictures=30)
    rig = covariance.rig
    off = causes(rig, _held(covariance))
    points = shared_points(rig, 1.5, 10)
    drawn = draw(off, 3000, np.random.default_rng(2))
    _, pixels, _ = built_depths(rig, off.thetas(drawn), points, off.together(drawn))
    rows = row_errors_px(RigBatch(rig, np.zeros((1, len(PARAMETERS)))), read_rays(rig, pixels))
    close(rows.std(axis=0), np.sqrt((first_order_rows(rig, off, points) ** 2).sum(axis=1)), rtol=0.06)


def test_by_hand_one_open_length_and_what_it_takes() -> None:
    # 0.5 mm of 100 mm is 0.5 % of the depth: 10 mm at 2 m; 15 mm are allowed, 95 of 100 are within 1.96 std
    result = run_tolerance(
        Build(PLAIN, _held(_only(PLAIN, tx_m=5e-4))),
        BuildRequirement(0.015, 2.0),
        (1.0, 3.0),
        n_rigs=2000,
        n_points=60,
        with_interactions=False,
    )
    (item,) = result.sensitivities
    assert item.key == "calibration"
    assert item.depth_rms_mm == pytest.approx((5.0, 10.0, 15.0))
    assert abs(item.common_mm) == pytest.approx(10.0)
    assert item.needed_alone == pytest.approx(1.5 / 1.95996, rel=1e-3)
    # beyond 15 mm lie rigs beyond 1.5 standard deviations, but for the second order
    assert result.yield_before == pytest.approx(0.866, abs=0.02)
    assert result.calibration_axis_m == pytest.approx((0.010, 0.010), rel=1e-6)


def test_what_is_open_together_adds_up_as_squares_and_takes_one_factor() -> None:
    # 10 mm of the length as above, and 0.125 px of Z^2 / (f B) = 80 mm/px: 10 mm; both all over the image
    covariance = _only(PLAIN, tx_m=5e-4, left_cx=0.125)
    result = run_tolerance(
        Build(PLAIN, _held(covariance, temperature_k=10.0)),
        BuildRequirement(0.015, 2.0),
        (1.0, 3.0),
        n_rigs=500,
        n_points=60,
    )
    both, bar = result.sensitivities
    assert (both.key, bar.key) == ("calibration", "temperature_k")
    assert both.depth_rms_mm[1] == pytest.approx(10 * math.sqrt(2))
    assert both.needed_alone == pytest.approx(1.5 / math.sqrt(2) / 1.95996, rel=0.03)
    assert both.share == pytest.approx(200 / (200 + (2000 * 2.3e-4) ** 2), rel=1e-6)
    assert result.interactions is not None
    assert result.interactions.keys == ("temperature_k", "calibration")
    assert result.interactions.error.first[1] == pytest.approx(both.share, abs=0.02)


def test_the_rows_that_it_may_be_off_by_are_one_factor_too() -> None:
    # left cy 0.2 px and rz, which turns rows: the bound is the 95th percentile of what both do
    result = run_tolerance(
        Build(PLAIN, _held(_only(PLAIN, left_cy=0.2, rx_rad=4e-4))),
        BuildRequirement(0.5, 2.0, row_px=0.4),
        (1.0, 3.0),
        n_rigs=1500,
        n_points=60,
        with_interactions=False,
    )
    (item,) = result.sensitivities
    # f x 4e-4 = 0.2 px and more away from the middle: sqrt(2) of 0.2 px, 1.96 of which is 0.56 px
    assert item.needed_alone == item.needed_for_rows == pytest.approx(0.4 / (0.2885 * 1.96), rel=0.05)
    kept = float((result.rows_px("built") <= 0.4).mean())
    assert kept == pytest.approx(0.834, abs=0.03)


def test_good_rigs_are_counted() -> None:
    found = count_good(
        Build(PLAIN, _held(_only(PLAIN, tx_m=5e-4))), BuildRequirement(0.015, 2.0), (1.0, 3.0), sizes=(3000,)
    )
    assert found.share == pytest.approx(0.866, abs=0.02)


def test_sobol_indices_of_a_group_are_those_of_its_sum() -> None:
    def model(x: Array) -> Array:
        return np.asarray((x[:, :1] + 2 * x[:, 1:2] + 2 * x[:, 2:3]) * 1.0)

    from scipy.special import ndtri

    read = estimate(model, ndtri, (slice(0, 1), slice(1, 3)), np.random.default_rng(0))
    assert read is not None
    found = combine(*read)
    assert found is not None
    close(found.first, [1 / 9, 8 / 9], atol=0.02)
    close(found.total, [1 / 9, 8 / 9], atol=0.02)


def test_another_rig_is_refused() -> None:
    covariance = calibrated()
    with pytest.raises(InvalidRig, match=r"some\.json: is the calibration of another rig \(640x480 px"):
        causes(PLAIN, _held(covariance))
    rig = covariance.rig
    nearly = replace(rig, left=replace(rig.left, fx=rig.left.fx * (1 + 1e-9)))
    assert causes(nearly, _held(covariance)).names == ("calibration",)


FEW = ["tolerance", "--rigs", "300", "--points", "60", "--range", "1:3m"]


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    covariance = calibrated(rigsim.preset("oak-d").rig, pictures=20, noise_px=0.05)
    return written(covariance, tmp_path_factory.mktemp("calibration") / "covariance.json")


def _document(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    assert run([*FEW, "--json", *words]) == 0
    read = json.loads(capsys.readouterr().out)
    assert isinstance(read, dict)
    return read


def test_a_file_in_place_of_a_class(capsys: pytest.CaptureFixture[str], file: Path) -> None:
    said = _document(capsys, "--class", str(file), "--tolerance", "temperature=10K")
    assert said["rig"]["baseline_mm"] == pytest.approx(75.0)  # the file's own
    assert [row["quantity"] for row in said["quantities"]] == ["calibration", "temperature_k"]
    first = said["quantities"][0]
    assert (first["unit"], first["tolerance"], first["source"]) == ("×", 1.0, "12 planned pictures")
    calibration = said["calibration"]
    assert calibration["file"] == "covariance.json"
    assert 0 < calibration["against_boards_mm"] < calibration["in_camera_mm"]
    assert "knows nothing of what changes later" not in calibration["says"]
    assert said["recalibration"] is None
    assert said["yield"]["recalibrated"] is None
    assert [remark["code"] for remark in said["remarks"]] == ["not_recalibrated"]
    named = _document(capsys, "--class", str(file), "--preset", "oak-d", "--no-recalibrate")
    assert named["remarks"] == []
    assert named["rig"] == said["rig"]


def test_what_is_printed_and_drawn(
    capsys: pytest.CaptureFixture[str], file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    assert run([*FEW, "--class", str(file), "--max-row-error", "0.3px", "--out", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr()
    said = " ".join(printed.out.split())
    assert "calibration (covariance.json) 1.00" in said
    assert "300 rigs so calibrated" in said
    assert "it knows nothing of what changes later" in said.lower()
    assert "its rigs are not recalibrated once more" in printed.err
    assert (tmp_path / "out" / "places.png").stat().st_size > 5000
    assert ",×,1,std,12 planned pictures," in (tmp_path / "out" / "tolerance.csv").read_text()


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (("--preset", "zed-mini"), 1, "is the calibration of another rig"),
        (("--class", "gone.json"), 1, "gone.json: cannot be read"),
        (
            ("--class", "gone"),
            2,
            "choose one of printed, machined, calibrated, none, or name a calibration's",
        ),
    ],
)
def test_slips_with_a_file_are_one_line(
    capsys: pytest.CaptureFixture[str],
    file: Path,
    tmp_path: Path,
    words: tuple[str, ...],
    code: int,
    message: str,
) -> None:
    assert run([*FEW, "--class", str(file), "--out", str(tmp_path / "out"), *words]) == code
    said = capsys.readouterr()
    assert message in said.err
    assert said.err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_rig_must_come_from_somewhere() -> None:
    with pytest.raises(rigsim.RigsimError, match="no rig: name one"):
        rigsim.tolerance()
