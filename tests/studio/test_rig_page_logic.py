"""The rig's page without a browser: the numbers of the command line, and words that go and come."""

from __future__ import annotations

import json
import math
import random
import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rigsim.errors import RigsimError
from rigsim.interop.formats.rig_toml import write_rig
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.presets import PRESETS
from rigsim.rig.stereo import StereoRig
from rigsim.studio.logic import command, lenses, scenes
from rigsim.studio.logic.curves import curves_of
from rigsim.studio.logic.numbers import PLACES, RigNumbers, numbers_of
from rigsim.studio.pages.rig.page import DEFAULTS, begin
from rigsim.studio.state import State
from tests.helpers.cli import rigsim


def random_state(seed: int) -> State:
    """What somebody may have dragged and typed."""
    dice = random.Random(seed)
    words = {"range": f"{dice.choice((0.3, 0.5, 1.2))}:{dice.choice((3, 7.5, 20))}m"}
    if dice.random() < 0.6:
        words["preset"] = dice.choice(list(PRESETS))
    else:
        words |= {"baseline": "9cm", "hfov": "70", "resolution": "1280x720"}
    if dice.random() < 0.6:
        words["baseline"] = f"{dice.uniform(20, 500):.3g}mm"
    if dice.random() < 0.4:
        words["resolution"] = dice.choice(lenses.SIZES)
    if dice.random() < 0.4:
        words.pop("hfov", None)
        words["focal"] = f"{dice.uniform(300, 2500):.3g}px"
    if dice.random() < 0.3:
        words["vergence"] = f"{dice.uniform(-5, 12):.3g}deg"
    if dice.random() < 0.5:
        words["noise"] = f"{dice.uniform(0.05, 1):.2g}px"
    if dice.random() < 0.7:
        words["require"] = f"{dice.uniform(1, 60):.3g}mm@{dice.choice((1, 2, 3))}m"
    if dice.random() < 0.4:
        words["z"] = f"{dice.uniform(0.4, 6):.3g}m"
    return State(words)


def printed(line: str, folder: Path) -> dict[str, Any]:
    done = rigsim(*shlex.split(line)[1:], "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    return dict(json.loads(done.stdout))


def same(told: object, said: object) -> bool:
    """Whether a document says a number of the page: null in place of none, and of one without bound."""
    if said is None:
        return isinstance(told, float) and not math.isfinite(told)
    return told == said if isinstance(told, str) else float(f"{told:.15g}") == said


@pytest.mark.parametrize("seed", range(30))
def test_the_page_says_what_the_command_line_prints(seed: int, tmp_path: Path) -> None:
    found = numbers_of(random_state(seed))
    assert not found.fault
    assert found.distances is not None
    depth, limits = command.of_rig(found.state, found.distances.words)
    document = printed(limits, tmp_path)
    for key, fact in found.of_rig.items():
        assert same(fact.value, document[key]), key
    at_mm = [float(found.places[place]["z"].value) for place in PLACES]
    for place, z_mm in zip(PLACES, at_mm, strict=True):
        facts = found.places[place]
        row = next(row for row in document["at"] if row["z"] == z_mm)
        for key in ("overlap_share", "overlap_width", "overlap_height", "dead_band_px", "depth_step"):
            assert same(facts[key].value, row[key]), (place, key)
        alone = printed(command.of_depth(found.state.with_words(z=f"{z_mm!r}mm")), tmp_path)
        for key in ("z", "depth_std", "depth_near", "depth_far", "depth_bias", "world_per_pixel", "seen_by"):
            assert same(facts[key].value, alone[key]), (place, key)
    assert rigsim(*shlex.split(depth)[1:], cwd=tmp_path).returncode == 0


def found_for(**words: str) -> RigNumbers:
    return numbers_of(DEFAULTS.with_words(**words))


def test_a_requirement_is_met_or_not_by_the_predicted_error() -> None:
    # 2 m^2 / (900 px 0.12 m) 0.25 sqrt 2 px = 13.09 mm
    verdicts = [found_for(require=f"{limit}mm@2m").kept for limit in (13.2, 13.0)]
    assert [kept.verdict for kept in verdicts if kept is not None] == ["met", "not_met"]


def test_a_requirement_of_95_of_100_errors_is_harder_by_1_96() -> None:
    plain, hard = (found_for(require=text).kept for text in ("20mm@2m", "p95:20mm@2m"))
    assert plain is not None
    assert hard is not None
    assert hard.error_mm == pytest.approx(1.96 * plain.error_mm, rel=1e-3)
    assert (plain.verdict, hard.verdict) == ("met", "not_met")


def test_a_requirement_without_distance_is_of_the_far_end() -> None:
    found = found_for(require="1%")
    assert found.kept is not None
    assert (found.kept.at_mm, found.kept.limit_mm) == (5000.0, 50.0)
    assert found.places["at"]["z"].value == 5000.0


def test_what_no_camera_sees_is_neither_met_nor_missed() -> None:
    found = found_for(vergence="-60deg", require="20mm@2m")
    assert found.kept is not None
    assert found.kept.verdict == "not_seen"
    assert any(
        "nothing in common" in remark.text or "no common point" in remark.text for remark in found.remarks
    )


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ({"range": "5"}, "m or mm"),
        ({"range": "5:1m"}, "swap"),
        ({"require": "20"}, "mm or %"),
        ({"baseline": "0"}, "must be > 0"),
        ({"baseline": "1,2,3"}, "3 rigs"),
        ({"rig": "eJwrSS0uAQAEXQHB"}, ""),
        ({"rig": "nothing"}, "load its file again"),
    ],
)
def test_what_cannot_be_read_is_one_line(words: dict[str, str], says: str) -> None:
    found = found_for(**words)
    assert says in found.fault
    assert found.fault
    assert "\n" not in found.fault
    assert not found.places
    assert curves_of(found).depth is None or found.shown is not None


def test_curves_go_through_the_numbers() -> None:
    found = found_for(z="5m")
    curve = curves_of(found)
    assert curve.depth is not None
    assert curve.overlap is not None
    for index, place in ((0, "near"), (-1, "far")):
        facts = found.places[place]
        assert curve.depth.std_mm[index] == pytest.approx(float(facts["depth_std"].value))
        z_mm = float(facts["z"].value)
        assert curve.depth.too_near_mm[index] == pytest.approx(z_mm - float(facts["depth_near"].value))
        assert curve.depth.too_far_mm[index] == pytest.approx(float(facts["depth_far"].value) - z_mm)
        assert curve.overlap.share[index] == pytest.approx(float(facts["overlap_share"].value))
    assert curve.required == (2.0, 20.0)


def test_curves_stop_where_a_camera_does_not_see() -> None:
    depth = curves_of(found_for(vergence="40deg")).depth
    assert depth is not None
    assert np.isnan(depth.std_mm).any()
    assert np.isfinite(depth.std_mm).any()


def test_a_preset_takes_the_place_of_what_shaped_the_rig_and_of_nothing_else() -> None:
    typed = DEFAULTS.with_words(baseline="80mm", hfov="60", vergence="2deg", noise="0.5", z="3m")
    changed = lenses.with_preset(typed, "oak-d", None)
    assert dict(changed.words) == {
        "preset": "oak-d",
        "noise": "0.5",
        "z": "3m",
        "range": "0.5:5m",
        "require": "20mm@2m",
    }


def test_ones_own_rig_begins_as_the_one_that_was_shown() -> None:
    before = numbers_of(lenses.with_preset(DEFAULTS, "zed-2i", None))
    own = lenses.with_preset(before.state, lenses.OWN, before.shown)
    assert not own["preset"]
    after = numbers_of(own)
    assert after.shown is not None
    assert before.shown is not None
    assert after.shown.rig.baseline_m == pytest.approx(before.shown.rig.baseline_m, rel=1e-4)
    assert after.shown.rig.left.fx == pytest.approx(before.shown.rig.left.fx, rel=1e-3)
    assert lenses.with_preset(own, lenses.OWN, after.shown) == own


def test_a_file_is_taken_in_and_a_broken_one_is_one_line() -> None:
    text = write_rig(PRESETS["bin"].rig, "mine")
    taken = lenses.with_file(DEFAULTS.with_words(baseline="1m"), "mine.toml", text.encode())
    assert lenses.is_from_file(taken)
    assert not taken["preset"] + taken["baseline"]
    found = numbers_of(taken)
    assert found.shown is not None
    assert found.shown.rig == PRESETS["bin"].rig
    for content in (b"\xff\xfe\x00broken", b"[left]\nwidth = 'x'", b""):
        with pytest.raises(RigsimError) as caught:
            lenses.with_file(DEFAULTS, "broken.toml", content)
        assert "\n" not in str(caught.value)


def test_a_path_is_taken_from_the_command_line_only() -> None:
    state = DEFAULTS.with_words(scene="/etc/passwd")
    assert scenes.chosen(state, "") == "boards"
    assert scenes.chosen(state, "/home/me/hall.xml") == "/home/me/hall.xml"
    assert scenes.choices("/home/me/hall.xml")["/home/me/hall.xml"] == "hall.xml"
    assert scenes.chosen(DEFAULTS.with_words(scene="bin"), "/home/me/hall.xml") == "bin"
    assert scenes.chosen(State({"preset": "corridor"}), "") == "corridor"


def test_the_page_begins_with_a_rig_and_keeps_what_an_address_says() -> None:
    assert begin(State({})) == DEFAULTS
    assert begin(State({"scene": "bin"})) == DEFAULTS.with_words(scene="bin", preset="bin")
    held = State({"preset": "oak-d", "range": "1:3m"})
    assert begin(held) == held
    from_point = begin(State({"focal": "1200", "baseline": "150mm", "left": "980,500", "right": "910,500"}))
    assert not numbers_of(from_point).fault
    assert numbers_of(from_point).shown is not None


def test_curves_of_lenses_that_distort_wait_for_the_hand_to_rest() -> None:
    bent = replace(PRESETS["boards"].rig.left, lens=BrownConrady(k1=-0.2, k2=0.05))
    rig = StereoRig.rectified(bent, 0.12)
    found = numbers_of(lenses.with_file(DEFAULTS, "bent.toml", write_rig(rig, "bent").encode()))
    moving, resting = curves_of(found, resting=False), curves_of(found)
    assert moving.overlap is None
    assert moving.depth is not None
    assert resting.depth is not None
    assert resting.overlap is not None
    np.testing.assert_array_equal(moving.depth.std_mm, resting.depth.std_mm)
    assert np.isfinite(resting.depth.too_far_mm).all()
    assert resting.overlap.share[-1] == pytest.approx(float(found.places["far"]["overlap_share"].value))
