"""Every closed-form number of a rig at the distances that matter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rigsim.api.calc.depth import calc_depth
from rigsim.api.calc.fact import Assumed, Fact
from rigsim.api.calc.limits import Reached, facts_at, rig_facts, search_facts
from rigsim.api.calc.requirement import Kept, keeps
from rigsim.errors import RigsimError
from rigsim.rig.remark import Remark
from rigsim.studio.logic.distances import Distances, distances_of
from rigsim.studio.logic.faults import plain
from rigsim.studio.logic.rig import Shown, options_of, shown_rig
from rigsim.studio.state import State
from rigsim.study.calc.limits import limit_remarks
from rigsim.typed.search import searched

PLACES = ("near", "at", "far")
"""Where numbers are told: the near end, the distance looked at, the far end."""


@dataclass(frozen=True, slots=True, eq=False)
class RigNumbers:
    """What a rig can do, or why it cannot be said."""

    state: State
    """The words that this is of."""
    shown: Shown | None
    """The rig; None where its words cannot be read."""
    distances: Distances | None
    """Where it is to work; None where that cannot be read."""
    of_rig: Mapping[str, Fact]
    """What holds at any distance, by key."""
    places: Mapping[str, Mapping[str, Fact]]
    """What holds at each of `PLACES`, by key."""
    kept: Kept | None
    """Whether the requirement is kept; None for none."""
    remarks: tuple[Remark, ...]
    """What is odd."""
    fault: str
    """Why there is no answer, and the way out; else empty."""


def numbers_of(state: State) -> RigNumbers:
    """The numbers of the rig that the words describe.

    A principal point is no part of them: `rigsim calc depth` takes none.
    """
    state = state.with_words(principal="")
    shown = distances = None
    try:
        shown = shown_rig(state, size_for="this page")
        distances = distances_of(state)
        return _numbers(state, shown, distances)
    except RigsimError as error:
        return RigNumbers(state, shown, distances, {}, {}, None, (), plain(str(error)))


def _numbers(state: State, shown: Shown, distances: Distances) -> RigNumbers:
    rig, assumed = shown.rig, Assumed(shown.noise, sized=shown.sized, odd=shown.remarks)
    search = searched(options_of(state), None)
    ahead = [*rig_facts(rig), *search_facts(rig, search, Reached(0.0, "added to both", ()))]
    places: dict[str, Mapping[str, Fact]] = {}
    remarks: list[Remark] = []
    dark_m = []
    for name, depth_mm in zip(PLACES, (distances.near_mm, distances.at_mm, distances.far_mm), strict=True):
        told = calc_depth(rig, depth_mm, assumed)
        remarks += told.remarks
        facts = {fact.key: fact for fact in (*facts_at(rig, depth_mm), *told.facts)}
        places[name] = facts
        if facts["overlap_share"].value == 0.0:
            dark_m.append(depth_mm / 1e3)
    kept = None
    if distances.required is not None:
        kept = keeps(rig, shown.noise, distances.required, distances.far_m)
    remarks += limit_remarks(rig, dark_m) if dark_m else ()
    of_rig = {fact.key: fact for fact in ahead}
    return RigNumbers(state, shown, distances, of_rig, places, kept, tuple(remarks), "")
