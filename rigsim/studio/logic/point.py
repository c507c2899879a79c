"""The page that it began as: one point seen in both images."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from rigsim.api.calc.fact import Assumed, Fact
from rigsim.api.calc.point import PointAnswer, calc_point
from rigsim.errors import InvalidRange, RigsimError
from rigsim.rig.remark import Remark
from rigsim.studio.logic import command
from rigsim.studio.logic.faults import plain
from rigsim.studio.logic.rig import Shown, shown_rig
from rigsim.studio.state import State
from rigsim.typed import quantity

DEFAULTS = State({"focal": "1200", "baseline": "150mm", "left": "980,500", "right": "910,500"})
"""What the page begins with, and goes back to."""
EXAMPLES: Mapping[str, State] = MappingProxyType(
    {
        "Drone before a branch": DEFAULTS,
        "Desktop scanner": State(
            {"focal": "2000", "baseline": "80mm", "left": "1400,500", "right": "1250,500"}
        ),
    }
)
"""Two cases worked out by hand, by name."""


@dataclass(frozen=True, slots=True, eq=False)
class FoundPoint:
    """The answer, or why there is none."""

    shown: Shown | None
    """The rig; None where its words cannot be read."""
    answer: PointAnswer | None
    """The point; None where there is none."""
    fault: str
    """Why there is no answer, and the way out; else empty."""

    @property
    def remarks(self) -> tuple[Remark, ...]:
        """What is odd."""
        return () if self.answer is None else self.answer.remarks

    @property
    def facts(self) -> Mapping[str, Fact]:
        """Every number, by key."""
        return {} if self.answer is None else {fact.key: fact for fact in self.answer.facts}


def find(state: State) -> FoundPoint:
    """The point that the words say."""
    shown = None
    try:
        uv_left = quantity.point(_said(state["left"], "x1, y1"), "left position")
        uv_right = quantity.point(_said(state["right"], "x2, y2"), "right position")
        shown = shown_rig(state)
        assumed = Assumed(shown.noise, sized=shown.sized, from_axis=shown.from_axis, odd=shown.remarks)
        return FoundPoint(shown, calc_point(shown.rig, uv_left, uv_right, assumed), "")
    except RigsimError as error:
        return FoundPoint(shown, None, plain(str(error)))


def summary(state: State) -> str:
    """The formatted summary that is copied: what was typed, what came out, and the command."""
    found = find(state)
    given = [
        ("focal length", state["focal"] and _with_unit(state["focal"], "px")),
        ("baseline", state["baseline"] and _with_unit(state["baseline"], "mm")),
        ("left pixel (x1, y1)", f"{state['left']} px"),
        ("right pixel (x2, y2)", f"{state['right']} px"),
    ]
    lines = ["rigsim: one point in two pictures", ""]
    lines += [f"{name:<22} {value}" for name, value in given if value]
    lines.append("")
    if found.fault:
        lines.append(found.fault)
    for fact in found.facts.values():
        lines.append(f"{fact.name:<22} {fact.shown} {fact.unit}".rstrip())
    lines += [f"note: {remark.text}" for remark in found.remarks]
    return "\n".join([*lines, "", command.of_point(state)]) + "\n"


def pair(first: str, second: str) -> str:
    """Two boxes as one word: ``980,500``; empty where both are."""
    return f"{first.strip()},{second.strip()}" if first.strip() or second.strip() else ""


def halves(word: str) -> tuple[str, str]:
    """The two boxes of a word."""
    first, _, second = word.partition(",")
    return first, second


def _said(word: str, boxes: str) -> str:
    if not all(halves(word)):
        raise InvalidRange(f"{boxes}: type both numbers, in pixels")
    return word


def _with_unit(text: str, unit: str) -> str:
    return text if quantity.UNIT.search(text) else f"{text} {unit}"
