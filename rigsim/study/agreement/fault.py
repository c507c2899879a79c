"""What is off where witnesses differ."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rigsim.study.saying import Saying, saying


@dataclass(frozen=True, slots=True)
class Fault:
    """What is off."""

    name: str
    """Stable short name, as ``yaw``; ``unknown`` when no single known mistake explains the errors."""
    said: Saying
    """The same with what stands in its sentence; `rigsim.present.kit.mistakes.faults` has the words."""
    amount: float = math.nan
    """How much, in `unit`: truth minus what the triangulation takes; NaN where it has no amount."""
    amount_se: float = math.nan
    """Standard error of the amount."""
    unit: str = ""
    """Unit of the amount."""
    explained: float = math.nan
    """Share of the weighted mean square error that it explains; NaN where that is not what tells."""
    also: tuple[str, ...] = ()
    """Short names of the mistakes that have the same effect here."""


UNKNOWN = Fault("unknown", saying("none-known"))
"""What is said when nothing does."""
