"""Files of the rig that is shown, and its place among those that are compared."""

from __future__ import annotations

from nicegui import ui

from rigsim.errors import RigsimError
from rigsim.studio.kit.apart import apart
from rigsim.studio.kit.controls import action
from rigsim.studio.kit.latest import Latest
from rigsim.studio.kit.session import Session
from rigsim.studio.logic import compare, take_away
from rigsim.studio.logic.faults import plain
from rigsim.studio.logic.numbers import RigNumbers


def files(session: Session, numbers: Latest[RigNumbers]) -> None:
    """The buttons."""

    def download(content: bytes, name: str) -> None:
        if content:
            ui.download.content(content, name)
        else:
            ui.notify("There is no rig to take away: see what is said above", type="warning")

    async def picture() -> None:
        found = numbers()
        content = b""
        if found.shown is not None and found.distances is not None:
            at_m = found.distances.at_mm / 1e3
            rig, noise_px = found.shown.rig, found.shown.noise.std_px
            content = await apart(take_away.plan_png, rig, at_m, noise_px) or b""
        download(content, "rig.png")

    def pin() -> None:
        try:
            ui.navigate.to(compare.pin(session.state).address("compare"))
        except RigsimError as error:
            ui.notify(plain(str(error)), type="warning")

    with ui.element("section").classes("rig-panel w-full").props('aria-label="Take it away"'):
        ui.html("<h2>Take it away</h2>", sanitize=False)
        with ui.element("div").classes("rig-buttons"):
            action("rig.toml", lambda: download(take_away.rig_toml(numbers()), "rig.toml"), icon="download")
            action("CSV", lambda: download(take_away.numbers_csv(numbers()), "rig.csv"), icon="download")
            action("PNG", picture, icon="download")
            action("Pin to compare", pin, icon="push_pin")
