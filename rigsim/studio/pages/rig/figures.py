"""The closed-form numbers."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from nicegui import ui

from rigsim.api.calc.fact import Fact
from rigsim.present.kit.format import MISSING, length_mm
from rigsim.studio.kit.latest import Latest
from rigsim.studio.kit.numbers import ShownNumber, notes, told_html
from rigsim.studio.kit.session import Session
from rigsim.studio.logic.numbers import PLACES, RigNumbers

_LARGE = (
    ("depth error, std", "depth_std"),
    ("depth step of one pixel", "depth_step"),
    ("overlap share", "overlap_share"),
    ("width of a pixel", "world_per_pixel"),
)
_OF_RIG = (
    ("field of view", "hfov_deg"),
    ("overlap far away", "overlap_fov_deg"),
    ("blind zone", "blind_zone"),
    ("nearest depth of the search", "min_depth"),
)
_ROWS = (
    "depth_std",
    "depth_near",
    "depth_far",
    "depth_bias",
    "depth_step",
    "world_per_pixel",
    "disparity_px",
    "overlap_share",
    "overlap_width",
    "overlap_height",
    "dead_band_px",
)
_BADGES = {
    "met": ("agrees", "met"),
    "not_met": ("flagged", "not met"),
    "not_seen": ("untold", "not seen there"),
}


def figures(session: Session, numbers: Latest[RigNumbers]) -> None:
    """Large numbers, the requirement's badge, and the table by distance."""
    said = ui.html("", sanitize=False).classes("w-full rig-notes").props('aria-live="polite"')
    with ui.element("section").classes("rig-panel w-full").props('aria-label="Numbers"'):
        with ui.element("div").classes("rig-titled"):
            title = ui.html("", sanitize=False)
            badge = ui.html("", sanitize=False).props('aria-live="polite"')
        with ui.element("div").classes("rig-numbers"):
            large = [(key, ShownNumber(name, key.replace("_", "-"))) for name, key in _LARGE]
        with ui.element("div").classes("rig-numbers").style("margin-top:14px"):
            small = [(key, ShownNumber(name, key.replace("_", "-"), small=True)) for name, key in _OF_RIG]
        with ui.expansion("All numbers by distance").classes("w-full rig-more").props("dense"):
            table = ui.html("", sanitize=False).classes("rig-scroll")

    def refresh() -> None:
        found = numbers()
        said.set_content(notes(found.fault, found.remarks))
        at = found.places.get("at", {})
        for key, number in large:
            number.show(at.get(key))
        for key, number in small:
            number.show(found.of_rig.get(key))
        title.set_content(_title(found))
        badge.set_content(_badge(found))
        table.set_content(_table(found.places))

    session.watch(refresh)


def _title(found: RigNumbers) -> str:
    if found.distances is None:
        return "<h2>Numbers</h2>"
    return f"<h2>At {escape(length_mm(found.distances.at_mm))}</h2>"


def _badge(found: RigNumbers) -> str:
    kept = found.kept
    if kept is None:
        return ""
    look, word = _BADGES[kept.verdict]
    what = "95 of 100 errors under" if kept.p95 else "error"
    error = "" if kept.verdict == "not_seen" else f"{what} {length_mm(kept.error_mm)}, "
    says = f"{error}{length_mm(kept.limit_mm)} allowed at {length_mm(kept.at_mm)}"
    return (
        f'<span class="rig-badge {look}" data-testid="requirement">{word}</span> '
        f'<span class="rig-soft">{escape(says)}</span>'
    )


def _table(places: Mapping[str, Mapping[str, Fact]]) -> str:
    if not places:
        return ""
    heads = "".join(
        f"<th class=num scope=col>{name} {escape(length_mm(float(places[place]['z'].value)))}</th>"
        for place, name in zip(PLACES, ("near", "at", "far"), strict=True)
    )
    rows = []
    for key in _ROWS:
        fact = places["at"][key]
        cells = "".join(
            f'<td class=num data-testid="{key.replace("_", "-")}-{place}">{_cell(places[place][key])}</td>'
            for place in PLACES
        )
        rows.append(
            f"<tr><th scope=row>{escape(fact.name)}</th>{cells}<td>{escape(fact.unit)}</td>"
            f"<td>{escape(fact.meaning)}</td></tr>"
        )
    head = f"<tr><th scope=col>number</th>{heads}<th scope=col>unit</th><th scope=col>description</th></tr>"
    return f"<table class=rig-table><thead>{head}</thead><tbody>{''.join(rows)}</tbody></table>"


def _cell(fact: Fact) -> str:
    return MISSING if fact.shown == MISSING else told_html(fact)
