"""The rigs that no other beats, as a table that can be sorted."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from rigsim.present.design.console import candidate_row
from rigsim.studio.logic.design.feasible import picked
from rigsim.studio.state import State
from rigsim.study.design.solve import Candidate


@dataclass(frozen=True, slots=True)
class TradeColumn:
    """One column."""

    name: str
    """Its head, with the unit."""
    value: Callable[[Candidate], float]
    """What it is sorted by."""


COLUMNS: Mapping[str, TradeColumn] = MappingProxyType(
    {
        "baseline": TradeColumn("baseline, mm", lambda one: one.baseline_m),
        "focal": TradeColumn("focal length, px", lambda one: one.camera.focal_px),
        "image": TradeColumn("image, px", lambda one: float(one.camera.pixels)),
        "hfov": TradeColumn("field of view, deg", lambda one: one.camera.hfov_rad),
        "error": TradeColumn("error at far end, mm", lambda one: one.far_error_m),
    }
)
"""By the word that sorts by it."""


@dataclass(frozen=True, slots=True)
class TradeRow:
    """One rig."""

    cells: tuple[str, ...]
    """As `COLUMNS`, as people see them; the camera's name last."""
    address: str
    """Where it is shown."""


def next_sort(now: str, name: str) -> str:
    """The word for the next press on a head: ascending, descending, then the preference's own order."""
    return {"": name, name: f"-{name}", f"-{name}": ""}.get(now, name)


def direction(now: str, name: str) -> str:
    """How a column is sorted, as ``aria-sort`` says it."""
    return {name: "ascending", f"-{name}": "descending"}.get(now, "none")


def rows(state: State, candidates: Iterable[Candidate]) -> list[TradeRow]:
    """The rigs in the order that the words ask for, the preference's by default."""
    name = state["sort"].removeprefix("-")
    found = list(candidates)
    if name in COLUMNS:
        found.sort(key=COLUMNS[name].value, reverse=state["sort"].startswith("-"))
    return [_row(state, one) for one in found]


def _row(state: State, one: Candidate) -> TradeRow:
    cells = candidate_row(one)
    size = one.camera.width_px, one.camera.height_px
    shown = picked(state, one.camera.focal_px, one.baseline_m * 1e3, size)
    return TradeRow((*cells[:5], cells[6]), shown.address("rig"))
