"""The state of a page: in an address and back, a step back and forward, and a rig's file as a word."""

from __future__ import annotations

from urllib.parse import parse_qsl, urlsplit

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim import read_rig, write_rig
from rigsim.rig.presets import PRESETS
from rigsim.studio.logic.rig import shown_rig, taken_in
from rigsim.studio.state import VERSION, History, State, pack, read_state, unpack
from rigsim.studio.words import ALL

_TYPED = st.text(st.characters(categories=("L", "N", "P", "S"), max_codepoint=0x2FF), min_size=1, max_size=60)
_STATES = st.dictionaries(st.sampled_from([word.name for word in ALL]), _TYPED).map(State)


def _query(address: str) -> dict[str, str]:
    return dict(parse_qsl(urlsplit(address).query, strict_parsing=True))


@given(_STATES)
def test_an_address_gives_the_same_state_again(state: State) -> None:
    assert read_state(_query(state.address("point"))) == (state, [])


def test_the_words_are_named_like_the_options() -> None:
    state = State({"focal": "1200", "baseline": "150mm", "left": "980,500", "right": "910,500"})
    assert state.address("point") == "/point?focal=1200&baseline=150mm&left=980,500&right=910,500&v=1"


def test_what_an_address_should_not_hold_is_left_out_with_a_remark() -> None:
    state, remarks = read_state({"focal": "9" * 300, "baseline": "1\n2", "unknown": "x", "noise": " 0.1 "})
    assert state == State({"noise": "0.1"})
    assert [remark.split()[0] for remark in remarks] == ["focal", "baseline"]
    state, remarks = read_state({"focal": "900", "v": "7"})
    assert state == State({"focal": "900"})
    assert "version 7" in remarks[0]
    assert VERSION in remarks[0]


def test_a_control_that_is_dragged_makes_one_step() -> None:
    history = History(State({"baseline": "100"}))
    for mm in (101, 105, 120):
        history.change(history.state.with_words(baseline=str(mm)), "baseline")
    history.change(history.state.with_words(noise="1"), "noise")
    history.undo()
    assert history.state == State({"baseline": "120"})
    history.undo()
    assert history.state == State({"baseline": "100"})
    assert not history.can_undo
    history.redo()
    history.redo()
    assert history.state == State({"baseline": "120", "noise": "1"})
    assert not history.can_redo


def test_a_control_that_rested_makes_a_new_step_and_a_new_step_has_no_future() -> None:
    history = History(State({"baseline": "100"}))
    history.change(State({"baseline": "120"}), "baseline")
    history.rest()
    history.change(State({"baseline": "140"}), "baseline")
    history.undo()
    assert history.state["baseline"] == "120"
    history.change(State({"baseline": "90"}), "baseline")
    assert not history.can_redo


@pytest.mark.parametrize("name", PRESETS)
def test_a_file_s_rig_travels_in_the_address(name: str) -> None:
    rig = read_rig(name)
    state = State({"rig": taken_in("rig.toml", write_rig(rig).encode())})
    back, remarks = read_state(_query(state.address("rig")))
    assert not remarks
    assert shown_rig(back).rig == rig


@given(st.text())
def test_any_text_packs_and_unpacks(text: str) -> None:
    assert unpack(pack(text)) == text


@pytest.mark.parametrize("word", ["", "abc", "not base64!", "eJw", pack("x" * 300_000)])
def test_what_is_no_text_or_too_long_a_one_unpacks_to_nothing(word: str) -> None:
    assert unpack(word) == ""
