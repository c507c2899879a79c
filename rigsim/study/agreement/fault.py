"""What is off where witnesses differ."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Fault:
    """What is off."""

    name: str
    """Stable short name, as ``yaw``; ``unknown`` when no single known mistake explains the errors."""
    says: str
    """One sentence without a full stop."""
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


UNKNOWN = Fault("unknown", "no single known mistake explains it")
"""What is said when nothing does."""
