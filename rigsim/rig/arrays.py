"""Array types shared by every room."""

from __future__ import annotations

from typing import TypeAlias

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
