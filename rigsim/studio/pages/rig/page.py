"""The page's layout."""

from __future__ import annotations

from nicegui import ui

from rigsim.rig.presets import PRESETS
from rigsim.studio.kit.latest import Latest
from rigsim.studio.kit.session import Session
from rigsim.studio.kit.shell import frame
from rigsim.studio.logic import lenses
from rigsim.studio.logic.numbers import numbers_of
from rigsim.studio.pages.rig.commands import commands
from rigsim.studio.pages.rig.controls import controls
from rigsim.studio.pages.rig.curves import curves
from rigsim.studio.pages.rig.figures import figures
from rigsim.studio.pages.rig.pair import pair
from rigsim.studio.pages.rig.proof import proof
from rigsim.studio.pages.rig.space import space
from rigsim.studio.pages.rig.take_away import files
from rigsim.studio.pages.rig.views import views
from rigsim.studio.state import State
from rigsim.studio.words import OF_RIG

DEFAULTS = State({"preset": "boards", "range": "0.5:5m", "require": "20mm@2m"})
"""What the page begins with, and goes back to."""


def begin(state: State) -> State:
    """What the page shows for an address: a rig, a range and a requirement where it says nothing of them."""
    words = dict(state.words)
    if not any(word in words for word in ("rig", "preset", "resolution")):
        if OF_RIG.isdisjoint(words):
            scene = words.get("scene", "")
            words["preset"] = scene if scene in PRESETS else DEFAULTS["preset"]
        else:
            words["resolution"] = lenses.UNSHOWN["resolution"]
    if "range" not in words:
        words["range"] = DEFAULTS["range"]
        words.setdefault("require", DEFAULTS["require"])
    return State(words)


def build(session: Session) -> None:
    """The page."""
    numbers = Latest(session, numbers_of)
    with frame(session):
        ui.html("<h1>A rig, while you turn it in your hands</h1>", sanitize=False)
        ui.label(
            "Drag the baseline, change the lens: every number says what it is, and can be proved."
        ).classes("rig-lead")
        with ui.element("div").classes("rig-columns"):
            with ui.element("section").classes("rig-panel rig-sticky").props('aria-label="The rig"'):
                controls(session, numbers, DEFAULTS)
            with ui.element("div").classes("rig-stack"):
                figures(session, numbers)
                first = ui.element("div").classes("rig-stack")
                proof(session, numbers)
                curves(session, numbers)
                take = space(session, numbers)
                with first:
                    pair(session, numbers, take)
                views(session, numbers)
                commands(session, numbers)
                files(session, numbers)
