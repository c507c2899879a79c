"""The triangulators that commands are given by name, as functions or as programs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

from rigsim.cli.kit import quantity
from rigsim.errors import InvalidRange

if TYPE_CHECKING:
    from rigsim.theory.custom import TriangulatorFunction

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


@contextmanager
def resolved(
    names: Sequence[str], commands: Sequence[str], timeout_s: float, in_process: bool = False
) -> Iterator[dict[str, TriangulatorFunction]]:
    """By the name they have in tables; those of somebody else run outside this process, programs at least."""
    from rigsim.study.triangulators.isolated import IsolatedTriangulator
    from rigsim.study.triangulators.registry import named

    found: dict[str, TriangulatorFunction] = {}
    with ExitStack() as stack:
        for name in names:
            if ":" in name and not in_process:
                found[name] = stack.enter_context(IsolatedTriangulator(name, timeout_s))
            else:
                found[name] = named(name)
        for command in commands:
            from rigsim.interop.exec.contract import ExecTriangulator

            if command in found:
                raise InvalidRange(f"exec {command!r}: given twice; remove one")
            found[command] = ExecTriangulator(command, timeout_s)
        yield found


def words(given: Sequence[str] | None, name: str) -> tuple[str, ...]:
    """The words of a repeatable option, each of which may hold several with commas."""
    found = [word.strip() for text in given or () for word in text.split(",")]
    for place, word in enumerate(found):
        if not word:
            raise InvalidRange(f"{name}: empty; name one, or several with commas")
        if word in found[:place]:
            raise InvalidRange(f"{name} {word!r}: given twice; remove one")
    return tuple(found)
