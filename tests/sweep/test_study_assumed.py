"""A true rig that projects and an assumed rig that triangulates: Python, rig.toml, command line."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import pytest

from rigsim import Intrinsics, Perturbation, Plan, RigGrid, StereoRig, sweep
from rigsim.cli.app import run
from rigsim.errors import InvalidRange, InvalidRig
from rigsim.interop.formats.rig_toml import parse_perturbation, parse_rig
from rigsim.present.kit.agreement import spelled, text
from tests.helpers.scenes import SLANTED, write

LENS = Intrinsics(160, 120, 150.0, 150.0, 79.5, 59.5)
RIG = StereoRig.rectified(LENS, 0.2)
YAW = Perturbation(yaw_rad=math.radians(0.3))
SHORT = "baseline_mm = 120\nwidth_px = 640\nheight_px = 480\nfocal_px = 500\n"


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> str:
    return write(tmp_path_factory.mktemp("scene"), SLANTED)


def plan(scene: str, **changes: object) -> Plan:
    defaults = {"scene": scene, "renderer": "rays", "n_points": 300, "n_trials": 60, "measure": "none"}
    return Plan(**(defaults | changes))


def test_a_perturbed_rig_is_flagged_with_what_it_is_and_errs_as_geometry_says(scene: str):
    result = sweep([RIG], plan(scene, perturbation=YAW))
    row = result.rows.loc[0]
    assert text(row["agreement"]).startswith("flagged: ")
    assert "yaw: the right camera looks 0.300 deg further right" in text(row["agreement"])
    assert result.faults[0] is not None
    assert result.faults[0].amount == pytest.approx(0.3, rel=1e-3)
    # a right camera that looks further right sees points further left: disparity f (1 + x^2) psi too large
    X, _, Z = result.showcase.points_left[result.showcase.visible].T
    x_right = (X - 0.2) / Z
    too_large_px = 150 * (1 + x_right**2) * math.radians(0.3)
    expected_m = 150 * 0.2 / (150 * 0.2 / Z + too_large_px) - Z
    assert row["depth_bias_mm"] == pytest.approx(1e3 * expected_m.mean(), rel=0.03)
    assert row["depth_bias_mm"] < 0


def test_the_assumed_rig_triangulates_and_the_swept_one_projects(scene: str):
    there = sweep([YAW.apply(RIG)], plan(scene, assumed=RIG)).rows.loc[0]
    back = sweep([RIG], plan(scene, assumed=YAW.apply(RIG))).rows.loc[0]
    assert "0.300 deg further right" in text(there["agreement"])
    assert "0.300 deg further left" in text(back["agreement"])
    assert there["depth_bias_mm"] < 0 < back["depth_bias_mm"]


def test_an_assumed_rig_that_is_the_true_one_agrees(scene: str):
    alone = sweep([RIG], plan(scene)).rows
    same = sweep([RIG], plan(scene, assumed=replace(RIG))).rows
    assert same.loc[0, "agreement"].kind == "agrees"
    assert same.equals(alone)


def test_a_perturbation_goes_with_every_rig_and_an_assumed_rig_with_one(scene: str):
    grid = RigGrid(RIG, baselines_m=(0.1, 0.2))
    rows = sweep(grid, plan(scene, perturbation=YAW)).rows
    assert spelled(rows)["agreement"].str.contains("yaw: the right camera looks 0.300 deg").all()
    with pytest.raises(InvalidRange, match="2 rigs and one that is assumed"):
        sweep(grid, plan(scene, assumed=RIG))


def test_what_cannot_be_assumed_is_refused(scene: str):
    with pytest.raises(InvalidRange, match="both given"):
        plan(scene, assumed=RIG, perturbation=YAW)
    other = StereoRig.rectified(replace(LENS, width=320), 0.2)
    with pytest.raises(
        InvalidRig, match="left picture of 320x120 px must be as large as the true rig's, 160x120"
    ):
        sweep([RIG], plan(scene, assumed=other))


def test_a_rig_file_says_how_the_built_rig_differs():
    text = SHORT + (
        "[perturbation]\nyaw_deg = 0.5\npitch_deg = -0.25\nroll_deg = 1\nbaseline_mm = 2\naxial_mm = -3\n"
        "vertical_mm = 0.5\nright_focal_px = 1.5\nright_cx_px = -2\nright_k1 = 0.01\nboth_k1 = -0.02\n"
    )
    assert parse_rig(text) == parse_rig(SHORT)
    degree = math.pi / 180
    assert parse_perturbation(text) == Perturbation(
        0.5 * degree, -0.25 * degree, degree, 0.002, -0.003, 0.0005, 1.5, -2.0, 0.01, -0.02
    )
    assert parse_perturbation(SHORT) is None
    with pytest.raises(InvalidRig, match=r"unknown key perturbation\.yaw: must be one of yaw_deg"):
        parse_perturbation(SHORT + "[perturbation]\nyaw = 1\n")


def test_pictures_are_of_the_true_rig_and_measured_with_the_assumed_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    true, assumed = tmp_path / "true.toml", tmp_path / "assumed.toml"
    true.write_text(SHORT)
    assumed.write_text(SHORT.replace("120", "126"))
    words = f"sweep --rig {true} --assume {assumed} --points 200 --trials 10 --json"
    assert run(words.split()) == 0
    row = json.loads(capsys.readouterr().out)["rows"][0]
    assert row["diagnosis"]["mistake"] == "baseline"
    # 126 mm are taken for 120: every depth 5 % too far, in the simulation and in the pictures
    assert row["diagnosis"]["amount"] == pytest.approx(100 * (120 / 126 - 1), abs=0.01)
    assert row["baseline_mm"] == 120
    assert row["measured_depth_bias_mm"] / row["depth_bias_mm"] == pytest.approx(1, abs=0.4)
    assert row["measured_depth_bias_mm"] > 50


def test_one_assumed_rig_is_enough(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    plain, perturbed = tmp_path / "plain.toml", tmp_path / "perturbed.toml"
    plain.write_text(SHORT)
    perturbed.write_text(SHORT + "[perturbation]\nyaw_deg = 0.1\n")
    for rig, assume in ((perturbed, plain), (plain, perturbed)):
        assert run(f"sweep --rig {rig} --assume {assume} --out {tmp_path / 'no'}".split()) == 2
        assert "[perturbation]" in capsys.readouterr().err
    assert not (tmp_path / "no").exists()
