"""The triangulators that have a name, and how those of somebody else are started."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from types import MappingProxyType
from typing import Any

from rigsim.errors import TriangulatorError
from rigsim.pixels.opencv import load_cv2
from rigsim.pixels.opencv_triangulation import triangulate_cv2
from rigsim.study.triangulators.isolated import IsolatedTriangulator
from rigsim.theory.custom import CheckedTriangulator, NamedMethod, TriangulatorFunction, load
from rigsim.theory.triangulation import METHODS, REGISTERED, resolve

ALL: tuple[NamedMethod, ...] = (
    *REGISTERED,
    NamedMethod("cv2", "OpenCV's triangulatePoints", triangulate_cv2, falls_short=True, ready=load_cv2),
)
"""Every triangulator with a name: rigsim's own, then those of other libraries. A new one is a line here."""

BY_NAME: Mapping[str, NamedMethod] = MappingProxyType({method.name: method for method in ALL})
"""The same by name."""

KNOWN: Mapping[str, TriangulatorFunction] = MappingProxyType({method.name: method.function for method in ALL})
"""The functions by name."""


def named(method: str | Callable[..., Any]) -> TriangulatorFunction:
    """The triangulator that `method` names; a user's own comes back wrapped in its checks.

    Raises:
        TriangulatorError: unknown name, or it cannot be imported.
    """
    if isinstance(method, str) and method not in KNOWN and ":" not in method:
        raise TriangulatorError(
            f"unknown triangulator {method!r}: choose one of {', '.join(KNOWN)}, or package.module:function",
            "unknown",
        )
    if isinstance(method, str) and method in KNOWN:
        return KNOWN[method]
    return resolve(method)


def label(method: str | Callable[..., Any]) -> str:
    """What a triangulator is called in tables."""
    if isinstance(method, str):
        return method
    if isinstance(method, CheckedTriangulator):
        return method.name
    return f"{getattr(method, '__module__', '?')}:{getattr(method, '__qualname__', repr(method))}"


def falls_short(method: str | Callable[..., Any]) -> bool:
    """Whether it is known to miss the maximum-likelihood point by its nature."""
    known = BY_NAME.get(label(method))
    return known is not None and known.falls_short


@contextmanager
def started(
    methods: Sequence[str | Callable[..., Any]], timeout_s: float | None, at_once: bool = True
) -> Iterator[tuple[str | Callable[..., Any], ...]]:
    """The methods as `rigsim.theory.triangulation.triangulate` takes them, by the same labels.

    Args:
        methods: names, ``package.module:function``, or functions.
        timeout_s: how long one call of a ``package.module:function`` may take in a process of its own; None
            calls it in this process.
        at_once: start those processes now, not with the first call.

    Raises:
        TriangulatorError: unknown name, or it cannot be imported.
        MeasurementFailed: what it needs is not installed.
    """
    with ExitStack() as stack:
        found: list[str | Callable[..., Any]] = []
        for method in methods:
            if isinstance(method, str) and ":" in method:
                if timeout_s is None:
                    found.append(load(method))
                    continue
                worker = IsolatedTriangulator(method, timeout_s)
                if at_once:
                    stack.enter_context(worker)
                else:
                    stack.callback(worker.close)
                found.append(CheckedTriangulator(worker, method))
                continue
            function = named(method)  # an unknown name fails here
            if isinstance(method, str):
                BY_NAME[method].ready()
            if not isinstance(method, str) or method in METHODS:
                found.append(method)
            else:
                found.append(CheckedTriangulator(function, method))
        yield tuple(found)
