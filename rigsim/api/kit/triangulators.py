"""The triangulators that are given by name, as functions or as programs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any, TypeAlias

from rigsim.errors import InvalidRange
from rigsim.rig import given

if TYPE_CHECKING:
    from rigsim.theory.custom import TriangulatorFunction

Method: TypeAlias = str | Callable[..., Any]
"""rigsim's own by name, ``package.module:function``, or a function."""

TIMEOUT_S = 10.0
"""How long one call of somebody else's may take unless something else is said, s."""


def named(methods: Method | Sequence[Method], what: str = "triangulator") -> tuple[Method, ...]:
    """One or several, each once.

    Raises:
        InvalidRange: one is neither a name nor a function, or is given twice.
    """
    found: list[Method] = []
    for method in given.several(methods):
        if not (isinstance(method, str) and method) and not callable(method):
            raise InvalidRange(f"{what} {given.shown(method)}: must be a name or a function")
        if method in found:
            raise InvalidRange(f"{what} {given.shown(method)}: given twice; remove one")
        found.append(method)
    return tuple(found)


@contextmanager
def opened(
    methods: Sequence[Method], programs: Sequence[str], timeout_s: float, in_process: bool = False
) -> Iterator[dict[str, TriangulatorFunction]]:
    """By the name they have in tables; somebody else's given by name run outside this process."""
    from rigsim.study.triangulators.isolated import IsolatedTriangulator
    from rigsim.study.triangulators.registry import label, named

    found: dict[str, TriangulatorFunction] = {}
    with ExitStack() as stack:
        for method in methods:
            name = label(method)
            if name in found:
                raise InvalidRange(f"triangulator {name!r}: two functions of this name; name one otherwise")
            if isinstance(method, str) and ":" in method and not in_process:
                found[name] = stack.enter_context(IsolatedTriangulator(method, timeout_s))
            else:
                found[name] = named(method)
        for command in programs:
            from rigsim.interop.exec.contract import ExecTriangulator

            if command in found:
                raise InvalidRange(f"exec {command!r}: given twice; remove one")
            found[command] = ExecTriangulator(command, timeout_s)
        yield found
