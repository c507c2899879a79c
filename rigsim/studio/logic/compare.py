"""Up to four rigs side by side."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from urllib.parse import parse_qsl

from rigsim.api.calc.better import Rated, better, modes_of
from rigsim.api.calc.fact import Fact
from rigsim.errors import InvalidRange
from rigsim.present.kit.format import MISSING
from rigsim.studio.logic.faults import plain
from rigsim.studio.logic.numbers import RigNumbers, numbers_of
from rigsim.studio.state import State, read_state
from rigsim.studio.words import BY_OPTION, OF_RIG, PINS
from rigsim.study.calc.curve import DepthCurve, depth_curve

DEFAULTS = State({"range": "0.5:5m", "pin1": "preset=oak-d", "pin2": "preset=zed-2i"})
"""What the page begins with: two cameras that one can buy."""
_TAKEN = tuple(name for name in BY_OPTION.values() if name.name in OF_RIG or name.name == "noise")
_QUANTITIES = (
    ("", "focal_px", "focal length", ""),
    ("", "hfov_deg", "field of view", ""),
    ("", "overlap_fov_deg", "overlap far away", "most"),
    ("", "blind_zone", "blind zone", "least"),
    ("", "min_depth", "nearest depth of the search", "least"),
    ("near", "depth_std", "depth error, near end", "least"),
    ("at", "depth_std", "depth error, at the distance", "least"),
    ("far", "depth_std", "depth error, far end", "least"),
    ("at", "depth_step", "depth step of one pixel", "least"),
    ("at", "overlap_share", "overlap share", "most"),
    ("at", "world_per_pixel", "width of a pixel", "least"),
)
"""Place, key, name, and which value is the better one."""


@dataclass(frozen=True, slots=True, eq=False)
class Pinned:
    """One rig that is compared."""

    slot: str
    """The word that holds it."""
    name: str
    """What it is called."""
    state: State
    """Its own words."""
    found: RigNumbers
    """Its numbers."""
    curve: DepthCurve | None
    """Its depth error over the working range; None where there is none."""


@dataclass(frozen=True, slots=True)
class ComparedQuantity:
    """One quantity of all rigs."""

    name: str
    """What it is."""
    unit: str
    """Its unit."""
    cells: tuple[str, ...]
    """One value a rig, as people see it."""
    differs: bool
    """Whether the rigs differ in it, as they are shown."""
    best: int | None
    """Which rig has the better one; None for none, or several."""


def pinned(state: State) -> tuple[Pinned, ...]:
    """The rigs that are compared, in the order of their slots."""
    found: list[Pinned] = []
    for slot in PINS:
        if state[slot]:
            own, _ = read_state(dict(parse_qsl(state[slot])))
            shared = {name: state[name] for name in ("range", "require", "z") if state[name]}
            numbers = numbers_of(State({**own.words, **shared}))
            found.append(Pinned(slot, _name(own, [one.name for one in found]), own, numbers, _curve(numbers)))
    return tuple(found)


def pin(state: State) -> State:
    """The same with the rig that is shown among those compared.

    Raises:
        InvalidRange: there is no rig, it is there already, or no place is left.
    """
    words = {word.name: state[word.name] for word in _TAKEN if state[word.name]}
    if OF_RIG.isdisjoint(words):
        raise InvalidRange("no rig to pin: make one under Rig, or choose one by name")
    text = State(words).query()
    if text in [state[slot] for slot in PINS]:
        raise InvalidRange("this rig is compared already: change it, then pin it again")
    free = next((slot for slot in PINS if not state[slot]), None)
    if free is None:
        raise InvalidRange(f"{len(PINS)} rigs are compared already: remove one first")
    return state.with_words(**{free: text})


def pin_preset(state: State, name: str) -> State:
    """The same with a preset among those compared; raises as `pin`."""
    with_it = pin(State({**{slot: state[slot] for slot in PINS if state[slot]}, "preset": name}))
    return state.with_words(**{slot: with_it[slot] for slot in PINS})


def table(rigs: Sequence[Pinned]) -> list[ComparedQuantity]:
    """Every quantity of all rigs, those they share as well."""
    rows = [_given("baseline", "mm", [_baseline(one.found) for one in rigs])]
    rows.append(_given("image", "px", [_size(one.found) for one in rigs]))
    ends = [one.found.distances for one in rigs if one.found.distances is not None]
    apart = any(item.at_mm != item.far_mm for item in ends)
    for place, key, name, better_is in _QUANTITIES:
        if (place, key) == ("at", "depth_std") and not apart:
            continue  # it is the far end
        facts = [_fact(one.found, place, key) for one in rigs]
        cells = tuple(MISSING if fact is None else fact.shown for fact in facts)
        unit = next((fact.unit for fact in facts if fact is not None), "")
        rows.append(ComparedQuantity(name, unit, cells, len(set(cells)) > 1, _best(facts, cells, better_is)))
    return rows


def sentence(rigs: Sequence[Pinned]) -> str:
    """Which rig is the more accurate where; empty where noises differ, or for one rig."""
    known = [one for one in rigs if one.found.shown is not None and one.found.places]
    noises = {one.found.shown.noise.std_px for one in known if one.found.shown is not None}
    if len(noises) != 1 or len(known) < 2:
        return ""
    rated = []
    for place in ("near", "at", "far"):
        for one in known:
            facts = one.found.places[place]
            rated.append(Rated(one.name, float(facts["z"].value), float(facts["depth_std"].value)))
    named = {one.name: (one.state["preset"] or None, one.found.shown.rig) for one in known if one.found.shown}
    return better(list(dict.fromkeys(rated)), noises.pop(), modes_of(named))


def faults(rigs: Sequence[Pinned]) -> list[str]:
    """What is wrong with rigs that have no numbers."""
    return [f"{one.name}: {plain(one.found.fault)}" for one in rigs if one.found.fault]


def _name(own: State, taken: Sequence[str]) -> str:
    base = own["preset"] or ("loaded rig" if own["rig"] else "own rig")
    said = (word for word in _TAKEN if own[word.name] and word.name not in ("preset", "rig"))
    changed = [f"{word.option} {own[word.name]}" for word in said]
    name = ", ".join([base, *changed])
    return name if name not in taken else f"{name} ({len(taken) + 1})"


def _curve(found: RigNumbers) -> DepthCurve | None:
    if found.shown is None or found.distances is None or found.fault:
        return None
    return depth_curve(found.shown.rig, found.shown.noise, found.distances.near_m, found.distances.far_m)


def _fact(found: RigNumbers, place: str, key: str) -> Fact | None:
    return found.of_rig.get(key) if not place else found.places.get(place, {}).get(key)


def _given(name: str, unit: str, cells: Sequence[str]) -> ComparedQuantity:
    return ComparedQuantity(name, unit, tuple(cells), len(set(cells)) > 1, None)


def _baseline(found: RigNumbers) -> str:
    return MISSING if found.shown is None else f"{found.shown.rig.baseline_m * 1e3:.5g}"


def _size(found: RigNumbers) -> str:
    return MISSING if found.shown is None else f"{found.shown.rig.left.width}x{found.shown.rig.left.height}"


def _best(facts: Sequence[Fact | None], cells: Sequence[str], better_is: str) -> int | None:
    """The one rig with the better value; None where it is shown like another's."""
    known = {
        index: float(fact.value)
        for index, fact in enumerate(facts)
        if fact is not None and not isinstance(fact.value, str) and not math.isnan(fact.value)
    }
    if not better_is or len(known) < 2:
        return None
    pick = min if better_is == "least" else max
    best = pick(known, key=lambda index: known[index])
    return best if cells.count(cells[best]) == 1 else None
