"""Scenes that a page may show: the bundled ones, and the one the command line named."""

from __future__ import annotations

from pathlib import Path

from rigsim.rig.presets import PRESETS
from rigsim.sim.scenes.library import names
from rigsim.studio.state import State


def choices(own: str) -> dict[str, str]:
    """What may be chosen, with what people read.

    Args:
        own: the scene that the command line named, a name or a path; empty for none.
    """
    found = {name: name for name in names()}
    if own and own not in found:
        found[own] = Path(own).name
    return found


def chosen(state: State, own: str) -> str:
    """The scene shown: the one typed where it may be, else that of the preset, else the boards.

    A path is taken from nobody but the command line.
    """
    allowed = choices(own)
    if state["scene"] in allowed:
        return state["scene"]
    if own:
        return own
    return state["preset"] if state["preset"] in PRESETS and state["preset"] in allowed else "boards"
