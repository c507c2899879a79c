"""The distances that a page is about: near, far, and the one that is asked for."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rigsim.api.kit.asked import DepthError
from rigsim.studio.state import State
from rigsim.typed import quantity
from rigsim.typed.design import depth_error, working_range

UNSAID = math.nan
"""In place of a distance that a requirement does not say."""


@dataclass(frozen=True, slots=True)
class Distances:
    """Where a rig is to work."""

    near_mm: float
    """Near end of the working range, mm."""
    far_mm: float
    """Far end, mm."""
    at_mm: float
    """The distance looked at: the one typed, else the requirement's, else the far end, mm."""
    required: DepthError | None
    """The depth error that is asked for; None for none."""

    @property
    def words(self) -> str:
        """Near, looked at and far as an option takes them."""
        each = dict.fromkeys((self.near_mm, self.at_mm, self.far_mm))
        return ",".join(f"{mm!r}mm".replace(".0mm", "mm") for mm in each)

    @property
    def far_m(self) -> float:
        """Far end, m."""
        return self.far_mm / 1e3

    @property
    def near_m(self) -> float:
        """Near end, m."""
        return self.near_mm / 1e3


def distances_of(state: State) -> Distances:
    """What the words `range`, `require` and `z` say.

    Raises:
        RigsimError: one cannot be read.
    """
    near_mm, far_mm = working_range(state["range"])
    required = depth_error(state["require"], UNSAID) if state["require"] else None
    at_mm = far_mm
    if required is not None and required.at_m is not None and not math.isnan(required.at_m):
        at_mm = required.at_m * 1e3
    if state["z"]:
        at_mm = quantity.distances(state["z"])[0]
    return Distances(near_mm, far_mm, at_mm, required)
