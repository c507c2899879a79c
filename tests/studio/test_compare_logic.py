"""Rigs side by side: what is pinned, what differs, which is better."""

from __future__ import annotations

import json
from pathlib import Path
from urllib.parse import parse_qsl, urlsplit

import pytest

from rigsim.errors import InvalidRange
from rigsim.studio.logic import compare
from rigsim.studio.state import State, read_state
from tests.helpers.cli import rigsim

TWO = State({"range": "1:4m", "z": "3m", "pin1": "preset=oak-d&v=1", "pin2": "preset=zed-2i&v=1"})


def test_the_table_tells_what_calc_prints(tmp_path: Path) -> None:
    rows = {row.name: row for row in compare.table(compare.pinned(TWO))}
    done = rigsim("calc", "depth", "--preset=oak-d,zed-2i", "--z=1,3,4m", "--json", cwd=tmp_path)
    printed = json.loads(done.stdout)["rows"]
    for name, z_mm in (("near end", 1000), ("at the distance", 3000), ("far end", 4000)):
        row = rows[f"depth error, {name}"]
        stds = [one["depth_std_mm"] for one in printed if one["z_mm"] == z_mm]
        assert [float(cell) for cell in row.cells] == pytest.approx(stds, rel=5e-3)
        assert row.unit == "mm"
        assert row.best == (0 if stds[0] < stds[1] else 1)
        assert row.differs
    assert rows["baseline"].cells == ("75", "120")
    says = json.loads(done.stdout)["says"]
    assert compare.sentence(compare.pinned(TWO)) == says


def test_what_is_the_same_is_not_marked_and_has_no_best() -> None:
    state = State({"range": "1:4m", "pin1": "preset=oak-d", "pin2": "preset=oak-d&noise=0.5"})
    rows = {row.name: row for row in compare.table(compare.pinned(state))}
    assert not rows["focal length"].differs
    assert rows["blind zone"].best is None
    assert rows["depth error, far end"].best == 0
    assert compare.sentence(compare.pinned(state)) == ""  # not the same noise
    # without a distance typed it is the far end, and said once
    assert "depth error, at the distance" not in rows


def test_a_pinned_rig_is_taken_with_its_noise_and_not_twice() -> None:
    shown = TWO.with_words(preset="d435", baseline="80mm", noise="0.1", left="1,1")
    state = compare.pin(shown)
    third = compare.pinned(state)[2]
    assert (third.slot, third.name) == ("pin3", "d435, baseline 80mm, noise 0.1")
    assert third.found.shown is not None
    assert third.found.shown.rig.baseline_m == pytest.approx(0.08)
    assert third.found.shown.noise.std_px == 0.1
    with pytest.raises(InvalidRange, match="compared already"):
        compare.pin(state)
    state = compare.pin_preset(state, "bin")
    with pytest.raises(InvalidRange, match="4 rigs are compared already: remove one first"):
        compare.pin_preset(state, "corridor")
    # a free place in the middle is used first
    assert compare.pin_preset(state.with_words(pin2=""), "corridor")["pin2"].startswith("preset=corridor")
    with pytest.raises(InvalidRange, match="no rig to pin"):
        compare.pin(State())


def test_pins_travel_in_the_address() -> None:
    state = compare.pin(TWO.with_words(baseline="80mm", focal="900", resolution="1280x720"))
    query = dict(parse_qsl(urlsplit(state.address("compare")).query, strict_parsing=True))
    assert read_state(query) == (state, [])


def test_a_rig_that_cannot_be_is_said_and_the_others_stay() -> None:
    state = TWO.with_words(pin3="baseline=0&focal=900&resolution=640x480")
    rigs = compare.pinned(state)
    (fault,) = compare.faults(rigs)
    assert fault == "own rig, resolution 640x480, focal 900, baseline 0: Baseline 0 mm: must be > 0"
    row = next(row for row in compare.table(rigs) if row.name == "depth error, far end")
    assert row.cells[2] == "–"
    assert row.best == 1
