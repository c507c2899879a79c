"""What whole calibrations say beside a plan, in words and documents; and which truth they meet."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

import rigsim
from rigsim.api.calibrate.plan import PlannedCalibration
from rigsim.present.calibrate.drift_words import drift_heads, drift_rows
from rigsim.present.calibrate.plan_page import plan_html
from rigsim.present.calibrate.witness_words import (
    agreement_words,
    true_sentence,
    witness_rows,
    witness_sentences,
)
from rigsim.study.agreement.agreement import Agreement
from rigsim.study.calibrate.drift import drift
from rigsim.study.calibrate.witness.bench import CalibrationBench
from rigsim.study.calibrate.witness.result import CalibrationWitness, WitnessedDepth
from rigsim.study.calibrate.witness.truth import true_depth
from tests.helpers.calibrate.plans import made_plan
from tests.helpers.cli import rigsim as run
from tests.helpers.documents import misplaced, valid

DEPTH = WitnessedDepth(2.0, 0.001, 0.00104, -0.0002, (0.96, 1.13))
WITNESS = CalibrationWitness(
    name="simulated",
    calibrations=300,
    failed=0,
    corner_noise_px=0.1,
    rms_px=0.098,
    misfit=0.999,
    depths=(DEPTH,),
    parameter_ratio=0.99,
    parameter_interval=(0.975, 1.006),
    agreement=Agreement("agrees", "simulated"),
    boards=12,
)
BENT = rigsim.BrownConrady(-0.3, 0.1, 0.0, 0.0, 0.05)


def bent(lens: rigsim.BrownConrady) -> rigsim.StereoRig:
    rig = rigsim.preset("oak-d").rig
    return replace(rig, left=replace(rig.left, lens=lens), right=replace(rig.right, lens=lens))


def test_a_witness_stands_beside_the_prediction() -> None:
    assert witness_rows([WITNESS]) == [("simulated", "2", "1.00", "1.04", "1.040", "0.960 to 1.130", "−0.20")]
    (said,) = witness_sentences([WITNESS])
    assert said == (
        "Simulated, 300 calibrations of corners with noise, 12 places of the board each: agrees."
        " All parameters together scatter 0.990 times as predicted (0.975 to 1.006)."
        " Corners were 0.1 px off; the residual, 0.098 px, is 0.999 times what that noise leaves."
    )


def test_a_bias_and_a_residual_that_noise_does_not_explain_are_said() -> None:
    off = replace(
        WITNESS,
        name="measured",
        misfit=2.95,
        parameter_ratio=math.nan,
        depths=(replace(DEPTH, mean_m=0.016), replace(DEPTH, z_m=1.0, mean_m=-0.0005)),
        agreement=Agreement("flagged", "measured", "mean", "mean depth"),
        by_opencv=True,
        failed=2,
    )
    (said,) = witness_sentences([off])
    assert "rendered pictures by OpenCV" in said
    assert "; 2 found no rig: flagged: depths are off on average" in said
    assert "lens or board are not what the calibration takes them for" in said
    assert "At 2 m depths are 16.0 mm too large on average" in said
    assert "parameters" not in said


@pytest.mark.parametrize(
    ("agreement", "says"),
    [
        (Agreement("agrees"), ""),
        (Agreement("flagged", "simulated", "spread", "depth spread", 2.0), "depths scatter 2.00 times"),
        (Agreement("flagged", "measured", "spread", "residuals", 1.5), "residuals are 1.50 times"),
        (Agreement("flagged", "simulated", "all-failed", "failures", 1.0), "none of them found a rig"),
        (
            Agreement("untold", "simulated", "too-few-trials", count=(3, 8)),
            "3 of them are too few to tell, 8",
        ),
    ],
)
def test_why_they_do_not_agree_is_said(agreement: Agreement, says: str) -> None:
    assert agreement_words(agreement).startswith(says)


def test_the_page_and_the_document_show_them(tmp_path: Path) -> None:
    page = plan_html(made_plan(), [WITNESS])
    assert "Checked by whole calibrations" in page
    assert "0.960 to 1.130" in page
    words = "calibrate plan --preset oak-d --board 9x6@30mm --poses 6 --at 2m --simulate 12 --json"
    document = valid("calibrate-plan", run(*words.split(), cwd=tmp_path).stdout)
    assert misplaced("calibrate-plan", document) == []
    (one,) = document["witnesses"]
    assert (one["name"], one["calibrations"], document["complete"]) == ("simulated", 12, True)
    (depth,) = one["depths"]
    assert depth["predicted_mm"] == pytest.approx(document["depth_std"][0]["calibration_mm"], rel=1e-6)
    assert 0.4 < depth["ratio"] < 1.8


def test_a_goal_that_the_true_board_misses_is_said_first_at_the_distance_asked_for() -> None:
    # 3-4-12: 3 mm off on average, 4 mm of spread, and what remains of 13 mm of pixel noise
    plan = made_plan(error_m=0.02, noise_px=0.25 * 12 / 21.3692)
    off = WitnessedDepth(2.0, 0.004, 0.004, 0.003, (0.9, 1.1))
    worse = WitnessedDepth(1.0, 0.001, 0.001, 0.050, (0.9, 1.1))
    one = replace(WITNESS, depths=(worse, off), true_board=True)
    found = true_depth(plan, [WITNESS, one])
    assert found is not None
    assert found.rms_m == pytest.approx(0.013, rel=1e-3)
    assert found.met is True
    assert true_sentence(plan, [one]).startswith(
        "With the true board this plan meets 20 mm: in 300 simulated"
    )
    assert "1 m" not in true_sentence(plan, [one])
    biased = replace(one, depths=(worse, replace(off, mean_m=-0.019)))
    said = true_sentence(plan, [biased])
    assert "this plan misses 20 mm" in said
    assert "depths at 2 m are 19.0 mm too small on average" in said
    assert said.endswith("let the calibration find its warp (`--warp`).")
    assert said.split(" More")[0] in plan_html(plan, [biased])
    document = PlannedCalibration(plan, (biased,)).document()
    assert document["true_depth"]["met"] is False
    assert document["headline"].endswith("warp (--warp).")
    (at_two,) = witness_sentences([biased], plan)
    assert "At 2 m depths are 19.0 mm too small" in at_two


def test_a_true_lens_is_remedied_by_its_model_and_no_truth_says_nothing() -> None:
    plan = made_plan()
    off = replace(WITNESS, depths=(replace(DEPTH, mean_m=0.019),), true_lens="rational")
    assert true_sentence(plan, [off]).startswith("With the true lens (rational) this plan misses 20 mm")
    assert "`--model rational`" in true_sentence(plan, [off])
    assert true_sentence(plan, [WITNESS]) == ""
    flagged = replace(off, true_lens="", agreement=Agreement("flagged", "measured", "mean", "mean depth"))
    assert true_sentence(plan, [flagged]).startswith("This plan misses 20 mm")


def test_what_an_agreement_excuses_is_said_where_an_interval_does_not_hold_1() -> None:
    outside = replace(WITNESS, depths=(replace(DEPTH, interval=(1.010, 1.131)),))
    (said,) = witness_sentences([outside])
    assert ": agrees, within the 5 % of scatter that such calibrations may differ by." in said
    (said,) = witness_sentences([replace(outside, name="measured")])
    assert "within the 25 % of scatter" in said


def test_the_distance_asked_for_is_witnessed_though_it_is_not_told() -> None:
    bench = CalibrationBench.of(made_plan(at_m=(1.0, 3.0)))
    assert bench.at_m == (1.0, 2.0, 3.0)
    assert CalibrationBench.of(made_plan()).at_m == (1.0, 2.0, 3.0, 5.0)


def test_drift_is_told_in_mm_with_its_size() -> None:
    rig = rigsim.preset("oak-d").rig
    found = drift(rig, [2.0])
    rows = {row[0]: row for row in drift_rows(found)}
    assert drift_heads(found) == ("change", "by", "at 2 m", "size from")
    # aluminium, 23e-6 a kelvin of the baseline, is as much of the depth: 0.046 mm of 2 m
    assert rows["bar warmer"] == ("bar warmer", "1 K", "0.046 (0.046)", "aluminium")
    # yaw of 0.01 deg: z^2 / b times it, 4 / 0.075 * 1.745e-4 = 9.3 mm
    assert rows["right camera turned"][2].startswith("9.3 (")


def test_a_warped_board_leaves_what_no_covariance_knows() -> None:
    def misfit(**true: object) -> float:
        found = rigsim.plan_calibration("oak-d", poses=6, at_m=2, simulate=10, **true)
        (one,) = found.witnesses
        return one.misfit

    assert misfit() == pytest.approx(1, abs=0.05)
    assert misfit(true_warp_mm=1.0) > 1.5


def test_the_true_lens_is_the_files_or_the_rigs_own(tmp_path: Path) -> None:
    path = tmp_path / "true.toml"
    path.write_text(rigsim.write_rig(bent(BENT)))
    lean = bent(replace(BENT, k3=0.0))

    def misfit(rig: rigsim.StereoRig, **asked: object) -> float:
        found = rigsim.plan_calibration(rig, poses=6, at_m=2, simulate=10, **asked)
        return found.witnesses[0].misfit

    assert misfit(lean, fix="k3", true_model=path) > 1.15
    assert misfit(lean, fix="k3") == pytest.approx(1, abs=0.05)
    # a model that holds the lens exactly is no other lens
    assert misfit(lean, true_model="rational") == pytest.approx(1, abs=0.05)


def test_a_true_lens_that_is_none_is_refused_before_anything(tmp_path: Path) -> None:
    words = "calibrate plan --preset oak-d --board 9x6@30mm --simulate 10 --true-model nonsense"
    done = run(*words.split(), cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("rigsim: error: true model 'nonsense': is no lens model, and no rig:")
    assert done.stderr.count("\n") == 1
