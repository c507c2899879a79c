"""The rig from above and from its side."""

from __future__ import annotations

from nicegui import ui

from rigsim.present.live.plan import plan_svg
from rigsim.present.live.side import side_svg
from rigsim.studio.kit.latest import Latest
from rigsim.studio.kit.session import Session
from rigsim.studio.logic.numbers import RigNumbers


def views(session: Session, numbers: Latest[RigNumbers]) -> None:
    """Both drawings."""
    with ui.element("div").classes("rig-pair w-full"):
        above, beside = (_panel(name) for name in ("From above", "From the side"))

    def refresh() -> None:
        found = numbers()
        if found.shown is None or found.distances is None:
            above.set_content("")
            beside.set_content("")
            return
        rig, reach = found.shown.rig, found.distances
        above.set_content(plan_svg(rig, sized=True, reach_m=reach.far_m))
        beside.set_content(side_svg(rig, reach.near_m, reach.far_m))

    session.watch(refresh)


def _panel(name: str) -> ui.html:
    with ui.element("section").classes("rig-panel").props(f'aria-label="{name}"'):
        ui.html(f"<h2>{name}</h2>", sanitize=False)
        return ui.html("", sanitize=False).classes("w-full")
