"""What a person passes, as what is meant by it; and a line that says what is wanted where it is neither."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import SupportsFloat, TypeVar

import numpy as np

from rigsim.errors import InvalidRange, RigsimError
from rigsim.rig.arrays import Array

_T = TypeVar("_T")
_MOST_SHOWN = 40


def real(value: object, name: str, error: type[RigsimError] = InvalidRange) -> float:
    """A number: any of Python's or NumPy's, also alone in an array.

    Raises:
        RigsimError: of class `error`; it is none.
    """
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.item()
    if isinstance(value, SupportsFloat) and not isinstance(value, np.ndarray | bool | np.bool_):
        try:
            return float(value)
        except OverflowError:
            raise error(f"{name} {shown(value)}: must be within 1e308") from None
    raise error(f"{name} {shown(value)}: must be a number")


def reals(values: object, name: str, error: type[RigsimError] = InvalidRange) -> tuple[float, ...]:
    """Numbers: one, or any that can be gone through.

    Raises:
        RigsimError: of class `error`; one of them is none.
    """
    return tuple(real(value, name, error) for value in several(values))


def several(values: object) -> tuple[object, ...]:
    """What can be gone through as a tuple, and anything else, words too, as a tuple of one."""
    if (
        isinstance(values, Iterable)
        and not isinstance(values, str | bytes)
        and np.ndim(np.asarray(values, object))
    ):
        return tuple(values)
    return (values.item() if isinstance(values, np.ndarray) else values,)


def a(kind: type[_T], value: object, wanted: str, error: type[RigsimError] = InvalidRange) -> _T:
    """`value`, when it is of `kind`.

    Raises:
        RigsimError: of class `error`; `wanted` says in words what it must be.
    """
    if isinstance(value, kind):
        return value
    raise error(f"{shown(value)}: must be {wanted}")


def path(value: object, what: str) -> Path:
    """A path: text, or what stands for a path.

    Raises:
        InvalidRange: it is neither.
    """
    if isinstance(value, str | os.PathLike):
        found = os.fspath(value)
        if isinstance(found, str) and found:
            return Path(found)
    raise InvalidRange(f"{what} {shown(value)}: must be a path, as text or pathlib.Path")


def points(values: object) -> Array:
    """Points (N, 3), a row a point.

    Raises:
        InvalidRange: they are no numbers, or of another shape.
    """
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidRange(f"points {shown(values)}: must be numbers (N, 3), a row a point") from None
    if array.ndim != 2 or array.shape[1] != 3:
        raise InvalidRange(f"points of shape {array.shape}: must be (N, 3), a row a point")
    return array


def shown(value: object) -> str:
    """`value` in a message: short, on one line."""
    text = " ".join(repr(value).split())
    return text if len(text) <= _MOST_SHOWN else f"{text[: _MOST_SHOWN - 3]}..."
