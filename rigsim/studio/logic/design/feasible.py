"""From requirements to rigs: what is feasible while one types, and the rig to take when the hand rests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rigsim.api.kit.cameras import cameras_tried
from rigsim.api.kit.requirements import DesignOptions, specified
from rigsim.digits import short
from rigsim.errors import InvalidRange, RigsimError
from rigsim.rig.arrays import Array
from rigsim.studio.logic import command
from rigsim.studio.logic.faults import plain
from rigsim.studio.state import State
from rigsim.studio.words import OF_RIG, TRIED
from rigsim.study.design import words as says
from rigsim.study.design.region import Region, region
from rigsim.study.design.solve import PREFERENCES, Candidate, Design, Specification, solve, why_not
from rigsim.theory.inverse import Camera, Relaxation, baseline_interval, relaxations
from rigsim.typed.design import design_arguments

DEFAULTS = State({"range": "0.5:3m", "depth_error": "10mm@3m", "fov": "60deg"})
"""What the page begins with, and goes back to."""
OPTIONS = (
    "range",
    "depth_error",
    "fov",
    "vfov",
    "cover",
    "noise",
    "max_baseline",
    "min_baseline",
    "body_width",
    "max_disparity",
    "min_overlap",
    "max_pixels",
    "max_row_error",
    "build_share",
    "nearest_focus",
    "sensor",
    "lens",
    "try_resolution",
    "try_pixel_pitch",
    "try_sensor_width",
    "prefer",
    "class",
)
"""Words of the page that are options of `rigsim design`."""
_LISTS = ("depth_error", "min_overlap")
_RENAMED = {"range": "depth_range", "class": "class_name"} | {f"try_{name}": name for name in TRIED}
_FOCALS = 49
_WIDER = 1.25
_LEAST_SPREAD = 2.0
_ROOM = 1.5

Size = tuple[int, int]
"""Width and height of an image, px."""


@dataclass(frozen=True, slots=True)
class WayOut:
    """One requirement that could give, and the page with it relaxed."""

    text: str
    """What would do: ``disparity search at 0.5 m from 128 px to 637 px``."""
    state: State | None
    """The words with it; None where they have to be typed."""


@dataclass(frozen=True, slots=True, eq=False)
class Feasible:
    """What the formulas say at once."""

    specification: Specification | None
    """What is asked for; None where its words cannot be read."""
    design: Design | None
    """Every camera and the rigs that would do, by formula; None where none would."""
    region: Region | None
    """Baselines over focal lengths for one image size."""
    sizes: tuple[Size, ...]
    """Image sizes that are tried."""
    fault: str
    """Why there is no answer; else empty."""
    ways: tuple[WayOut, ...]
    """What to relax where nothing is feasible."""

    @property
    def counted(self) -> str:
        """How many cameras qualify, in words; empty where none does."""
        if self.design is None:
            return ""
        return f"{len(self.design.feasible)} of {len(self.design.intervals)} cameras qualify."


def arguments(state: State) -> dict[str, Any]:
    """What `rigsim.design` is asked for.

    Raises:
        RigsimError: a word is missing, or cannot be read.
    """
    for word, example in (("range", "0.5:3m"), ("depth_error", "10mm@3m or 1%")):
        if not state[word]:
            raise InvalidRange(f"{word.replace('_', ' ')}: is needed, as in {example}")
    typed: dict[str, Any] = {}
    for name in OPTIONS:
        if state[name]:
            typed[_RENAMED.get(name, name)] = command.parts(state[name]) if name in _LISTS else state[name]
    return design_arguments(typed)


def begin(state: State) -> State:
    """What the page shows for an address: the example where it asks for nothing.

    In an address without a rig, an image size and a pixel's are those to try, as on the command line.
    """
    words = dict(state.words)
    if not {"rig", "preset", "baseline", "focal", "hfov"} & set(words):
        for name in TRIED:
            if name in words:
                words.setdefault(f"try_{name}", words.pop(name))
    if "range" not in words and "depth_error" not in words:
        words = {**DEFAULTS.words, **words}
    return State(words)


def reset(state: State) -> State:
    """The example, with what other pages show left as it is."""
    own = {*OPTIONS, "region", "sort"} - {"noise"}
    return State({name: text for name, text in state.words.items() if name not in own}).with_words(
        **DEFAULTS.words
    )


def find(state: State, like: Size | None = None) -> Feasible:
    """What the formulas say.

    Args:
        state: the words.
        like: the image size whose region is shown where no word says one and it is tried.
    """
    specification, sizes = None, tuple[Size, ...]()
    try:
        options = DesignOptions(**arguments(state), proof=False)
        specification, cameras = specified(options), cameras_tried(options)
        if options.prefer not in PREFERENCES:
            raise InvalidRange(f"preference {options.prefer!r}: choose one of {', '.join(PREFERENCES)}")
        sizes = tuple(dict.fromkeys((camera.width_px, camera.height_px) for camera in cameras))
        asked, noise_px = specification.requirements, specification.noise_px
        intervals = [baseline_interval(camera, asked, noise_px) for camera in cameras]
        if not any(interval.is_feasible for interval in intervals):
            ways = relaxations(cameras, asked, noise_px)
            shown = _camera(state, sizes, cameras, like, ways[0].camera if ways else None)
            return Feasible(
                specification,
                None,
                _region(specification, shown, cameras),
                sizes,
                signs(plain(why_not(specification, intervals, ways))),
                tuple(_way(state, way, noise_px) for way in ways[:3]),
            )
        # built rigs are counted when the hand rests: until then the order of what they cost
        found = solve(specification, cameras, "cheapest" if options.prefer == "buildable" else options.prefer)
        shown = _camera(state, sizes, cameras, like, found.candidates[0].camera)
        return Feasible(specification, found, _region(specification, shown, cameras), sizes, "", ())
    except RigsimError as error:
        return Feasible(specification, None, None, sizes, plain(str(error)), ())


def signs(text: str) -> str:
    """With one sign for two, as people write it."""
    return text.replace("<=", "≤").replace(">=", "≥")


def size_text(size: Size) -> str:
    """A size as it is typed."""
    return f"{size[0]}x{size[1]}"


def picked(state: State, focal_px: float, baseline_mm: float, size: Size) -> State:
    """The words with a rig picked here: baseline, focal length and image size, and nothing else of one."""
    kept = {name: text for name, text in state.words.items() if name not in OF_RIG}
    return State(
        {
            **kept,
            "baseline": f"{baseline_mm:.6g}mm",
            "focal": f"{focal_px:.6g}px",
            "resolution": size_text(size),
        }
    )


def broken(found: Feasible, focal_px: float, baseline_mm: float) -> list[str]:
    """The requirements that a rig picked in the region does not meet, in words."""
    spec, shown = found.specification, found.region
    if spec is None or shown is None:
        return []
    camera = Camera(shown.camera.width_px, shown.camera.height_px, focal_px, body_m=shown.camera.body_m)
    baseline_m = baseline_mm / 1e3
    return [
        signs(says.whole(asked))
        for asked in spec.asked_of(camera)
        if not asked.is_met(asked.achieved(camera, baseline_m, spec.disparity_std_px))
    ]


def of_size(candidates: Sequence[Candidate], camera: Camera) -> list[Candidate]:
    """Those of the camera's image size."""
    size = camera.width_px, camera.height_px
    return [one for one in candidates if (one.camera.width_px, one.camera.height_px) == size]


def command_line(state: State) -> str:
    """``rigsim design`` that gives the same numbers."""
    return f"{command.command(('design',), state, OPTIONS)} --no-proof"


def _camera(
    state: State,
    sizes: Sequence[Size],
    cameras: Sequence[Camera],
    like: Size | None,
    otherwise: Camera | None,
) -> Camera:
    """A camera of the image size that is shown."""
    said = next((size for size in sizes if size_text(size) == state["region"]), None)
    wanted = said or (like if like in sizes else None)
    if wanted is None:
        return otherwise or cameras[0]
    return next(camera for camera in cameras if (camera.width_px, camera.height_px) == wanted)


def _region(specification: Specification, shown: Camera, cameras: Sequence[Camera]) -> Region:
    same = [one for one in cameras if (one.width_px, one.height_px) == (shown.width_px, shown.height_px)]
    return region(specification, shown, _focals_px(same), _span_m(specification, same))


def _focals_px(cameras: Sequence[Camera]) -> Array:
    """Focal lengths to look at: those of the cameras, and some room on either side."""
    own = [camera.focal_px for camera in cameras]
    low, high = min(own), max(own)
    room = max(_WIDER, _LEAST_SPREAD / (high / low) ** 0.5)
    # a region often ends at a lens's own focal length
    return np.union1d(np.geomspace(low / room, high * room, _FOCALS), own)


def _span_m(specification: Specification, cameras: Sequence[Camera]) -> tuple[float, float]:
    """Baselines to look at: about what the cameras allow; where they allow none, about their limits."""
    intervals = [
        baseline_interval(camera, specification.requirements, specification.noise_px) for camera in cameras
    ]
    chosen = [interval for interval in intervals if interval.is_feasible] or intervals
    ends = np.array([[one.lower.baseline_m, one.upper.baseline_m] for one in chosen]).ravel()
    ends = ends[np.isfinite(ends) & (ends > 0)]
    if not ends.size:
        return 0.01, 1.0
    return says.rounded(float(ends.min()) / _ROOM, up=False, digits=1), says.rounded(
        float(ends.max()) * _ROOM, up=True, digits=1
    )


_AS_TYPED = {
    "max_baseline": ("max_baseline", 1e3, "mm"),
    "min_baseline": ("min_baseline", 1e3, "mm"),
    "max_disparity": ("max_disparity", 1.0, "px"),
    "pixels": ("max_pixels", 1e-6, "MP"),
    "fov": ("fov", float(np.degrees(1)), "deg"),
    "vfov": ("vfov", float(np.degrees(1)), "deg"),
}


def _way(state: State, way: Relaxation, noise_px: float) -> WayOut:
    """A way out, and the words with it where one word says it."""
    text, asked = says.relaxation(way, noise_px), way.requirement
    if asked is None:
        noise = says.rounded(way.needed, up=False)
        return WayOut(text, state.with_words(noise=f"{short(noise, 4)}px"))
    if asked.kind == "depth_error" and len(command.parts(state["depth_error"])) == 1:
        needed = short(says.rounded(way.needed * 1e3, up=True), 6)
        p95 = "p95:" if asked.is_p95 else ""
        return WayOut(text, state.with_words(depth_error=f"{p95}{needed}mm@{asked.depth_m:g}m"))
    word, scale, unit = _AS_TYPED.get(asked.kind, ("", 1.0, ""))
    if not state[word]:
        return WayOut(text, None)
    needed = short(says.rounded(way.needed * scale, up=not asked.at_least), 6)
    return WayOut(text, state.with_words(**{word: f"{needed}{unit}"}))
