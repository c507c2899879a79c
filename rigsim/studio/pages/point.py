"""Point: one point seen in both pictures; the calculator that rigsim began as."""

from __future__ import annotations

from functools import partial

from nicegui import ui

from rigsim.present.live.plan import PlanPoint, plan_svg
from rigsim.rig.quantity import NOISE, PIXEL_PITCH, SENSOR_WIDTH
from rigsim.studio.kit.clipboard import copy
from rigsim.studio.kit.controls import action, text_box
from rigsim.studio.kit.numbers import ShownNumber, facts_table, notes
from rigsim.studio.kit.session import Session
from rigsim.studio.kit.shell import frame
from rigsim.studio.logic import command, point
from rigsim.studio.state import State

_NUMBERS = (("Z, depth", "point-z", "z"), ("X", "point-x", "x"), ("Y", "point-y", "y"))
_SMALL = (
    ("disparity", "disparity", "disparity_px"),
    ("width of a pixel", "world-per-pixel", "world_per_pixel"),
    ("depth std", "depth-std", "depth_std"),
    ("nearest depth", "depth-near", "depth_near"),
    ("farthest depth", "depth-far", "depth_far"),
)


def build(session: Session) -> None:
    """The page."""
    with frame(session):
        ui.html("<h1>A point from two pictures</h1>", sanitize=False)
        ui.label("Type what your two cameras see; depth, position and their uncertainty follow.").classes(
            "rig-lead"
        )
        with ui.element("div").classes("rig-columns"):
            with ui.element("section").classes("rig-panel").props('aria-label="What is known"'):
                _controls(session)
            with ui.element("div").classes("rig-stack"):
                _answer(session)


def begin(state: State) -> State:
    """What the page shows for an address: the worked example where it says nothing of a point."""
    return state if state["left"] or state["right"] else State({**point.DEFAULTS.words, **state.words})


def _controls(session: Session) -> None:
    with ui.element("div").classes("rig-fields"):
        text_box(session, "focal", "Focal length", hint="px, or mm with a pixel pitch").classes("rig-wide")
        text_box(session, "baseline", "Baseline", hint="mm without a unit; 15cm, 0.15m").classes("rig-wide")
        for word, names in (("left", ("x1", "y1")), ("right", ("x2", "y2"))):
            _pixel(session, word, names)
        text_box(session, "noise", "Noise", kind=NOISE, placeholder="0.25 px").classes("rig-wide")
    more = ui.expansion("Image and sensor, if known").classes("w-full").props("dense")
    with more, ui.element("div").classes("rig-fields"):
        text_box(session, "resolution", "Image size", hint="as 1280x720").classes("rig-wide")
        text_box(session, "principal", "Principal point", hint="u,v in px").classes("rig-wide")
        text_box(session, "pixel_pitch", "Pixel pitch", kind=PIXEL_PITCH, hint="um")
        text_box(session, "sensor_width", "Sensor width", kind=SENSOR_WIDTH, hint="mm")
    with ui.element("div").classes("rig-buttons").style("margin-top:14px"):
        action("Reset defaults", lambda: session.show(point.DEFAULTS), icon="restart_alt")
        action("Copy results", lambda: copy(point.summary(session.state), "Results"), icon="content_copy")
    ui.html("<h2 style='margin-top:18px'>Worked examples</h2>", sanitize=False)
    with ui.element("div").classes("rig-buttons"):
        for name, state in point.EXAMPLES.items():
            action(name, partial(session.show, state))


def _pixel(session: Session, word: str, names: tuple[str, str]) -> None:
    """Two boxes that are one word."""
    boxes: list[ui.input] = []

    def typed() -> None:
        session.type(**{word: point.pair(*(box.value or "" for box in boxes))})

    for name, value in zip(names, point.halves(session.state[word]), strict=True):
        box = ui.input(label=name, value=value).props("dense outlined autocomplete=off")
        box.on_value_change(typed)
        boxes.append(box)

    def fill() -> None:
        for box, value in zip(boxes, point.halves(session.state[word]), strict=True):
            box.set_value(value)

    session.when_restored(fill)


def _answer(session: Session) -> None:
    said = ui.html("", sanitize=False).classes("w-full").props('aria-live="polite"')
    with ui.element("section").classes("rig-panel w-full").props('aria-label="Result"'):
        with ui.element("div").classes("rig-numbers"):
            numbers = [(key, ShownNumber(name, testid)) for name, testid, key in _NUMBERS]
        with ui.element("div").classes("rig-numbers").style("margin-top:14px"):
            numbers += [(key, ShownNumber(name, testid, small=True)) for name, testid, key in _SMALL]
    with ui.element("section").classes("rig-panel w-full").props('aria-label="From above"'):
        ui.html("<h2>From above</h2>", sanitize=False)
        picture = ui.html("", sanitize=False).classes("w-full")
    with ui.element("section").classes("rig-panel w-full").props('aria-label="Summary"'):
        ui.html("<h2>Summary</h2>", sanitize=False)
        table = ui.html("", sanitize=False).classes("rig-scroll")
        with ui.element("div").classes("rig-buttons").style("margin-top:12px"):
            line = ui.label().classes("rig-command").style("flex:1 1 20em").props("data-testid=command")
            action("Copy command", lambda: copy(command.of_point(session.state), "Command"))

    def refresh() -> None:
        found = point.find(session.state)
        said.set_content(notes(found.fault, found.remarks))
        for key, number in numbers:
            number.show(found.facts.get(key))
        picture.set_content(_picture(found))
        table.set_content(facts_table(found.facts.values()))
        line.set_text(command.of_point(session.state))

    session.watch(refresh)


def _picture(found: point.FoundPoint) -> str:
    if found.shown is None:
        return ""
    at = []
    if found.answer is not None:
        x, y, z = (float(value) for value in found.answer.point_left)
        near, far, std = (float(found.facts[key].value) for key in ("depth_near", "depth_far", "depth_std"))
        at = [PlanPoint((x, y, z), near / 1e3, far / 1e3, std)]
    return plan_svg(found.shown.rig, at, sized=found.shown.sized)
