"""The command lines that give the same numbers."""

from __future__ import annotations

from nicegui import ui

from rigsim.studio.kit.clipboard import copy
from rigsim.studio.kit.controls import action
from rigsim.studio.kit.latest import Latest
from rigsim.studio.kit.session import Session
from rigsim.studio.logic import command
from rigsim.studio.logic.numbers import RigNumbers


def commands(session: Session, numbers: Latest[RigNumbers]) -> None:
    """The lines, each with its button."""
    with ui.element("section").classes("rig-panel w-full").props('aria-label="Command lines"'):
        ui.html("<h2>The same numbers on the command line</h2>", sanitize=False)
        lines = [_line(f"command-{name}") for name in ("depth", "limits")]

    def refresh() -> None:
        found = numbers()
        if found.distances is None:
            return
        said = command.of_rig(found.state, found.distances.words)
        for label, text in zip(lines, said, strict=True):
            label.set_text(text)

    session.watch(refresh)


def _line(testid: str) -> ui.label:
    with ui.element("div").classes("rig-buttons").style("margin-top:8px"):
        label = ui.label().classes("rig-command").style("flex:1 1 20em").props(f"data-testid={testid}")
        action("Copy command", lambda: copy(label.text, "Command"))
    return label
