"""Whether two witnesses agree: a value, from which tables, pages and programs take what they show."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, TypeAlias, cast, get_args

Kind: TypeAlias = Literal["agrees", "flagged", "untold"]
Witness: TypeAlias = Literal["simulated", "measured", ""]

_ORDER: tuple[Kind, ...] = ("flagged", "untold", "agrees")


@dataclass(frozen=True, slots=True)
class Agreement:
    """What one comparison came to."""

    kind: Kind
    """agrees, flagged (they differ), or untold (there is not enough to tell)."""
    witness: Witness = ""
    """Whom it speaks of: the simulation, the measurement, or neither alone."""
    quantity: str = ""
    """What differs: depth spread, position spread, mean depth, ..."""
    ratio: float = math.nan
    """Found over expected, where the quantity has such a ratio."""
    why: str = ""
    """The reason in words; empty when they agree."""
    named: str = ""
    """What is off, when it could be named."""

    @property
    def text(self) -> str:
        """What the tables write: ``agrees``, ``flagged: ...`` or ``untold: ...``."""
        if self.kind == "agrees":
            return "agrees"
        return f"{self.kind}: {self.why}" + (f"; {self.named}" if self.named else "")


AGREES = Agreement("agrees")
"""Nothing differs."""


def kind_of(text: str) -> Kind:
    """The kind of an agreement as the tables write it: its first word.

    Raises:
        ValueError: it is none.
    """
    word = text.partition(":")[0]
    if word not in get_args(Kind):
        raise ValueError(f"agreement {text!r}: must begin with agrees, flagged or untold")
    return cast("Kind", word)


def reason_of(text: str) -> str:
    """The reason of an agreement as the tables write it, without its kind; empty when it agrees."""
    return text.partition(": ")[2]


def worst(found: Iterable[Agreement]) -> Agreement:
    """The one that counts of several: flagged before untold before agrees, the first of its kind."""
    return min(found, key=lambda one: _ORDER.index(one.kind), default=AGREES)
