"""The Design page's answers: they are the formulas', and the command line's."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

import rigsim
from rigsim.present.live.region import region_chart
from rigsim.studio.logic.design import advice, feasible, trade_offs
from rigsim.studio.state import State, read_state
from rigsim.study.tolerance.inputs import QUANTITIES
from tests.helpers.cli import rigsim as run

SMALL = State(
    {
        "range": "1:3m",
        "depth_error": "60mm@3m",
        "build_share": "90%",
        "try_resolution": "1280x960",
        "lens": "60,70deg",
        "prefer": "smallest",
    }
)
"""Few cameras, so that counting built rigs is quick."""


def test_the_example_has_the_region_of_the_closed_forms() -> None:
    found = feasible.find(feasible.DEFAULTS)
    shown = found.region
    assert found.design is not None
    assert shown is not None
    assert not found.fault
    sigma_d = math.sqrt(2) * 0.25
    there = np.isfinite(shown.shortest_m)
    # Z^2 sigma / (f B) <= e, and half of the image's width seen by both at the near end
    np.testing.assert_allclose(
        shown.shortest_m[there], 9 * sigma_d / (shown.focal_px[there] * 0.010), rtol=1e-4
    )
    np.testing.assert_allclose(
        shown.longest_m[there], 0.5 * shown.camera.width_px * 0.5 / shown.focal_px[there]
    )
    widest = shown.camera.width_px / 2 / math.tan(math.radians(30))
    assert shown.focal_px[there].max() == pytest.approx(widest)
    assert not there[shown.focal_px > widest * 1.0001].any()
    assert found.counted == "25 of 48 cameras qualify."


def test_limits_keep_their_names_and_values() -> None:
    found = feasible.find(feasible.DEFAULTS.with_words(max_baseline="300", max_disparity="900px"))
    assert found.region is not None
    lines = {line.requirement.kind: line for line in found.region.lines}
    assert set(lines) == {"depth_error", "fov", "overlap", "max_baseline", "max_disparity"}
    assert lines["max_baseline"].baseline_m == pytest.approx(0.3)
    np.testing.assert_allclose(lines["max_disparity"].baseline_m * lines["max_disparity"].focal_px / 0.5, 900)


def test_the_pick_and_its_files_are_those_of_the_command(few_built_rigs: None, tmp_path: Path) -> None:
    made = advice.advise(advice.asked(SMALL))
    line = feasible.command_line(SMALL)
    assert line.startswith("rigsim design --range=1:3m --depth-error=60mm@3m ")
    assert "--resolution=1280x960" in line
    assert "--lens=60,70deg" in line
    assert "try" not in line
    told = run(*line.split()[1:], "--json", cwd=tmp_path)
    assert told.returncode == 0, told.stderr
    assert made.pick is not None
    assert made.files is not None
    document = json.loads(made.files["design.json"])
    assert document == json.loads(told.stdout)
    assert document["recommended"]["baseline_mm"] == pytest.approx(made.pick.baseline_m * 1e3)
    assert rigsim.read_rig(made.files["rig.toml"].decode()).baseline_m == made.pick.baseline_m
    assert made.files["design.csv"].decode().count("\n") == len(made.pareto) + 1
    limit = document["recommended"]["limited_by"]
    assert made.building[0].endswith(
        f"limited most by {'pixel noise' if limit == 'noise' else QUANTITIES[limit]}."
    )
    first = advice.first_pick(advice.asked(SMALL))
    assert not first.whole
    assert first.headline == made.headline


def test_several_errors_are_several_options() -> None:
    state = State({"range": "1:3m", "depth_error": "20mm@3m, 1%@1m"})
    assert "--depth-error=20mm@3m --depth-error=1%@1m" in feasible.command_line(state)
    found = feasible.find(state)
    assert found.specification is not None
    errors = [one for one in found.specification.requirements if one.kind == "depth_error"]
    assert [(one.depth_m, round(one.limit, 9)) for one in errors] == [(3.0, 0.02), (1.0, 0.01)]


def test_where_nothing_is_feasible_it_says_what_to_relax_and_that_does() -> None:
    found = feasible.find(feasible.DEFAULTS.with_words(depth_error="1mm@3m"))
    assert found.design is None
    assert found.region is not None
    assert "No rig meets all requirements" in found.fault
    assert "≤ 1 mm" in found.fault
    assert next(way.text for way in found.ways).startswith("depth error at 3 m from 1 mm to 5.2 mm")
    for way in found.ways:
        assert way.state is not None
        assert feasible.find(way.state).design is not None, way.text


@pytest.mark.parametrize(
    ("word", "text", "kind"),
    [
        ("max_baseline", "40", "baseline limit"),
        ("max_disparity", "100px", "disparity search"),
        ("fov", "80deg", "field of view"),
        ("max_pixels", "0.1MP", "image size"),
    ],
)
def test_each_limit_can_be_relaxed_by_a_press(word: str, text: str, kind: str) -> None:
    state = feasible.DEFAULTS.with_words(**{word: text, "try_resolution": "2448x2048", "lens": "60deg"})
    ways = [way for way in feasible.find(state).ways if way.text.startswith(kind)]
    assert ways
    assert ways[0].state is not None
    assert ways[0].state[word] != text
    assert feasible.find(ways[0].state).design is not None


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ({"range": "0.5:3"}, "m or mm?"),
        ({"range": ""}, "Range: is needed"),
        ({"depth_error": ""}, "Depth error: is needed"),
        ({"depth_error": "10@3m"}, "mm or %?"),
        ({"lens": "4"}, "mm, px or deg?"),
        ({"prefer": "best"}, "choose one of buildable"),
        ({"class": "carved"}, "choose one of printed"),
        ({"fov": "0deg"}, "must be > 0"),
    ],
)
def test_bad_words_are_said_in_one_line(words: dict[str, str], says: str) -> None:
    found = feasible.find(feasible.DEFAULTS.with_words(**words))
    assert says in found.fault
    assert "\n" not in found.fault
    assert found.design is None
    assert found.region is None


def test_a_picked_rig_is_that_rig_and_forgets_the_one_before() -> None:
    before = SMALL.with_words(preset="boards", hfov="70deg", pixel_pitch="3um", noise="0.3px")
    shown = feasible.picked(before, 1108.5125, 271.0, (1280, 960))
    assert (shown["focal"], shown["baseline"], shown["resolution"]) == ("1108.51px", "271mm", "1280x960")
    assert not any(shown[name] for name in ("preset", "hfov", "pixel_pitch"))
    assert shown["noise"] == "0.3px"
    assert shown["range"] == "1:3m"
    from rigsim.studio.logic.rig import shown_rig

    rig = shown_rig(shown).rig
    assert (rig.left.width, rig.left.fx, round(rig.baseline_m, 9)) == (1280, 1108.51, 0.271)


def test_a_click_outside_says_which_requirement_fails() -> None:
    found = feasible.find(feasible.DEFAULTS)
    assert found.region is not None
    focal_px = float(found.region.focal_px[np.isfinite(found.region.shortest_m)][0])
    low, high = found.region.shortest_m[0] * 1e3, found.region.longest_m[0] * 1e3
    assert feasible.broken(found, focal_px, (low * high) ** 0.5) == []
    assert feasible.broken(found, focal_px, low / 2) == ["depth error at 3 m ≤ 10 mm"]
    assert feasible.broken(found, focal_px, high * 2) == ["overlap at 0.5 m ≥ 50 %"]


def test_the_table_sorts_both_ways_and_back() -> None:
    found = feasible.find(SMALL).design
    assert found is not None
    assert len(found.pareto) > 2
    rows = {
        sort: trade_offs.rows(SMALL.with_words(sort=sort), found.pareto) for sort in ("", "error", "-error")
    }
    errors = [float(row.cells[4]) for row in rows["error"]]
    assert errors == sorted(errors)
    assert [float(row.cells[4]) for row in rows["-error"]] == errors[::-1]
    assert [row.cells for row in rows[""]] != [row.cells for row in rows["error"]]
    assert [trade_offs.next_sort(now, "error") for now in ("", "error", "-error", "hfov")] == [
        "error",
        "-error",
        "",
        "error",
    ]
    assert trade_offs.direction("-error", "error") == "descending"
    state, _ = read_state(dict(pair.split("=") for pair in rows[""][0].address.split("?")[1].split("&")))
    assert state["baseline"] == f"{found.pareto[0].baseline_m * 1e3:.6g}mm"


def test_an_address_keeps_every_word_of_the_page() -> None:
    state = State(dict.fromkeys((*feasible.OPTIONS, "region", "sort"), "1"))
    query = dict(pair.split("=") for pair in state.query().split("&"))
    assert read_state(query) == (state, [])


def test_words_of_cameras_without_a_rig_are_those_to_try() -> None:
    begun = feasible.begin(State({"range": "1:3m", "depth_error": "1%", "resolution": "1280x720,1920x1080"}))
    assert begun["try_resolution"] == "1280x720,1920x1080"
    assert not begun["resolution"]
    with_rig = feasible.begin(State({"baseline": "10cm", "resolution": "1280x720"}))
    assert with_rig["resolution"] == "1280x720"
    assert not with_rig["try_resolution"]
    assert with_rig["range"] == feasible.DEFAULTS["range"]


def test_the_chart_has_units_and_finite_numbers() -> None:
    found = feasible.find(feasible.DEFAULTS.with_words(max_baseline="300"))
    assert found.region is not None
    chart = region_chart(found.region, [(2120.0, 242.0)], (2120.0, 242.0))
    json.dumps(chart, allow_nan=False)
    assert chart["xAxis"]["name"] == "focal length, px"
    assert chart["yAxis"]["name"] == "baseline, mm"
    names = {series["name"] for series in chart["series"]}
    assert "baseline limit ≤ 300 mm" in names
    assert "recommended" in names
    area = np.array(chart["series"][0]["data"][0]).reshape(4, -1)
    assert (area[2] <= area[3][::-1]).all()
    assert area[3].max() <= 300.001
