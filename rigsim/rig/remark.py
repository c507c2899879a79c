"""What a person should know beside an answer that stands all the same."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Remark:
    """One remark: odd input, or a number that holds only in part."""

    code: str
    """Short name for machines, snake_case: ``unit``, ``not_seen``."""
    text: str
    """One sentence for people: the value, why it is odd, and the way out."""
