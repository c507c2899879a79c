"""The one built rig: what it reads, and where in the image."""

from __future__ import annotations

from html import escape

from nicegui import ui

from rigsim.present.kit.format import number, plain
from rigsim.present.live.built import error_map
from rigsim.studio.kit.latest import Latest
from rigsim.studio.kit.numbers import ShownNumber, facts_table, notes, scrolling
from rigsim.studio.logic.tolerance import built

_NUMBERS = (
    ("depth error of the build", "build-error", "build"),
    ("with pixel noise", "whole-error", "whole"),
    ("shared by the whole image", "common-error", "common"),
    ("rows apart", "row-error", "row"),
    ("rows apart, at most", "row-largest", "row_largest"),
)


class OneRig:
    """The one built rig."""

    def __init__(self, found: Latest[built.BuiltFound]) -> None:
        """Show nothing yet; `found` is what the words say."""
        self._found = found

    def place(self) -> None:
        """Lay it out."""
        self._said = ui.html("", sanitize=False).classes("w-full").props('aria-live="polite"')
        with ui.element("section").classes("rig-panel w-full").props('aria-label="What the built rig reads"'):
            self._badge = ui.html("", sanitize=False).classes("w-full").style("margin-bottom:10px")
            with ui.element("div").classes("rig-numbers"):
                self._numbers = [
                    (key, ShownNumber(name, testid, small=place > 1))
                    for place, (name, testid, key) in enumerate(_NUMBERS)
                ]
            self._table = scrolling("Errors at distances").style("margin-top:14px")
        with ui.element("section").classes("rig-panel w-full").props('aria-label="Error map"'):
            self._where = ui.html("<h2>Depth error over the left image</h2>", sanitize=False)
            self._map = ui.echart({"series": []}).classes("rig-graph rig-map").props('role="img"')
            self._alone = scrolling("Each deviation alone")

    def follow(self) -> None:
        """Draw what the words say."""
        found = self._found()
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
    return f"<table class='rig-table rig-figures'><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
