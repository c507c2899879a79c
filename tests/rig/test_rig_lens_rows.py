"""Many lenses at once answer as one after the other."""

from __future__ import annotations

import numpy as np
import pytest

from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.undistortion import undistort_rows

LENSES = [
    BrownConrady(),
    BrownConrady(k1=-0.3, k2=0.1, k3=-0.02),
    BrownConrady(k1=-0.2, p1=0.002, p2=-0.001),
    BrownConrady(k1=0.4, k2=-0.6, p1=0.01, p2=0.02, k3=0.3),  # dips
    BrownConrady(k1=-0.45, k2=-0.3),  # folds early
    BrownConrady(k1=1e3),
]


@pytest.mark.parametrize("reach", [0.3, 1.0, 5.0])
def test_rows_of_many_lenses_are_undone_as_each_alone(reach: float) -> None:
    rng = np.random.default_rng(3)
    counts = [40, 0, 30, 50, 60, 20]
    seen = rng.uniform(-reach, reach, (sum(counts), 2))
    seen[[1, 45, 130]] = np.nan
    found = undistort_rows(LENSES, counts, seen)
    alone = [
        lens.undistort(rows)
        for lens, rows in zip(LENSES, np.split(seen, np.cumsum(counts)[:-1]), strict=True)
    ]
    np.testing.assert_allclose(found, np.concatenate(alone), rtol=1e-13, atol=1e-14)
    assert np.isfinite(found).all(axis=1).sum() > 40


def test_no_rows() -> None:
    assert undistort_rows([], [], np.empty((0, 2))).shape == (0, 2)
