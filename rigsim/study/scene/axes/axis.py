"""What an axis of a sweep is.

An axis is one file here and one line of `rigsim.study.scene.axes.registry`: the command line's option, the
columns, the plots, the JSON document and the docs follow from it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rigsim.rig.quantity import QuantityKind
from rigsim.study.scene.column import Column

if TYPE_CHECKING:
    from rigsim.rig.noise import PixelNoise
    from rigsim.study.scene.axes.configuration import Configuration
    from rigsim.study.scene.recipe import Recipe


@dataclass(frozen=True, slots=True, eq=False)
class Axis:
    """One thing that a sweep can vary."""

    name: str
    """As its option on the command line is called, without the dashes."""
    columns: tuple[Column, ...]
    """Its columns; the first one stands for it."""
    word: str
    """What sentences call it: ``120 mm of baseline``."""
    read: Callable[[Configuration], tuple[Any, ...]]
    """The values in its columns for a configuration."""
    help: str
    """Of its option where several values are taken."""
    help_one: str = ""
    """Of its option where one rig is described."""
    metavar: str = ""
    """What stands for its value where one rig is described."""
    kind: QuantityKind | None = None
    """How its values are typed; None where they are no plain numbers, and the command line reads them."""
    default: str | None = None
    """What is typed unless said; None for what the rig has."""
    scale: float = 1.0
    """By which typed values are multiplied."""
    of_rig: Callable[[Recipe, Any], Recipe] | None = None
    """How a value changes the rig."""
    of_noise: Callable[[PixelNoise, float], PixelNoise] | None = None
    """How a value changes the noise."""
    instead_of: str = ""
    """Name of another axis that this one says in other words: only one of the two may be given, and tables
    and pictures follow this one where it is."""
    loop: int = 0
    """Where its values stand when several axes are varied: lower ones change more slowly."""
    field: str = ""
    """Its own field of `rigsim.study.scene.plan.RigGrid`; "" for an entry of `RigGrid.more`."""
