"""A rig that was built a little off, while a slider moves: depth errors, rows, and where in the image."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType
from typing import Any

from rigsim.api.calc.fact import Fact
from rigsim.errors import InvalidRange, RigsimError
from rigsim.present.kit.format import plain
from rigsim.rig.quantity import LENGTHS, PIXELS, TURNS, QuantityKind
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.studio.logic import command
from rigsim.studio.logic.faults import plain as as_label
from rigsim.studio.logic.rig import Shown, shown_rig
from rigsim.studio.state import State
from rigsim.studio.words import OF_RIG
from rigsim.study.tolerance.inputs import QUANTITIES, UNITS, BuildRequirement
from rigsim.study.tolerance.one_rig import Bench, BuiltAt, OneBuiltRig, bench
from rigsim.typed import quantity
from rigsim.typed.tolerances import row_error, tolerance_range, tolerance_requirement

DEFAULTS = State({"preset": "boards", "range": "0.5:2m", "depth_error": "20mm@2m", "off_yaw": "0.02deg"})
"""What the page begins with."""
RIGS, POINTS = 400, 200
"""Rigs that are built, and points that each is judged by."""
CLASSES = ("machined", "printed", "calibrated")
"""Who builds rigs; the first where nothing is said."""


@dataclass(frozen=True, slots=True)
class Deviation:
    """One thing that the built rig may be off by."""

    word: str
    """Its word."""
    key: str
    """Its quantity."""
    kind: QuantityKind
    """How it is typed."""
    reach: float
    """Where its slider ends, in its unit, either way."""
    meaning: str
    """What a positive one is."""


def _kind(name: str, unit: str, factors: Mapping[str, Any]) -> QuantityKind:
    return QuantityKind(f"built {name}", unit, factors)


DEVIATIONS = (
    Deviation("off_yaw", "yaw_deg", _kind("yaw", "deg", TURNS), 0.6, "right camera turned to the right"),
    Deviation("off_pitch", "pitch_deg", _kind("pitch", "deg", TURNS), 0.6, "right camera turned up"),
    Deviation("off_roll", "roll_deg", _kind("roll", "deg", TURNS), 0.6, "right camera turned clockwise"),
    Deviation("off_baseline", "baseline_mm", _kind("baseline", "mm", LENGTHS), 2.0, "cameras farther apart"),
    Deviation("off_focal", "right_focal_px", _kind("focal", "px", PIXELS), 20.0, "right lens longer"),
    Deviation(
        "off_cx", "right_cx_px", _kind("principal", "px", PIXELS), 20.0, "right image's middle to the right"
    ),
    Deviation(
        "off_cy", "right_cy_px", _kind("principal-v", "px", PIXELS), 20.0, "right image's middle lower"
    ),
)
"""What the sliders move, in the units of `rigsim tolerance`."""


@dataclass(frozen=True, slots=True, eq=False)
class BuiltFound:
    """The answer, or why there is none."""

    shown: Shown | None
    """The rig that is assumed; None where its words cannot be read."""
    required: BuildRequirement | None
    """What it is held to."""
    answer: OneBuiltRig | None
    """The built rig; None where there is none."""
    off: Mapping[str, float]
    """What it is off by, by quantity, in its unit."""
    fault: str
    """Why there is no answer, and the way out; else empty."""
    remarks: tuple[Remark, ...] = ()
    """What is odd."""

    @property
    def facts(self) -> Mapping[str, Fact]:
        """The large numbers, by key."""
        if self.answer is None or self.required is None:
            return {}
        at, judged = f"at {plain(self.required.depth_m)} m", self.answer.judged
        said = (
            (
                "build",
                "depth error of the build",
                judged.rms_mm,
                "mm",
                f"root mean square over the image {at}",
            ),
            (
                "whole",
                "with pixel noise",
                judged.whole_mm,
                "mm",
                f"root mean square over image and noise {at}",
            ),
            (
                "common",
                "shared by the image",
                judged.common_mm,
                "mm",
                f"mean depth error {at}; positive reads too far",
            ),
            (
                "row",
                "rows apart",
                self.rows.row_px,
                "px",
                "root mean square over the image, the worst distance",
            ),
            ("row_largest", "at most", self.rows.row_largest_px, "px", "where they are farthest apart"),
        )
        # three digits: a first glance at what a slider does
        return {
            key: Fact(key, name, value, unit, meaning, abs(value)) for key, name, value, unit, meaning in said
        }

    @property
    def rows(self) -> BuiltAt:
        """The distance at which rows are farthest apart."""
        assert self.answer is not None
        return max(self.answer.at, key=lambda item: item.row_px)

    @property
    def verdict(self) -> tuple[str, str]:
        """Kind, as a badge's, and words: whether this rig meets what is asked for."""
        if self.answer is None or self.required is None:
            return "untold", ""
        asked = f"{plain(self.required.error_m * 1e3)} mm at {plain(self.required.depth_m)} m"
        if self.required.row_px is not None:
            asked += f", rows within {plain(self.required.row_px)} px"
        return ("agrees", f"meets {asked}") if self.answer.is_good else ("flagged", f"misses {asked}")


def begin(state: State) -> State:
    """What the page shows for an address: a preset where it says no rig, and something to meet."""
    words = dict(state.words)
    of_rig = {"rig", "preset", "baseline", "focal", "hfov"}
    for name, text in DEFAULTS.words.items():
        if name == "preset" and of_rig & set(words):
            continue
        if name == "off_yaw" and any(deviation.word in words for deviation in DEVIATIONS):
            continue
        if name in ("range", "depth_error") and {"range", "depth_error"} & set(state.words):
            continue
        words.setdefault(name, text)
    return State(words)


def as_drawn(state: State) -> State:
    """The built rig without any deviation."""
    return state.with_words(**{deviation.word: "" for deviation in DEVIATIONS})


def off(state: State) -> dict[str, float]:
    """What the built rig is off by, by quantity.

    Raises:
        InvalidRange: a word cannot be read.
    """
    return {
        one.key: quantity.value(state[one.word], one.kind) if state[one.word] else 0.0 for one in DEVIATIONS
    }


def required(state: State) -> tuple[BuildRequirement, tuple[float, float]]:
    """What a rig is held to, and the working range, m.

    Raises:
        InvalidRange: a word cannot be read.
    """
    near_m, far_m = tolerance_range(state["range"] or "1:5m")
    asked = tolerance_requirement(one_error(state) or "1%")
    at_m = asked.get("at_m", far_m)
    error_m = (
        asked["depth_error_mm"] / 1e3 if "depth_error_mm" in asked else asked["depth_error_pct"] / 100 * at_m
    )
    return BuildRequirement(error_m, at_m, row_px=row_error(state["max_row_error"] or None)), (near_m, far_m)


def one_error(state: State) -> str:
    """The first of the depth errors that are typed: a built rig is held to one."""
    return next(iter(command.parts(state["depth_error"])), "")


def find(state: State) -> BuiltFound:
    """What the words say of one built rig."""
    shown, asked, deviations = None, None, dict[str, float]()
    try:
        shown = assumed(state, "an error map")
        asked, range_m = required(state)
        deviations = off(state)
        answer = _bench(shown.rig, asked, range_m, shown.noise.std_px).read(deviations)
        return BuiltFound(shown, asked, answer, deviations, "", (*shown.remarks, *_remarks(state)))
    except RigsimError as error:
        return BuiltFound(shown, asked, None, deviations, as_label(str(error)))


def assumed(state: State, size_for: str) -> Shown:
    """The rig as drawn; as on the command line, its principal point is its own.

    Raises:
        RigsimError: something is missing, or cannot be read.
    """
    return shown_rig(state.with_words(principal=""), size_for=size_for)


@lru_cache(32)
def _bench(rig: StereoRig, asked: BuildRequirement, range_m: tuple[float, float], noise_px: float) -> Bench:
    """The points before a rig, which stay where they are while it is built more or less off."""
    near_m, far_m = range_m
    if not near_m < far_m:
        raise InvalidRange(f"range {near_m:g}:{far_m:g} m: must be near < far")
    return bench(rig, asked, (near_m, (near_m + far_m) / 2, far_m), noise_px)


def _remarks(state: State) -> tuple[Remark, ...]:
    errors = command.parts(state["depth_error"])
    if len(errors) < 2:
        return ()
    text = f"depth errors {', '.join(errors)}: a built rig is held to the first here, {errors[0]}"
    return (Remark("one_error", text),)


def alone(found: BuiltFound) -> list[Fact]:
    """What each deviation does alone, as facts."""
    if found.answer is None:
        return []
    return [
        Fact(
            one.key, QUANTITIES[one.key], found.answer.alone_mm[one.key], "mm", _says(one, found.off[one.key])
        )
        for one in DEVIATIONS
        if found.off[one.key]
    ]


def _says(one: Deviation, value: float) -> str:
    return f"off by {plain(value)} {UNITS[one.key]}"


def command_line(state: State) -> str:
    """``rigsim tolerance`` that gives the ranking and the yields."""
    names = (*(OF_RIG - {"principal"}), "noise", "range", "depth_error", "class", "max_row_error")
    asked = state.with_words(depth_error=one_error(state))
    return f"{command.command(('tolerance',), asked, names)} --rigs={RIGS} --points={POINTS}"


UNIT_OF: Mapping[str, str] = MappingProxyType({one.word: UNITS[one.key] for one in DEVIATIONS})
"""Units of the sliders."""
