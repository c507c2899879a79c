"""Numbers as they stand on a page: large ones, and tables of facts."""

from __future__ import annotations

import math
from collections.abc import Iterable
from html import escape

from nicegui import ui

from rigsim.api.calc.fact import Fact
from rigsim.present.kit.format import MISSING
from rigsim.rig.remark import Remark


class ShownNumber:
    """A large number with its name and unit."""

    def __init__(self, name: str, testid: str, *, small: bool = False) -> None:
        """Place it; `testid` is what finds it in a test."""
        with ui.element("div").classes("rig-number small" if small else "rig-number"):
            ui.label(name).classes("name")
            with ui.element("div").classes("value"):
                self._value = ui.html(MISSING, sanitize=False, tag="span").props(f"data-testid={testid}")
                self._unit = ui.html("", sanitize=False, tag="span").classes("unit")

    def show(self, fact: Fact | None) -> None:
        """Show a fact, or that there is none."""
        told = fact is not None and fact.shown != MISSING
        self._value.set_content(told_html(fact) if fact is not None and told else MISSING)
        self._unit.set_content(escape(fact.unit) if fact is not None and told else "")


def told_html(fact: Fact) -> str:
    """A fact as people see it, with the whole number for programs."""
    if isinstance(fact.value, str) or not math.isfinite(fact.value):
        return escape(fact.shown)
    return f"<data value={fact.value!r}>{escape(fact.shown)}</data>"


def facts_table(facts: Iterable[Fact]) -> str:
    """The summary table as HTML: parameter, value, unit, description."""
    rows = "".join(
        f"<tr><td>{escape(fact.name)}</td><td class=num>{escape(fact.shown)}</td><td>{escape(fact.unit)}</td>"
        f"<td>{escape(fact.meaning)}</td></tr>"
        for fact in facts
    )
    head = "<tr><th>parameter</th><th class=num>value</th><th>unit</th><th>description</th></tr>"
    return f"<table class=rig-table><thead>{head}</thead><tbody>{rows}</tbody></table>"


def notes(fault: str, remarks: Iterable[Remark]) -> str:
    """What is wrong, and what is odd, as HTML."""
    first = f"<div class=rig-fault role=alert data-testid=fault>{escape(fault)}</div>" if fault else ""
    texts = dict.fromkeys(remark.text for remark in remarks)
    return first + "".join(f"<div class=rig-note>{escape(text)}</div>" for text in texts)


def scrolling(name: str) -> ui.html:
    """A place for a table that may be wider than the screen: reached, and moved, by keys as well."""
    return (
        ui.html("", sanitize=False).classes("rig-scroll").props(f'tabindex=0 role=region aria-label="{name}"')
    )
