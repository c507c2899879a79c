"""What is said of a plan follows from its numbers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from rigsim.present.calibrate import plan_words
from rigsim.present.calibrate.plan_console import curve_rows, depth_rows
from rigsim.present.calibrate.plan_page import plan_html
from rigsim.present.calibrate.words import parameter
from rigsim.study.calibrate.enough import chosen_depth, enough
from rigsim.study.calibrate.estimated import estimates
from rigsim.study.calibrate.plan.asked import DepthGoal
from rigsim.study.calibrate.plan.result import CalibrationPlan, CurvePoint, PicturesNeeded, Remedy
from rigsim.study.calibrate.projection import projection_map
from tests.helpers.calibrate.plans import made_plan

PLAN = made_plan()


def curve(*calibrations_m: float, noise_m: float = 0.01) -> tuple[CurvePoint, ...]:
    return tuple(
        CurvePoint(k, one, 2 * one, math.hypot(one, noise_m)) for k, one in enumerate(calibrations_m, 2)
    )


def needing(
    count: int | None, hindrance: str = "", *remedies: Remedy, error_m: float = 0.02
) -> CalibrationPlan:
    asked = replace(PLAN.asked, goal=DepthGoal(error_m, 2.0))
    return replace(PLAN, asked=asked, needed=PicturesNeeded(count, hindrance, remedies=remedies))


def test_the_headline_tells_both_parts_and_their_sum_of_squares() -> None:
    row = chosen_depth(PLAN)
    # sqrt(2) 0.25 px z^2 / (f b) of 882.5 px and 75 mm at 2 m
    assert row.observation_m == pytest.approx(math.sqrt(2) * 0.25 * 4 / (882.5 * 0.075), rel=1e-3)
    assert row.joint_m == pytest.approx(math.sqrt(row.calibration_m**2 + row.observation_m**2))
    asked = replace(PLAN.asked, goal=None, at_m=(2.0,))
    said = plan_words.headline(replace(PLAN, asked=asked, needed=PicturesNeeded(None)))
    assert said == (
        "12 pictures of the 9x6 board of 30 mm squares give 21.4 mm of depth std at 2 m on the axis:"
        f" {row.calibration_m * 1e3:.2f} mm by calibration, 21.4 mm by pixel noise."
    )


@pytest.mark.parametrize(
    ("count", "says"),
    [
        (None, "; no number of pictures gives 20 mm"),
        (7, "; 7 are enough for 20 mm there, but take 8, so that a bad picture shows."),
        (12, "; it takes all of them for 20 mm."),
        (31, "; it takes 31 for 20 mm."),
    ],
)
def test_the_headline_says_how_many_it_takes(count: int | None, says: str) -> None:
    assert says in plan_words.headline(needing(count))


def test_pixel_noise_in_the_way_is_said_with_the_noise_that_would_do() -> None:
    # 21.37 mm of 0.25 px; 20 mm of 0.25 * 20 / 21.37
    said = plan_words.hindrance_sentence(needing(None, "observation"))
    assert "0.25 px alone makes 21.4 mm" in said
    assert "good to 0.23 px" in said


def test_a_remedy_is_said_with_what_it_gives() -> None:
    does = plan_words.hindrance_sentence(needing(None, "board", Remedy("board", 0.018)))
    assert does == (
        "In the way: the board is too small; take a larger one (`--board 9x6@60mm`): that gives up to"
        " 18.0 mm."
    )
    fails = plan_words.hindrance_sentence(needing(None, "tilt", Remedy("tilt", 0.024)))
    assert fails.endswith("that helps the most, but gives 24.0 mm at best.")
    for code in ("range", "corner_noise", "flatness"):
        assert plan_words.hindrance_sentence(needing(None, code, Remedy(code, 0.01)))


def test_enough_is_where_calibration_adds_less_than_five_percent() -> None:
    # 5 % over 10 mm is sqrt(1.05^2 - 1) = 0.3202 of it by calibration
    asked = replace(PLAN.asked, goal=None)
    plan = replace(PLAN, asked=asked, curve=curve(math.inf, 0.02, 0.00321, 0.00320, 0.001))
    assert enough(plan) == 5
    assert "From 5 pictures on" in plan_words.enough_sentence(plan)
    assert enough(replace(PLAN, curve=curve(0.02, 0.01))) is None
    assert plan_words.enough_sentence(replace(PLAN, curve=curve(0.02, 0.01))) == ""
    assert "Already with 2 pictures" in plan_words.enough_sentence(replace(plan, curve=curve(0.001)))
    # without pixel noise calibration is all there is, and never too little
    assert enough(replace(PLAN, curve=curve(0.02, 0.001, noise_m=0.0))) is None


def test_what_pictures_leave_open_is_said_so() -> None:
    rows = curve_rows(replace(PLAN, curve=curve(math.inf, 0.02)))
    assert rows[0][:4] == ("2", "open", "open", "open")
    assert rows[1][:3] == ("3", "20.0", "40.0")


def test_the_depth_table_is_in_mm() -> None:
    first = PLAN.depths[0]
    assert depth_rows(PLAN)[0][:2] == ("1", "axis")
    assert float(depth_rows(PLAN)[0][3]) == pytest.approx(first.observation_m * 1e3, rel=0.005)


def test_the_corner_is_told_where_it_is_worse() -> None:
    said = plan_words.corner_sentence(PLAN)
    assert "at the picture's corner" in said
    assert "26.4 mm" in said  # the depth table's, at 2 m


def test_parameters_have_names_values_and_units() -> None:
    found = {one.name: one for one in estimates(PLAN)}
    assert found["left.fx"].value == pytest.approx(882.5)
    assert found["tx_m"].value == pytest.approx(-75.0)
    assert found["tx_m"].unit == "mm"
    index = PLAN.covariance.names.index("ry_rad")
    assert found["ry_rad"].std == pytest.approx(math.degrees(PLAN.covariance.std[index]))
    assert len(found) == 24
    assert parameter("left.cx") == "the left principal point u"
    assert parameter("ry_rad") == "the yaw between the cameras"
    assert parameter("right.k1") == "the right k1"


def test_pairs_that_are_hardly_told_apart_are_named() -> None:
    said = plan_words.inseparable_sentence(PLAN)
    assert "the left principal point u and the yaw between the cameras (0.970)" in said
    assert "(−0.950)" in said


def test_the_map_is_the_covariances_own_number() -> None:
    found = projection_map(PLAN.covariance, 1, 2.0)
    at = PLAN.asked.rig.right.ray(np.array([[found.u_px[3], found.v_px[5]]])) * 2.0
    assert found.std_px[5, 3] == pytest.approx(PLAN.covariance.projection_std(1, at)[0])
    assert found.std_px[20, 20] < found.std_px[0, 0]


def test_the_page_has_a_card_a_pose_and_no_network() -> None:
    page = plan_html(PLAN, command="rigsim calibrate plan <&>")
    assert page.count('<li class="card">') == 12
    assert page.count("<svg viewBox") == 24
    assert "rigsim calibrate plan &lt;&amp;&gt;" in page
    assert "http" not in page.replace("http://www.w3.org", "")
    assert "<script" not in page


def test_choosing_is_told_where_it_pays() -> None:
    chosen = replace(PLAN, asked=replace(PLAN.asked, poses=12))
    point = next(one for one in PLAN.curve if one.pictures == 12)
    assert f"{point.random_m * 1e3:.2f} mm" in plan_words.gain_sentence(chosen)
    assert "1.5 times as much" in plan_words.gain_sentence(chosen)
    given = replace(PLAN, asked=replace(PLAN.asked, poses=PLAN.poses))
    assert plan_words.gain_sentence(given) == ""  # random ones are worse
    better = tuple(replace(one, random_m=one.calibration_m / 2) for one in PLAN.curve)
    assert plan_words.gain_sentence(replace(given, curve=better)).endswith(
        "0.4 to 1.2 m away and tilted up to 40°: better than these."
    )
    assert plan_words.order_sentence(given) == "In the order of the file."
    assert plan_words.order_sentence(chosen).startswith("Best first")
