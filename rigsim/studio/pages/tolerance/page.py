"""The page's layout."""

from __future__ import annotations

from nicegui import ui

from rigsim.rig.quantity import NOISE
from rigsim.studio.kit.clipboard import copy
from rigsim.studio.kit.controls import SignedSpan, action, choice, quantity_slider, text_box
from rigsim.studio.kit.latest import Latest
from rigsim.studio.kit.session import Session
from rigsim.studio.kit.shell import frame
from rigsim.studio.logic.tolerance import built
from rigsim.studio.pages.tolerance.one_rig import OneRig
from rigsim.studio.pages.tolerance.pair import RowsPair
from rigsim.studio.pages.tolerance.ranked import Ranked
from rigsim.studio.state import State
from rigsim.study.tolerance.inputs import QUANTITIES

_LATER_S = 1.0
"""The first pair is a coarse one; a better one follows."""
_CLASSES = {"": "machined", "printed": "printed", "calibrated": "calibrated"}


def begin(state: State) -> State:
    """What the page shows for an address."""
    return built.begin(state)


def build(session: Session) -> None:
    """The page."""
    found = Latest(session, built.find)
    one, pair, ranked = OneRig(found), RowsPair(session, found), Ranked(session)
    with frame(session):
        ui.html("<h1>A rig that was built a little off</h1>", sanitize=False)
        ui.label(
            "Turn and shift the right camera; see what the rig that you assume reads, and where."
        ).classes("rig-lead")
        with ui.element("div").classes("rig-columns rig-three"):
            with ui.element("div").classes("rig-stack rig-first"):
                _sliders(session)
            with ui.element("div").classes("rig-stack rig-last"):
                _asked(session)
            with ui.element("div").classes("rig-stack rig-second"):
                one.place()
                pair.place()
                ranked.place()
                _command(session)
    session.watch(one.follow)
    session.watch(pair.moved)
    session.watch(ranked.follow)
    session.when_resting(pair.rested)
    session.when_resting(ranked.rested)
    ranked.rested()
    ui.timer(_LATER_S, pair.rested, once=True)


def _sliders(session: Session) -> None:
    with ui.element("section").classes("rig-panel w-full").props('aria-label="Built rig"'):
        ui.html("<h2>The built rig is off by</h2>", sanitize=False)
        for one in built.DEVIATIONS:
            span = SignedSpan(-one.reach, one.reach, log=False, unit=built.UNIT_OF[one.word])
            name = QUANTITIES[one.key]
            label = f"{name[:1].upper()}{name[1:]}, {span.unit}"
            quantity_slider(session, one.word, label, one.kind, span, 0.0, placeholder=f"0 {span.unit}")
        with ui.element("div").classes("rig-buttons").style("margin-top:10px"):
            action("As drawn", lambda: session.show(built.as_drawn(session.state)), icon="restart_alt")


def _asked(session: Session) -> None:
    with ui.element("section").classes("rig-panel w-full").props('aria-label="What it is held to"'):
        ui.html("<h2>What it is held to</h2>", sanitize=False)
        with ui.element("div").classes("rig-fields"):
            for word, label, example in (
                ("range", "Working range, near:far", "1:5m"),
                ("depth_error", "Depth error, at most", "1%, at the far end"),
            ):
                text_box(session, word, label, placeholder=example).classes("rig-wide").props(
                    "hide-bottom-space"
                )
            text_box(session, "max_row_error", "Rows apart ≤", placeholder="any, px").props(
                "hide-bottom-space"
            )
            text_box(session, "noise", "Noise", kind=NOISE, placeholder="0.25 px").props("hide-bottom-space")
            choice(session, "class", "Who builds it", _CLASSES).classes("rig-wide")
    with ui.element("section").classes("rig-panel w-full").props('aria-label="Rig as drawn"'):
        ui.html("<h2>The rig as drawn</h2>", sanitize=False)
        with ui.element("div").classes("rig-fields"):
            for word, label, example in (
                ("baseline", "Baseline", "of the preset"),
                ("focal", "Focal length", "of the preset"),
                ("resolution", "Image size", "of the preset"),
                ("preset", "Preset", "none"),
            ):
                text_box(session, word, label, placeholder=example).props("hide-bottom-space")


def _command(session: Session) -> None:
    with ui.element("section").classes("rig-panel w-full").props('aria-label="Command"'):
        ui.html("<h2>Ranking and yields on the command line</h2>", sanitize=False)
        with ui.element("div").classes("rig-buttons"):
            line = ui.label().classes("rig-command").style("flex:1 1 20em").props("data-testid=command")
            action("Copy command", lambda: copy(built.command_line(session.state), "Command"))

    def follow() -> None:
        line.set_text(built.command_line(session.state))

    session.watch(follow)
