"""The words that a page's address holds, named like the options of the command line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from rigsim.study.scene.axes import registry

MOST_CHARS = 200
"""No word that people type is longer; a rig's or pinned rigs' text may be."""
_MOST_RIG_CHARS = 20_000


@dataclass(frozen=True, slots=True)
class Word:
    """One word of the state."""

    name: str
    """Its name in Python; in the address and on the command line with dashes."""
    pages: tuple[str, ...] = ()
    """Pages whose answer it is part of; those of every page for none."""
    most_chars: int = MOST_CHARS
    """Longer values are not taken."""
    flag: str = ""
    """Its name as an option, where that is not its name in the address."""
    several: bool = False
    """Whether it holds several values, with commas between, each of which is an option of its own."""

    @property
    def option(self) -> str:
        """Its name in the address, and as an option unless `flag` says otherwise."""
        return self.name.replace("_", "-")


_RIG = ("preset", *(axis.name for axis in registry.OF_RIG), "sensor_width", "pixel_pitch", "noise")

TRIED = ("resolution", "pixel_pitch", "sensor_width")
"""Words of a rig that a design has of its own, as ``try_resolution``."""
_DESIGN = (
    "fov",
    "vfov",
    "cover",
    "max_baseline",
    "min_baseline",
    "body_width",
    "max_disparity",
    "max_pixels",
    "nearest_focus",
    "build_share",
    "sensor",
    "lens",
    "prefer",
)
OFF = ("off_yaw", "off_pitch", "off_roll", "off_baseline", "off_focal", "off_cx", "off_cy")
"""What the built rig is off by."""
PINS = ("pin1", "pin2", "pin3", "pin4")
"""Rigs that are compared, each the words of a rig as an address holds them."""

ALL = (
    Word("rig", most_chars=_MOST_RIG_CHARS),
    *(Word(name) for name in _RIG),
    Word("principal"),
    *(Word(name, ("point",)) for name in ("left", "right")),
    Word("scene"),
    Word("z", ("rig", "compare")),
    *(Word(name, ("design", "tolerance")) for name in ("class", "max_row_error")),
    Word("range", ("rig", "design", "tolerance", "compare")),
    Word("depth_error", ("design", "tolerance"), several=True),
    *(Word(name, ("design",)) for name in _DESIGN),
    Word("min_overlap", ("design",), several=True),
    # a rig has one size, and a design may try several: each page keeps its own
    *(Word(f"try_{name}", ("design",), flag=name.replace("_", "-")) for name in TRIED),
    *(Word(name, ("design",)) for name in ("region", "sort")),
    *(Word(name, ("tolerance",)) for name in OFF),
    Word("require", ("rig", "compare")),
    *(Word(name, ("compare",), most_chars=_MOST_RIG_CHARS) for name in PINS),
)
"""Every word; a new one is a line here."""

BY_OPTION: Mapping[str, Word] = MappingProxyType({word.option: word for word in ALL})
"""The same by their names in the address."""
OF_RIG = frozenset(("rig", *_RIG, "principal")) - {"noise"}
"""Those that describe the rig."""
