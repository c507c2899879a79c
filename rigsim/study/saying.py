"""What is to be said, as a value: which sentence, and what stands in it; `rigsim.present` has the words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

Value: TypeAlias = "str | float | tuple[str, ...] | tuple[float, ...] | Saying | tuple[Saying, ...]"
"""What may stand in a sentence: a name, a number, some of them, or what is said in another's words."""


@dataclass(frozen=True, slots=True)
class Saying:
    """One sentence, not yet in words."""

    form: str
    """Which sentence: its subject, as ``flipped-v``, and where that has several, ``flipped-v: axis``."""
    values: tuple[tuple[str, Value], ...] = ()
    """What stands in it, by name."""

    @property
    def subject(self) -> str:
        """What it speaks of."""
        return self.form.partition(":")[0]


def saying(form: str, **values: Value) -> Saying:
    """A sentence with the values that stand in it."""
    return Saying(form, tuple(values.items()))
