"""Agreement holds for depth and position, mean and spread, bins and regions; little tells nothing."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

from rigsim import Intrinsics, PixelNoise, Plan, StereoRig, sweep, triangulate
from rigsim.present.kit.agreement import reason, text
from rigsim.study.agreement.agreement import AGREES, Agreement, AgreementPlace, Reason, worst
from rigsim.study.agreement.agreement import flagged as flagged_rows
from rigsim.study.agreement.claims import Scale, claim_scale, measured_agreement
from rigsim.study.agreement.fault import Fault
from rigsim.study.agreement.views import expand_views, predict_views, view_jacobian, views
from rigsim.study.saying import saying
from rigsim.study.scene.columns import MEASURED_COLUMNS
from rigsim.study.scene.trials import predict
from tests.helpers.scenes import SLANTED, write

LENS = Intrinsics(320, 240, 300.0, 300.0, 159.5, 119.5)
RIG = StereoRig.rectified(LENS, 0.2)


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> str:
    return write(tmp_path_factory.mktemp("scene"), SLANTED)


def plan(scene: str, **changes: object) -> Plan:
    defaults = {"scene": scene, "renderer": "rays", "n_points": 500, "n_trials": 100, "measure": "none"}
    return Plan(**(defaults | changes))


def mirrored(rig, uv_left, uv_right):
    return triangulate(rig, uv_left, uv_right) * (-1, 1, 1)


def on_the_axis(rig, uv_left, uv_right):
    return triangulate(rig, uv_left, uv_right) * (0, 0, 1)


def one_percent(rig, uv_left, uv_right):
    return triangulate(rig, uv_left, uv_right) * 1.01


def offset(rig, uv_left, uv_right):
    return triangulate(rig, uv_left + np.array([0.02, 0.0]), uv_right)


def lower(rig, uv_left, uv_right):
    return triangulate(rig, uv_left + np.array([0.0, 0.05]), uv_right + np.array([0.0, 0.05]))


def right_fifth(rig, uv_left, uv_right):
    points = triangulate(rig, uv_left, uv_right)
    points[uv_left[:, 0] > 0.8 * rig.left.width] *= 1.05
    return points


def same_answer(rig, uv_left, uv_right):
    """Averages over what it is given: it scatters less than its pixels allow."""
    points = triangulate(rig, uv_left, uv_right)
    return points + 0.1 * (np.roll(points, 1, axis=0) - points)


def wavy(rig, uv_left, uv_right):
    """A tenth of a pixel either way in stripes of ten pixels: no region's mean shows it."""
    wave = 0.1 * np.sign(np.sin(uv_left[:, 0] * math.pi / 10))
    return triangulate(rig, uv_left + np.column_stack([wave, np.zeros(len(wave))]), uv_right)


@pytest.mark.parametrize(
    ("broken", "words"),
    [
        (mirrored, "simulated position error"),
        (on_the_axis, "simulated position error"),
        (one_percent, "simulated "),
        (offset, "simulated mean depth is"),
        (lower, "simulated mean position down is"),
        (right_fifth, "simulated error"),
        (same_answer, "simulated "),
        (wavy, "simulated "),
    ],
)
def test_what_a_depth_spread_does_not_show_is_flagged(scene: str, broken, words: str):
    rows = sweep([RIG], plan(scene, triangulators=("optimal", broken))).rows
    assert rows["agreement"][0].kind == "agrees"
    assert text(rows["agreement"][1]).startswith("flagged: " + words)
    assert rows["agreement_witness"][1] == "simulated"


def test_a_flagged_bin_flags_the_row(scene: str):
    def near_only(rig, uv_left, uv_right):
        points = triangulate(rig, uv_left, uv_right)
        near = points[:, 2] < np.quantile(points[:, 2], 0.05)
        points[near] *= 1.02
        return points

    result = sweep([RIG], plan(scene, triangulators=(near_only,), n_trials=100))
    flagged = flagged_rows(result.by_depth)
    assert flagged.any()
    assert not flagged.all()
    assert result.rows["agreement"][0].kind == "flagged"


def test_no_overlap_in_the_nearest_bin_is_no_disagreement(scene: str):
    # half the width of the image is 160 px: nothing nearer than f b / 320 = 1.41 m is in both
    result = sweep([StereoRig.rectified(LENS, 1.5)], plan(scene))
    apart = result.by_depth["visible_fraction"] == 0
    assert apart.any()
    assert all(one.reason == "nothing-shared" for one in result.by_depth["agreement"][apart])
    assert result.rows["agreement"][0].kind == "agrees"


FAR = {
    "equal lenses": StereoRig.rectified(LENS, 0.056),
    "right lens zoomed": StereoRig.rectified(LENS, 0.042, right=replace(LENS, fx=900.0, fy=900.0)),
}


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("name", FAR)
def test_tails_flag_no_correct_rig(scene: str, name: str, seed: int):
    row = sweep([FAR[name]], plan(scene, noises=(PixelNoise(0.7),), seed=seed)).rows.loc[0]
    assert 0.02 < row["low_disparity_fraction"] < 0.98
    assert row["agreement"].kind == "agrees"
    # within four standard errors, as the simulation's own 95 % interval has them
    error = (row["depth_rmse_ci_high_mm"] - row["depth_rmse_ci_low_mm"]) / (2 * 1.96 * row["depth_rmse_mm"])
    assert error < 0.05
    assert row["predicted_over_simulated"] == pytest.approx(1, abs=4 * error)
    # beyond the limit the error of 1/Z is what can be told, to 1 / sqrt(2 n): 4 of these
    n_far = row["low_disparity_fraction"] * row["n_visible"] * row["n_trials"]
    assert row["far_inverse_depth_rmse_per_m"] == pytest.approx(
        row["predicted_far_inverse_depth_rmse_per_m"], rel=4 / math.sqrt(2 * n_far)
    )


@pytest.mark.parametrize("method", ["dlt", "midpoint"])
@pytest.mark.parametrize("right_focal_px", [300.0, 900.0])
def test_methods_that_fall_short_by_nature_are_held_to_their_own(
    scene: str, method: str, right_focal_px: float
):
    rig = StereoRig.verged(LENS, 0.2, 6.0, right=replace(LENS, fx=right_focal_px, fy=right_focal_px))
    rows = sweep([rig], plan(scene, triangulators=(method,), noises=(PixelNoise(0.3),))).rows
    assert rows["agreement"][0].kind == "agrees"


def test_few_triangulations_tell_nothing(scene: str):
    row = sweep([RIG], plan(scene, n_points=10, n_trials=1)).rows.loc[0]
    assert text(row["agreement"]).startswith("untold: ")
    assert text(row["agreement"]).endswith("triangulations are too few")


def test_views_by_hand():
    point = np.array([[0.5, -0.25, 2.0]])
    np.testing.assert_allclose(views(point), [[0.5, 0.25, -0.125]])
    numeric = [(views(point + h) - views(point - h))[0] / 2e-6 for h in 1e-6 * np.eye(3)]
    np.testing.assert_allclose(view_jacobian(point)[0], np.transpose(numeric), atol=1e-9)


def test_one_over_z_of_a_rectified_rig_is_exactly_gaussian():
    # 1/Z = d / (f b): std sqrt(2) 0.25 / 60 per metre, no bias; X/Z follows the left pixel alone
    points = np.array([[0.3, 0.2, 3.0], [-1.0, 0.5, 9.0]])
    bias, covariance = predict_views(RIG, points, PixelNoise(0.25))
    np.testing.assert_allclose(np.sqrt(covariance[:, 0, 0]), math.sqrt(2) * 0.25 / 60, rtol=1e-9)
    np.testing.assert_allclose(np.sqrt(covariance[:, 1, 1]), 0.25 / 300, rtol=1e-9)
    np.testing.assert_allclose(np.sqrt(covariance[:, 2, 2]), 0.25 / 300 / math.sqrt(2), rtol=1e-9)
    np.testing.assert_allclose(bias, 0, atol=1e-8)


def test_the_second_order_of_crossed_cameras_is_that_of_the_method_itself():
    rig = StereoRig.verged(LENS, 0.3, 20.0)
    points = np.array([[0.1, 0.2, 1.0], [-0.2, 0.1, 2.5]])
    noise = PixelNoise(0.5, correlation=0.3)
    for known, expanded in zip(
        predict_views(rig, points, noise), expand_views(rig, points, noise, "optimal"), strict=True
    ):
        np.testing.assert_allclose(known, expanded, rtol=2e-3, atol=2e-9)


def test_the_rms_without_infinity_is_the_integrals():
    # Z / sigma_Z of 4 and 20; from 4e6 draws of Z / (1 + g / s) where s + g >= 1, in units of sigma_Z
    z = np.array([300 * 0.2 / (4 * math.sqrt(2) * 0.25), 300 * 0.2 / (20 * math.sqrt(2) * 0.25)])
    points = np.column_stack([np.zeros(2), np.zeros(2), z])
    got = predict(RIG, points, PixelNoise(0.25)).depth_rmse_m
    np.testing.assert_allclose(got * (4, 20) / z, (1.3792, 1.0113), rtol=2e-3)


def row(n: int, scale: Scale, method: str = "corners") -> dict:
    columns = dict.fromkeys(MEASURED_COLUMNS, math.nan)
    ends = {"": scale.value, "_ci_low": scale.low, "_ci_high": scale.high}
    return (
        columns
        | {"measured_method": method, "measured_n": n}
        | {f"measured_scale{end}": value for end, value in ends.items()}
    )


def measured(errors: np.ndarray) -> Agreement:
    return measured_agreement(row(len(errors), claim_scale(errors**2, 1)), len(errors), "")


@pytest.mark.parametrize(
    ("n", "std", "kind"),
    [
        (1, 6.7, "untold"),
        (21, 1.0, "untold"),
        (21, 3.61, "flagged"),
        (400, 1.0, "agrees"),
        (400, 0.85, "agrees"),
        (400, 0.47, "untold"),
        (400, 2.2, "flagged"),
    ],
)
def test_a_claim_is_held_to_its_errors(n: int, std: float, kind: str):
    errors = std * np.random.default_rng(5).standard_normal(n)
    if n == 1:
        errors = np.array([6.7])
    assert measured(errors).kind == kind


def test_a_cautious_claim_is_told_as_such():
    errors = 0.47 * np.random.default_rng(1).standard_normal(1000)
    assert "that estimate is too cautious to confirm" in text(measured(errors))


def test_a_tenth_of_outlandish_errors_moves_no_verdict():
    errors = np.random.default_rng(2).standard_normal(1000)
    errors[:50] *= 100
    assert measured(errors).kind == "agrees"


@pytest.mark.parametrize(("n", "degrees"), [(60, 1), (400, 4)])
def test_the_scale_s_interval_holds_it_99_times_of_100(n: int, degrees: int):
    rng = np.random.default_rng(3)
    repeats = 2000
    found = [claim_scale(rng.chisquare(degrees, n), degrees) for _ in range(repeats)]
    covered = sum(one.low <= 1 <= one.high for one in found)
    assert covered / repeats > 0.985
    assert np.mean([one.value for one in found]) == pytest.approx(1, abs=0.03)


def test_half_of_nothing_is_flagged_and_two_of_five_are_not():
    fine = Scale(1.0, 0.9, 1.1)
    assert measured_agreement(row(50, fine), 100, "").quantity == "outliers"
    assert measured_agreement(row(3, Scale(1.0, 0.0, math.inf)), 5, "").kind == "untold"
    assert measured_agreement(row(90, fine), 100, "").kind == "agrees"


def test_words_begin_with_the_kind():
    assert text(AGREES) == "agrees"
    fault = Fault("unknown", saying("none-known"))
    place = AgreementPlace("depth", (2, 2.5))
    flagged = Agreement("flagged", "simulated", "spread", "depth spread", 2.25, place=place, fault=fault)
    assert (
        text(flagged)
        == "flagged: simulated error 2.25 times the prediction at 2 to 2.5 m; no single known mistake "
        "explains it"
    )
    assert reason(flagged) == text(flagged).removeprefix("flagged: ")
    assert reason(AGREES) == ""


def test_every_reason_has_words():
    for one in get_args(Reason):
        said = text(Agreement("untold", "simulated", one, cause="nobody came"))
        assert said.startswith("untold: ")
        assert len(said) > 12 or not one


def test_the_worst_counts():
    untold, flagged = Agreement("untold", reason="exact"), Agreement("flagged", reason="mean")
    assert worst([AGREES, untold, flagged, Agreement("flagged", reason="spread")]) is flagged
    assert worst([AGREES, untold]) is untold
    assert worst([]) is AGREES
