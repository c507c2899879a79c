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

    @property
    def option(self) -> str:
        """Its name in the address, and as an option."""
        return self.name.replace("_", "-")


_RIG = ("preset", *(axis.name for axis in registry.OF_RIG), "sensor_width", "pixel_pitch", "noise")

ALL = (
    Word("rig", most_chars=_MOST_RIG_CHARS),
    *(Word(name) for name in _RIG),
    Word("principal"),
    *(Word(name, ("point",)) for name in ("left", "right")),
    Word("scene"),
    Word("z", ("rig", "compare")),
    Word("range", ("rig", "compare")),
    Word("require", ("rig", "compare")),
)
"""Every word; a new one is a line here."""

BY_OPTION: Mapping[str, Word] = MappingProxyType({word.option: word for word in ALL})
"""The same by their names in the address."""
OF_RIG = frozenset(("rig", *_RIG, "principal")) - {"noise"}
"""Those that describe the rig."""
