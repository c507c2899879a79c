"""Compare: up to four rigs, their curves overlaid and their numbers side by side."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from html import escape

from nicegui import ui

from rigsim.errors import RigsimError
from rigsim.present.live.axes import COLORS
from rigsim.present.live.comparison import comparison_options
from rigsim.rig.presets import PRESETS
from rigsim.studio.kit.controls import action, text_box
from rigsim.studio.kit.latest import Latest
from rigsim.studio.kit.session import Session
from rigsim.studio.kit.shell import frame
from rigsim.studio.logic import compare
from rigsim.studio.logic.faults import plain
from rigsim.studio.state import State
from rigsim.studio.words import OF_RIG, PINS


def begin(state: State) -> State:
    """What the page shows for an address: two cameras to buy where it names no rig to compare."""
    words = {**state.words}
    if not any(slot in words for slot in PINS):
        words |= {name: compare.DEFAULTS[name] for name in PINS if compare.DEFAULTS[name]}
    words.setdefault("range", compare.DEFAULTS["range"])
    return State(words)


def build(session: Session) -> None:
    """The page."""
    rigs = Latest(session, compare.pinned)
    with frame(session):
        ui.html("<h1>Rigs side by side</h1>", sanitize=False)
        ui.label(f"Up to {len(PINS)}: cameras that one can buy, and rigs made under Rig.").classes("rig-lead")
        with ui.element("div").classes("rig-columns"):
            with ui.element("section").classes("rig-panel").props('aria-label="Rigs to compare"'):
                _pins(session, rigs)
                _distances(session)
            with ui.element("div").classes("rig-stack"):
                _answer(session, rigs)


def _pins(session: Session, rigs: Latest[tuple[compare.Pinned, ...]]) -> None:
    ui.html("<h2>Rigs</h2>", sanitize=False)
    listed = ui.element("div").classes("rig-pins").props("data-testid=pins")
    with ui.element("div").classes("rig-buttons").style("margin-top:12px"):
        names = {name: name for name in PRESETS}
        chosen = (
            ui.select(names, label="Add a preset").props("dense outlined options-dense").classes("w-full")
        )
        shown = action("Pin the rig of page Rig", lambda: _try(session, compare.pin), icon="push_pin")

    def add() -> None:
        if chosen.value:
            name = str(chosen.value)
            chosen.set_value(None)
            _try(session, lambda state: compare.pin_preset(state, name))

    chosen.on_value_change(add)

    def refresh() -> None:
        shown.set_enabled(not OF_RIG.isdisjoint(session.state.words))
        listed.clear()
        with listed:
            for index, one in enumerate(rigs()):
                _pin(session, index, one)

    session.watch(refresh)


def _pin(session: Session, index: int, one: compare.Pinned) -> None:
    with ui.element("div").classes("rig-pin"):
        ui.element("span").classes("rig-dot").style(f"background:{COLORS[index]}")
        own = {name: text for name, text in session.state.words.items() if name not in OF_RIG | {"noise"}}
        link = State({**own, **one.state.words}).address("rig")
        ui.link(one.name, link).classes("rig-pin-name")
        remove = ui.button(icon="close", on_click=partial(_remove, session, one.slot))
        remove.props(f'flat round dense size=sm aria-label="Remove {escape(one.name)}"')


def _remove(session: Session, slot: str) -> None:
    session.show(session.state.with_words(**{slot: ""}))


def _try(session: Session, change: Callable[[State], State]) -> None:
    try:
        session.show(change(session.state))
    except RigsimError as error:
        ui.notify(plain(str(error)), type="warning")


def _distances(session: Session) -> None:
    ui.html("<h2 style='margin-top:18px'>Where</h2>", sanitize=False)
    with ui.element("div").classes("rig-fields"):
        text_box(session, "range", "Working range", hint="near:far, as 0.5:5m").classes("rig-wide")
        text_box(session, "z", "Distance", hint="where numbers are told, as 3m").classes("rig-wide")


def _answer(session: Session, rigs: Latest[tuple[compare.Pinned, ...]]) -> None:
    said = ui.html("", sanitize=False).classes("rig-notes w-full").props('aria-live="polite"')
    with ui.element("section").classes("rig-panel w-full").props('aria-label="Depth error"'):
        ui.html("<h2>Depth error over the working range</h2>", sanitize=False)
        chart = ui.echart(comparison_options(())).classes("w-full").style("height:400px")
        chart.props("data-testid=curves")
    with ui.element("section").classes("rig-panel w-full").props('aria-label="Numbers"'):
        ui.html("<h2>Numbers side by side</h2>", sanitize=False)
        table = ui.html("", sanitize=False).classes("rig-scroll")

    def refresh() -> None:
        shown = rigs()
        said.set_content(_said(compare.faults(shown), compare.sentence(shown)))
        options = comparison_options([(one.name, one.curve) for one in shown if one.curve is not None])
        chart.options.clear()
        chart.options.update(options)
        chart.update()
        table.set_content(_table(shown))

    session.watch(refresh)


def _said(faults: Sequence[str], answer: str) -> str:
    wrong = "".join(f"<div class=rig-fault role=alert>{escape(text)}</div>" for text in faults)
    return wrong + (f"<div class=rig-note data-testid=says>{escape(answer)}</div>" if answer else "")


def _table(rigs: Sequence[compare.Pinned]) -> str:
    if not rigs:
        return "<p class=rig-soft>No rig is compared: add one on the left.</p>"
    heads = "".join(
        f"<th class=num scope=col><span class=rig-dot style='background:{COLORS[index]}'></span> "
        f"{escape(one.name)}</th>"
        for index, one in enumerate(rigs)
    )
    rows = []
    for row in compare.table(rigs):
        cells = "".join(
            f"<td class='num{' best' if index == row.best else ''}'>{escape(cell)}"
            f"{' <span class=rig-best>best</span>' if index == row.best else ''}</td>"
            for index, cell in enumerate(row.cells)
        )
        name = f"{escape(row.name)}{f', {escape(row.unit)}' if row.unit else ''}"
        rows.append(f"<tr{' class=differs' if row.differs else ''}><th scope=row>{name}</th>{cells}</tr>")
    head = f"<thead><tr><th scope=col>quantity</th>{heads}</tr></thead>"
    body = f"<tbody>{''.join(rows)}</tbody>"
    return f"<table class='rig-table rig-beside' data-testid=beside>{head}{body}</table>"
