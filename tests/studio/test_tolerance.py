"""The Tolerance page's answers: exact ones of one built rig, and the ranking of the command line."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path

import numpy as np
import pytest

import rigsim
from rigsim.present.live.built import error_map, ranked_bars, round_up
from rigsim.rig.perturbation import Perturbation
from rigsim.studio.kit.controls import SignedSpan
from rigsim.studio.logic.tolerance import built as logic
from rigsim.studio.logic.tolerance import ranking, rows
from rigsim.studio.logic.tolerance.built import DEVIATIONS
from rigsim.studio.state import State, read_state
from rigsim.study.tolerance.one_rig import MAY_BE_OFF
from rigsim.study.tolerance.sensitivities import shared_points
from rigsim.theory.triangulation import triangulate
from tests.helpers.cli import rigsim as run

BASE = State({"preset": "boards", "range": "0.5:2m", "depth_error": "20mm@2m"})
OFF = {
    "off_yaw": ("0.02deg", {"yaw_rad": math.radians(0.02)}),
    "off_pitch": ("0.1deg", {"pitch_rad": math.radians(0.1)}),
    "off_roll": ("-0.2deg", {"roll_rad": math.radians(-0.2)}),
    "off_baseline": ("0.5mm", {"baseline_m": 0.5e-3}),
    "off_focal": ("3px", {"right_focal_px": 3.0}),
    "off_cx": ("-1.5px", {"right_cx_px": -1.5}),
}
"""Words, and what they are in SI units."""


@pytest.mark.parametrize("word", OFF)
def test_depth_errors_are_those_of_the_built_rig_read_as_the_assumed_one(word: str) -> None:
    text, change = OFF[word]
    found = logic.find(BASE.with_words(**{word: text}))
    assert found.answer is not None
    rig = rigsim.preset("boards").rig
    built = Perturbation(**change).apply(rig)
    points = shared_points(rig, 2.0, 60)
    uv_left, uv_right = built.project(points)
    read_mm = 1e3 * (triangulate(rig, uv_left, uv_right)[:, 2] - 2.0)
    judged = found.answer.judged
    assert judged.common_mm == pytest.approx(float(read_mm.mean()), rel=1e-9, abs=1e-9)
    assert judged.rms_mm == pytest.approx(float(np.sqrt((read_mm**2).mean())), rel=1e-9)
    rows = uv_right[:, 1] - uv_left[:, 1]
    assert judged.row_px == pytest.approx(float(np.sqrt((rows**2).mean())), rel=1e-9, abs=1e-9)
    assert found.answer.rig == built


def test_small_deviations_follow_the_first_order_with_their_sign() -> None:
    rig = rigsim.preset("boards").rig
    points = shared_points(rig, 2.0, 60)
    slopes = rigsim.depth_sensitivity(rig, points)
    rows = rigsim.row_sensitivity(rig, points)
    for one in DEVIATIONS:
        small = 1e-3 if one.key.endswith("deg") else 1e-2
        found = logic.find(BASE.with_words(**{one.word: f"{small}"}))
        assert found.answer is not None
        name, per_unit = MAY_BE_OFF[one.key]
        judged = found.answer.judged
        if name in slopes:
            expected = 1e3 * float(slopes[name].mean()) * small * per_unit
            assert judged.common_mm == pytest.approx(expected, rel=5e-3, abs=1e-4), one.word
        rms = float(np.sqrt((rows[name] ** 2).mean())) * small * per_unit
        assert judged.row_px == pytest.approx(rms, rel=5e-3, abs=1e-6), one.word


def test_a_principal_point_too_low_moves_rows_and_no_depth() -> None:
    found = logic.find(BASE.with_words(off_cy="2px"))
    assert found.answer is not None
    assert found.answer.judged.row_largest_px == pytest.approx(2.0)
    assert abs(found.answer.judged.common_mm) < 0.1
    assert found.answer.rig.right.cy == rigsim.preset("boards").rig.right.cy + 2


def test_as_drawn_only_noise_is_left() -> None:
    found = logic.find(logic.as_drawn(BASE.with_words(off_yaw="0.1deg")))
    assert found.answer is not None
    assert found.answer.judged.rms_mm < 1e-9
    assert found.answer.judged.whole_mm == pytest.approx(found.answer.judged.noise_mm)
    assert found.verdict == ("agrees", "meets 20 mm at 2 m")
    assert logic.alone(found) == []


def test_a_rig_that_is_off_by_much_misses_and_each_part_is_said_alone() -> None:
    found = logic.find(BASE.with_words(off_yaw="0.1deg", off_baseline="1mm"))
    assert found.answer is not None
    assert found.verdict[0] == "flagged"
    parts = {fact.key: float(fact.value) for fact in logic.alone(found)}
    assert set(parts) == {"yaw_deg", "baseline_mm"}
    # further to the right it looks: points seem nearer; too long a baseline as well
    assert parts["yaw_deg"] < 0
    assert parts["baseline_mm"] < 0
    assert sum(parts.values()) == pytest.approx(found.answer.judged.common_mm, rel=0.05)


def test_a_camera_turned_away_loses_its_points_and_misses() -> None:
    found = logic.find(BASE.with_words(off_yaw="120deg"))
    assert found.answer is not None
    assert math.isinf(found.answer.judged.rms_mm)
    assert found.verdict[0] == "flagged"
    json.dumps(error_map(found.answer.map.u_px, found.answer.map.v_px, found.answer.map.error_mm, "e", "mm"))


def test_rows_are_held_where_they_are_asked_for() -> None:
    state = BASE.with_words(off_cy="1px")
    held = logic.find(state.with_words(max_row_error="0.5px"))
    assert held.verdict == ("flagged", "misses 20 mm at 2 m, rows within 0.5 px")
    assert logic.find(state.with_words(max_row_error="1.5px")).verdict[0] == "agrees"


def test_the_map_shows_where_the_error_is() -> None:
    found = logic.find(BASE.with_words(off_roll="0.5deg"))
    assert found.answer is not None
    where = found.answer.map
    top, bottom = where.error_mm[0], where.error_mm[-1]
    both = np.isfinite(top) & np.isfinite(bottom)
    # a roll moves columns in proportion to their height in the image
    assert (top[both] * bottom[both] < 0).all()
    assert np.isnan(where.error_mm[:, 0]).all()  # the right camera does not see the left edge
    chart = error_map(where.u_px, where.v_px, where.error_mm, "depth error", "mm")
    json.dumps(chart, allow_nan=False)
    assert len(chart["series"][0]["data"]) == int(np.isfinite(where.error_mm).sum())
    assert chart["visualMap"]["max"] == -chart["visualMap"]["min"] >= np.nanmax(np.abs(where.error_mm))


@pytest.mark.parametrize(
    ("value", "rounded"), [(0.3, 0.5), (5.0, 5.0), (12, 20), (99, 100), (0, 1), (math.inf, 1)]
)
def test_scales_end_at_round_numbers(value: float, rounded: float) -> None:
    assert round_up(value) == rounded


def test_ranking_and_yields_are_those_of_the_command(tmp_path: Path) -> None:
    state = BASE.with_words(**{"class": "calibrated"})
    made = ranking.rank(ranking.asked(state), whole=False)
    line = logic.command_line(state)
    told = run(*line.split()[1:], "--no-recalibrate", "--json", cwd=tmp_path)
    assert told.returncode == 0, told.stderr
    document = json.loads(told.stdout)
    assert made.as_built == document["yield"]["as_built"]
    rows = list(csv.DictReader(io.StringIO(made.csv.decode())))
    assert [row["quantity"] for row in rows] == [one["quantity"] for one in document["quantities"]]
    for shown, one in zip(made.quantities, document["quantities"], strict=True):
        assert shown.common_mm == pytest.approx(one["common_mm"])
    assert made.at_m == document["required"]["distance_mm"] / 1e3
    assert math.isnan(made.recalibrated)
    assert not made.whole


def test_a_ranking_does_not_depend_on_the_sliders() -> None:
    assert ranking.asked(BASE) == ranking.asked(BASE.with_words(off_yaw="1deg", left="1,2", sort="error"))
    assert ranking.asked(BASE) != ranking.asked(BASE.with_words(noise="0.5px"))


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ({"off_yaw": "2mm"}, "unknown unit"),
        ({"range": "1:2"}, "m or mm?"),
        ({"depth_error": "20@2m"}, "of what unit?"),
        ({"max_row_error": "0px"}, "must be > 0"),
        ({"range": "1:2m", "depth_error": "5mm@0.01m"}, "no point there is in both images"),
        ({"preset": "", "baseline": "10cm", "focal": "900"}, "needs"),
        ({"off_baseline": "-10m"}, "must be > -120 mm"),
    ],
)
def test_bad_words_are_said_in_one_line(words: dict[str, str], says: str) -> None:
    found = logic.find(BASE.with_words(**words))
    assert says in found.fault
    assert "\n" not in found.fault
    assert found.answer is None


def test_a_class_that_is_none_is_said() -> None:
    made = ranking.rank({**BASE.words, "class": "carved"}, whole=False)
    assert "choose one of" in made.fault


def test_several_errors_are_held_to_the_first_which_is_remarked() -> None:
    found = logic.find(BASE.with_words(depth_error="20mm@2m,1%@1m"))
    assert found.required is not None
    assert (found.required.error_m, found.required.depth_m) == (0.02, 2.0)
    assert [remark.code for remark in found.remarks] == ["one_error"]


def test_an_address_keeps_what_the_rig_is_off_by() -> None:
    state = BASE.with_words(**{one.word: f"-0.5{logic.UNIT_OF[one.word]}" for one in DEVIATIONS})
    query = dict(pair.split("=") for pair in state.query().split("&"))
    assert read_state(query) == (state, [])
    assert logic.begin(state) == state


def test_it_begins_with_what_an_address_lacks() -> None:
    assert logic.begin(State({})) == logic.DEFAULTS
    own = logic.begin(State({"baseline": "20cm", "focal": "900", "resolution": "1280x720"}))
    assert not own["preset"]
    assert own["off_yaw"]
    asked = logic.begin(State({"preset": "bin", "depth_error": "1%"}))
    assert not asked["range"]


def test_signed_sliders_have_zero_in_the_middle_and_are_fine_there() -> None:
    span = SignedSpan(-0.6, 0.6, log=False, unit="deg")
    assert span.value(200) == 0
    assert span.value(0) == -0.6
    assert span.value(400) == 0.6
    assert 0 < span.value(201) < 1e-4
    for step in range(0, 401, 7):
        assert span.step(span.value(step)) == step
    assert span.step(5) == 400


def test_bars_have_units_and_the_worst_on_top() -> None:
    chart = ranked_bars(["yaw", "roll"], [-15.2, 1.0], [2.0, 3.0], "2 m")
    assert chart["xAxis"]["name"] == "depth error at 2 m, mm"
    assert chart["yAxis"]["data"] == ["yaw", "roll"]
    assert chart["yAxis"]["inverse"]
    assert chart["series"][0]["data"] == [15.2, 1.0]


def test_the_marked_row_is_lower_in_the_right_picture_by_what_the_rows_are_apart() -> None:
    found = logic.find(BASE.with_words(off_cy="7.2px"))
    assert rows.row_apart_px(found, 0.5) == pytest.approx(7.2)
    assert rows.guide(found, 0.5, (320, 180), right=False).count("<line") == 1
    # 7.2 of 720 rows are 1.8 of 180
    assert 'y1="91.80"' in rows.guide(found, 0.5, (320, 180), right=True)
    assert "7.20 px lower in the right picture" in rows.guide_words(found, 0.5)
    assert "on the same row" in rows.guide_words(logic.find(BASE), 0.5)


def test_the_pair_is_taken_by_the_built_rig_and_read_by_the_assumed_one() -> None:
    found = logic.find(BASE.with_words(off_pitch="0.2deg"))
    request = rows.pair_wanted(found, "boards", coarse=False)
    assert request is not None
    assert found.answer is not None
    assert request.rig == rigsim.preset("boards").rig
    assert request.built == found.answer.rig != request.rig
    assert request.size == (640, 360)
    assert rows.pair_wanted(logic.find(BASE.with_words(off_pitch="2mm")), "boards", coarse=True) is None
