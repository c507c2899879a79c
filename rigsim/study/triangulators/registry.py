"""The triangulators that a verification knows by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from rigsim.errors import TriangulatorError
from rigsim.pixels.opencv_triangulation import triangulate_cv2
from rigsim.theory.custom import Triangulator
from rigsim.theory.triangulation import METHODS, resolve

KNOWN: Mapping[str, Triangulator] = MappingProxyType({**METHODS, "cv2": triangulate_cv2})
"""rigsim's own and OpenCV's, by name."""


def named(method: str | Callable[..., Any]) -> Triangulator:
    """The triangulator that `method` names; a user's own comes back wrapped in its checks.

    Raises:
        TriangulatorError: unknown name, or it cannot be imported.
    """
    if isinstance(method, str) and method not in KNOWN and ":" not in method:
        raise TriangulatorError(
            f"unknown triangulator {method!r}: choose one of {', '.join(KNOWN)}, or package.module:function"
        )
    if isinstance(method, str) and method in KNOWN:
        return KNOWN[method]
    return resolve(method)
