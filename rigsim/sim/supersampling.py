"""From a finer picture to the pixels it stands for."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from rigsim.rig.arrays import Light


def box_average(fine: npt.NDArray[Any], k: int) -> Light:
    """Mean of each k x k block of (k H, k W, C), (H, W, C)."""
    if k == 1:
        return np.asarray(fine, dtype=np.float32)
    total = np.zeros((fine.shape[0] // k, fine.shape[1] // k, fine.shape[2]), dtype=np.float32)
    for dv in range(k):
        for du in range(k):
            total += fine[dv::k, du::k]
    total /= k * k
    return total
