"""One number of an answer, and how people see it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rigsim.rig.noise import PixelNoise
    from rigsim.rig.remark import Remark


@dataclass(frozen=True, slots=True)
class Fact:
    """One number of an answer."""

    key: str
    """Name for machines."""
    name: str
    """Name for people."""
    value: float | str
    """The number, or a word; infinite where there is no bound, NaN where there is no answer."""
    unit: str
    """Its unit; empty for a ratio."""
    meaning: str
    """What it says, in a few words."""
    error: float = math.nan
    """How far it may be off, in its unit: people get as many decimals as that has three digits."""

    @property
    def shown(self) -> str:
        """The value as people see it: 5 significant digits, or as many as the error leaves."""
        from rigsim.present.kit.format import fixed, number

        value = self.value
        if isinstance(value, str):
            return value
        if math.isinf(value):
            return "infinite"
        if abs(value) >= 1e9:
            return f"{value:.4e}"
        if math.isfinite(self.error) and self.error > 0:
            return fixed(value, min(max(2 - math.floor(math.log10(self.error)), 0), 9))
        return number(value, 5)


@dataclass(frozen=True, slots=True)
class Assumed:
    """What is taken for granted of the pixels."""

    noise: PixelNoise
    """Noise of every pixel coordinate."""
    sized: bool = True
    """Whether the images have an edge that is known."""
    from_axis: bool = False
    """Whether pixels count from the optical axis."""
    disparity_error_px: float | None = None
    """Disparity error of the bounds, px; None for the noise's."""
    odd: tuple[Remark, ...] = ()
    """What is odd already."""


@dataclass(frozen=True, slots=True)
class DepthAnswer:
    """Facts, and what is odd about what was asked."""

    facts: tuple[Fact, ...]
    remarks: tuple[Remark, ...]


def values(facts: Sequence[Fact]) -> dict[str, float | str]:
    """The numbers and words by key."""
    return {fact.key: fact.value for fact in facts}


def if_seen(seen: bool, value: float) -> float:
    """A number that there is where both cameras see the point."""
    return value if seen else math.nan


def whose(sized: bool, says: str) -> str:
    """What "seen by" means, where images have an edge."""
    return says if sized else "no --resolution: images without an edge"
