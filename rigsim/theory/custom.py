"""A user's own triangulator in the slot of the built-in ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from rigsim import strangers
from rigsim.errors import TriangulatorError
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig

TriangulatorFunction: TypeAlias = Callable[[StereoRig, Array, Array], Array]
"""``(rig, uv_left (N, 2) px, uv_right (N, 2) px) -> points_left (N, 3) m``; a row it cannot do is NaN."""


def _nothing() -> None:
    """What most methods need beside numpy."""


@dataclass(frozen=True, slots=True)
class NamedMethod:
    """A triangulator that has a name: the one entry that commands, help texts and docs are made from."""

    name: str
    """What it is called."""
    says: str
    """What it does, for lists: a phrase that begins small and ends without a stop."""
    function: TriangulatorFunction
    """What is called."""
    falls_short: bool = False
    """Whether it misses the maximum-likelihood point, and is biased, by its nature: it is then predicted by
    its own expansion."""
    ready: Callable[[], object] = _nothing
    """Raises when what it needs is not installed."""


@dataclass(frozen=True, slots=True)
class CheckedTriangulator:
    """Calls a user's triangulator and holds it to the contract.

    It gets copies, so it may overwrite them. Rows with a NaN or an infinity come back as NaN.

    Raises:
        TriangulatorError: on a call, when the function raises or returns anything but real (N, 3).
    """

    function: Callable[..., Any]
    """What is called."""
    name: str
    """What messages call it."""

    def __call__(self, rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        """Points (N, 3) m in the left camera's frame of pixels (N, 2)."""
        try:
            returned = self.function(rig, uv_left.copy(), uv_right.copy())
        except TriangulatorError:
            raise  # one that calls a program or another process has said all there is to say
        except Exception as error:
            raise TriangulatorError(
                f"triangulator {self.name!r} raised {first_line(error)}", "raised"
            ) from error
        expected = (len(uv_left), 3)
        try:
            result = np.asarray(returned)
        except Exception as error:  # ragged lists, tensors on another device
            raise TriangulatorError(
                f"triangulator {self.name!r} returned a {type(returned).__name__} that is no array"
                f" ({first_line(error)}): must be {expected}, a row a point",
                "no-array",
            ) from error
        if result.shape != expected:
            raise TriangulatorError(
                f"triangulator {self.name!r} returned shape {result.shape}: must be {expected}, "
                "a row a point",
                "wrong-shape",
                result.shape,
            )
        if result.dtype.kind not in "fiu":
            raise TriangulatorError(
                f"triangulator {self.name!r} returned type {result.dtype}: must be real numbers",
                "wrong-type",
            )
        points = result.astype(np.float64)
        points[~np.isfinite(points).all(axis=1)] = np.nan
        return points


def load(name: str) -> CheckedTriangulator:
    """The function called ``package.module:function``; modules of the working folder are found too.

    Raises:
        TriangulatorError: it cannot be imported, does not exist, or cannot be called.
    """
    module_name, _, attribute = name.partition(":")
    if not module_name or not attribute:
        raise TriangulatorError(f"triangulator {name!r}: must be written package.module:function", "unknown")
    try:
        function = strangers.find(name)
    except AttributeError as error:
        raise TriangulatorError(f"triangulator {name!r}: {first_line(error)}", "unloadable") from error
    except Exception as error:
        raise TriangulatorError(
            f"triangulator {name!r}: cannot import {module_name} ({first_line(error)})", "unloadable"
        ) from error
    if not callable(function):
        raise TriangulatorError(
            f"triangulator {name!r}: {attribute} is a {type(function).__name__}, not a function", "unloadable"
        )
    return CheckedTriangulator(function, name)


def first_line(error: BaseException) -> str:
    """Type and first line of an error's message."""
    lines = str(error).splitlines()
    return f"{type(error).__name__}: {lines[0]}" if lines else type(error).__name__
