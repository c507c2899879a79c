"""Array types shared by every room."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]
Mask: TypeAlias = npt.NDArray[np.bool_]
Ids: TypeAlias = npt.NDArray[np.int32]
Image: TypeAlias = npt.NDArray[np.uint8]
Light: TypeAlias = npt.NDArray[np.float32]


def frozen(values: npt.ArrayLike, shape: tuple[int, ...] | None = None) -> Array:
    """Return a read-only float64 copy of `values`, reshaped to `shape` when given.

    Raises:
        ValueError: the values do not fit `shape`.
    """
    array = np.array(values, dtype=np.float64)
    if shape is not None:
        array = array.reshape(shape)
    array.flags.writeable = False
    return array


_ROWS = 4096
"""Rows gone through at once: what is made of them on the way stays in the cache."""


def by_rows(function: Callable[[Array], Array], values: Array, columns: int) -> Array:
    """`function` of (..., K), row by row (..., `columns`), a cache-sized block at a time."""
    if values.size <= _ROWS * values.shape[-1]:
        return function(values)
    flat = values.reshape(-1, values.shape[-1])
    result = np.empty((len(flat), columns))
    for start in range(0, len(flat), _ROWS):
        result[start : start + _ROWS] = function(flat[start : start + _ROWS])
    return result.reshape(*values.shape[:-1], columns)


AnyImage: TypeAlias = npt.NDArray[Any]
"""A picture, (H, W) or (H, W, 1|3|4), of uint8, uint16 or a float type."""


GREY_WEIGHTS = (0.299, 0.587, 0.114)
"""Weights of red, green and blue (ITU-R BT.601), applied to the values as they are: no gamma is undone."""
