"""Tolerance: a rig that was built a little off, and what of a build matters most."""

from __future__ import annotations

import math
from html import escape

from nicegui import run, ui

from rigsim.present.kit.format import number, percent, plain
from rigsim.present.live.built import error_map, ranked_bars
from rigsim.rig.quantity import NOISE
from rigsim.studio.kit.clipboard import copy
from rigsim.studio.kit.controls import SignedSpan, action, choice, quantity_slider, text_box
from rigsim.studio.kit.numbers import Number, facts_table, notes
from rigsim.studio.kit.session import Session
from rigsim.studio.kit.shell import frame
from rigsim.studio.logic.tolerance import built, ranking
from rigsim.studio.state import State
from rigsim.study.tolerance.inputs import QUANTITIES

_NUMBERS = (
    ("depth error of the build", "build-error", "build"),
    ("with pixel noise", "whole-error", "whole"),
    ("shared by the whole image", "common-error", "common"),
    ("rows apart", "row-error", "row"),
    ("rows apart, at most", "row-largest", "row_largest"),
)
_CLASSES = {"": "machined", "printed": "printed", "calibrated": "calibrated"}


def begin(state: State) -> State:
    """What the page shows for an address."""
    return built.begin(state)


def build(session: Session) -> None:
    """The page."""
    one, ranked = _Built(session), _Ranked(session)
    with frame(session):
        ui.html("<h1>A rig that was built a little off</h1>", sanitize=False)
        ui.label(
            "Turn and shift the right camera; see what the rig that you assume reads, and where."
        ).classes("rig-lead")
        with ui.element("div").classes("rig-columns"):
            with ui.element("div").classes("rig-stack"):
                _controls(session)
            with ui.element("div").classes("rig-stack"):
                one.place()
                ranked.place()
                _command(session)
    session.watch(one.follow)
    session.watch(ranked.follow)
    session.when_resting(ranked.rested)
    ranked.rested()


def _controls(session: Session) -> None:
    with ui.element("section").classes("rig-panel w-full").props('aria-label="Built rig"'):
        ui.html("<h2>The built rig is off by</h2>", sanitize=False)
        for one in built.DEVIATIONS:
            span = SignedSpan(-one.reach, one.reach, log=False, unit=built.UNIT_OF[one.word])
            name = QUANTITIES[one.key]
            label = f"{name[:1].upper()}{name[1:]}, {span.unit}"
            quantity_slider(session, one.word, label, one.kind, span, 0.0, placeholder=f"0 {span.unit}")
        with ui.element("div").classes("rig-buttons").style("margin-top:10px"):
            action("As drawn", lambda: session.show(built.as_drawn(session.state)), icon="restart_alt")
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


class _Built:
    """The one built rig."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def place(self) -> None:
        """Lay it out."""
        self._said = ui.html("", sanitize=False).classes("w-full").props('aria-live="polite"')
        with ui.element("section").classes("rig-panel w-full").props('aria-label="What the built rig reads"'):
            self._badge = ui.html("", sanitize=False).classes("w-full").style("margin-bottom:10px")
            with ui.element("div").classes("rig-numbers"):
                self._numbers = [
                    (key, Number(name, testid, small=place > 1))
                    for place, (name, testid, key) in enumerate(_NUMBERS)
                ]
            self._table = ui.html("", sanitize=False).classes("rig-scroll").style("margin-top:14px")
        with ui.element("section").classes("rig-panel w-full").props('aria-label="Error map"'):
            self._where = ui.html("<h2>Depth error over the left image</h2>", sanitize=False)
            self._map = ui.echart({"series": []}).classes("rig-chart").props('role="img"')
            self._alone = ui.html("", sanitize=False).classes("rig-scroll")

    def follow(self) -> None:
        """Draw what the words say."""
        found = built.find(self._session.state)
        self._said.set_content(notes(found.fault, found.remarks))
        kind, text = found.verdict
        self._badge.set_content(
            f"<span class='rig-badge {kind}' data-testid=verdict>{escape(text)}</span>" if text else ""
        )
        facts = found.facts
        for key, shown in self._numbers:
            shown.show(facts.get(key))
        self._table.set_content(_distances(found))
        alone = built.alone(found)
        self._alone.set_content(f"<h3>Each alone, mean depth error</h3>{facts_table(alone)}" if alone else "")
        if found.answer is None:
            return
        where = found.answer.map
        self._map.options.clear()
        self._map.options.update(error_map(where.u_px, where.v_px, where.error_mm, "depth error", "mm"))
        self._map.update()
        at = f"{plain(where.depth_m)} m"
        self._map.props(f'aria-label="Depth error over the left image at {at}"')
        self._where.set_content(f"<h2>Depth error over the left image, at {at}</h2>")


def _distances(found: built.BuiltFound) -> str:
    if found.answer is None:
        return ""
    heads = (
        "distance, m",
        "shared, mm",
        "build, rms mm",
        "largest, mm",
        "noise alone, mm",
        "with noise, mm",
        "rows, rms px",
        "rows, largest px",
    )
    rows = "".join(
        "<tr>"
        + "".join(
            f"<td class=num>{escape(cell)}</td>"
            for cell in (
                plain(at.depth_m),
                *(
                    number(value)
                    for value in (
                        at.common_mm,
                        at.rms_mm,
                        at.largest_mm,
                        at.noise_mm,
                        at.whole_mm,
                        at.row_px,
                        at.row_largest_px,
                    )
                ),
            )
        )
        + "</tr>"
        for at in found.answer.at
    )
    head = "".join(f"<th class=num>{name}</th>" for name in heads)
    return f"<table class=rig-table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"


class _Ranked:
    """The ranked quantities of a class, and the yields; counted when the hand rests."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._ranking: ranking.Ranking | None = None
        self._busy = False

    def place(self) -> None:
        """Lay it out."""
        with ui.element("section").classes("rig-panel w-full").props('aria-label="What matters most"'):
            self._title = ui.html("<h2>What matters most</h2>", sanitize=False)
            self._stale = ui.html("", sanitize=False).props('aria-live="polite"')
            self._yield = ui.html("", sanitize=False).classes("w-full")
            self._bars = ui.echart({"series": []}, renderer="svg").classes("rig-chart").props('role="img"')
            self._needed = ui.html("", sanitize=False).classes("rig-scroll")
            with ui.element("div").classes("rig-buttons").style("margin-top:12px"):
                action("tolerance.csv", self._download, icon="download")

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
                made = await run.cpu_bound(ranking.rank, words, whole)
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
        self._bars.set_visibility(not made.fault)
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
