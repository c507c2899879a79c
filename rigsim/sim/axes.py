"""MuJoCo's axes and the sign of its principal offset, for what compiles scenes and what writes them."""

from __future__ import annotations

import numpy as np

from rigsim.rig.intrinsics import Intrinsics

CV_FROM_GL = np.diag([1.0, -1.0, -1.0])
"""Turns MuJoCo's camera axes (x right, y up, z backward) into OpenCV's, and back."""

REP103_FROM_RIG = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""Rig axes (x right, y down, z forward) in a frame with x forward, y left, z up (ROS REP 103)."""


def principal_offset(lens: Intrinsics) -> tuple[float, float]:
    """MuJoCo's ``principalpixel``: from the principal point to the image's middle, px (from 3.6 on)."""
    return (lens.width - 1) / 2 - lens.cx, (lens.height - 1) / 2 - lens.cy
