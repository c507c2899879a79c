"""The made-up sweeps that other tests draw."""

from __future__ import annotations

import numpy as np

from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from tests.helpers.synthetic_sweeps import depth_std


def test_made_up_numbers_follow_the_depth_law() -> None:
    rig = StereoRig.rectified(Intrinsics.from_focal(1280, 720, 900.0), 0.12)
    point = np.array([[0.3, -0.2, 3.0]])
    expected = 3.0**2 / (900.0 * 0.12) * 0.25 * np.sqrt(2)
    assert np.isclose(depth_std(rig, point, PixelNoise(0.25))[0], expected, rtol=1e-9)
