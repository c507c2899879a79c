"""The words that commands on triangulators share."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Annotated, TypeAlias

import typer

from rigsim.errors import InvalidRange
from rigsim.typed import quantity

TIMEOUT = quantity.QuantityKind(
    "timeout", "s", {"ms": Fraction(1, 1000), "s": Fraction(1), "min": Fraction(60)}, above=0
)
"""How long one call of somebody else's triangulator may take."""


InProcess: TypeAlias = Annotated[
    bool,
    typer.Option(
        "--in-process",
        help="Call a function of yours in this process: faster, but if it crashes or hangs, so does rigsim.",
    ),
]


def words(given: Sequence[str] | None, name: str) -> tuple[str, ...]:
    """The words of a repeatable option, each of which may hold several with commas."""
    found = [word.strip() for text in given or () for word in text.split(",")]
    for place, word in enumerate(found):
        if not word:
            raise InvalidRange(f"{name}: empty; name one, or several with commas")
        if word in found[:place]:
            raise InvalidRange(f"{name} {word!r}: given twice; remove one")
    return tuple(found)
