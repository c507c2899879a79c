"""The ranked quantities of a class, and the yields."""

from __future__ import annotations

import math
from html import escape

from nicegui import ui

from rigsim.present.kit.format import percent, plain
from rigsim.present.live.built import ranked_bars
from rigsim.studio.kit.apart import apart
from rigsim.studio.kit.controls import action
from rigsim.studio.kit.numbers import notes, scrolling
from rigsim.studio.kit.session import Session
from rigsim.studio.logic.tolerance import built, ranking


class Ranked:
    """The ranked quantities of a class, and the yields; counted when the hand rests."""

    def __init__(self, session: Session) -> None:
        """Rank nothing yet."""
        self._session = session
        self._ranking: ranking.Ranking | None = None
        self._busy = False

    def place(self) -> None:
        """Lay it out."""
        with ui.element("section").classes("rig-panel w-full").props('aria-label="What matters most"'):
            self._title = ui.html("<h2>What matters most</h2>", sanitize=False)
            self._stale = ui.html("", sanitize=False).props('aria-live="polite"')
            self._yield = ui.html("", sanitize=False).classes("w-full")
            self._bars = (
                ui.echart({"series": []}, renderer="svg")
                .classes("rig-graph")
                .props('role="img" aria-label="What each quantity does, ranked"')
            )
            self._needed = scrolling("What each quantity may be")
            with ui.element("div").classes("rig-buttons").style("margin-top:12px") as self._actions:
                action("tolerance.csv", self._download, icon="download")
            for part in (self._bars, self._actions):
                part.set_visibility(False)

    @property
    def _is_current(self) -> bool:
        return self._ranking is not None and self._ranking.words == ranking.asked(self._session.state)

    @property
    def _is_whole(self) -> bool:
        return self._ranking is not None and (self._ranking.whole or bool(self._ranking.fault))

    def follow(self) -> None:
        """Say whether what is shown is of these words."""
        current = self._is_current
        waiting = "" if current and self._is_whole else "<p class=rig-soft>Built rigs are counted …</p>"
        self._stale.set_content(waiting)
        for part in (self._yield, self._bars, self._needed):
            part.classes(remove="rig-stale") if current else part.classes("rig-stale")

    def rested(self) -> None:
        """Count built rigs of what the words say now, unless that is known or running."""
        if not self._busy and not (self._is_current and self._is_whole):
            ui.timer(0.01, self._rank, once=True)

    async def _rank(self) -> None:
        if self._busy:
            return
        self._busy = True
        try:
            while not (self._is_current and self._is_whole):
                words, whole = ranking.asked(self._session.state), self._is_current
                made = await apart(ranking.rank, words, whole)
                if made is None:
                    return
                self._ranking = made
                self._show(made)
                self.follow()
        finally:
            self._busy = False

    def _show(self, made: ranking.Ranking) -> None:
        name = self._session.state["class"] or built.CLASSES[0]
        self._title.set_content(f"<h2>What matters most in a {escape(name)} build</h2>")
        for part in (self._bars, self._actions):
            part.set_visibility(not made.fault)
        if made.fault:
            self._yield.set_content(notes(made.fault, ()))
            self._needed.set_content("")
            return
        after = (
            "" if math.isnan(made.recalibrated) else f", {percent(made.recalibrated)} % after recalibration"
        )
        self._yield.set_content(
            f"<p><b data-testid=yield>{percent(made.as_built)} % of the rigs are good as built{after}.</b> "
            f"{escape(made.headline)}</p>"
        )
        that = [one for one in made.quantities if one.common_mm or one.differing_mm]
        names = [one.name for one in that]
        at = f"{plain(made.at_m)} m"
        self._bars.options.clear()
        self._bars.options.update(
            ranked_bars(names, [one.common_mm for one in that], [one.differing_mm for one in that], at)
        )
        self._bars.style(f"height:{90 + 30 * len(that)}px")
        self._bars.update()
        self._bars.props(f'aria-label="Depth error that each quantity makes alone at {at}, the worst first"')
        self._needed.set_content(_needed(made))

    def _download(self) -> None:
        if self._ranking is not None and self._ranking.csv:
            ui.download.content(self._ranking.csv, "tolerance.csv")


def _needed(made: ranking.Ranking) -> str:
    heads = (
        "quantity",
        "class's tolerance",
        "of the variance, %",
        "may be, alone",
        "may be, all together",
        "unit",
    )
    head = "".join(
        f"<th class={'num' if 0 < place < 5 else 'text'}>{name}</th>" for place, name in enumerate(heads)
    )
    rows = "".join(
        f"<tr><td>{escape(one.name)}</td>"
        + "".join(f"<td class=num>{escape(cell)}</td>" for cell in one.cells[:-1])
        + f"<td>{escape(one.cells[-1])}</td></tr>"
        for one in made.quantities
    )
    return f"<table class='rig-table rig-below'><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
