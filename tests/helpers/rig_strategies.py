"""Random rigs, and what it takes for two to be the same."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig


def _within(limit: float) -> st.SearchStrategy[float]:
    return st.floats(-limit, limit, allow_subnormal=False)


@st.composite
def lenses(draw: st.DrawFn, distorted: bool = True, k3: bool = True) -> Intrinsics:
    """Any pinhole, non-square and off-centre; mildly distorted where that is wanted."""
    width, height = draw(st.integers(16, 4096)), draw(st.integers(16, 4096))
    fx = draw(st.floats(50.0, 9000.0))
    distortion = None
    if distorted and draw(st.booleans()):
        small = _within(0.01)
        distortion = BrownConrady(
            draw(small), draw(small), draw(small), draw(small), draw(small) if k3 else 0.0
        )
    return Intrinsics(
        width,
        height,
        fx,
        fx * draw(st.floats(0.7, 1.4)),
        draw(st.floats(0.1, 0.9)) * width,
        draw(st.floats(0.1, 0.9)) * height,
        distortion,
    )


@st.composite
def rigs(
    draw: st.DrawFn, distorted: bool = True, k3: bool = True, angle_rad: float = 0.3, sideways: bool = False
) -> StereoRig:
    """Any rig; `sideways` keeps the right camera to the right, and its lens the left one's size."""
    left = draw(lenses(distorted, k3))
    right = draw(lenses(distorted, k3))
    turn = Pose.from_rotvec([draw(_within(angle_rad)) for _ in range(3)])
    length = draw(st.floats(0.005, 5.0))
    if sideways:
        right = Intrinsics(left.width, left.height, right.fx, right.fy, right.cx, right.cy, right.lens)
        centre = np.array([1.0, draw(_within(0.2)), draw(_within(0.2))])
    else:
        centre = np.array([draw(st.sampled_from([-1.0, 1.0])), draw(_within(1.0)), draw(_within(1.0))])
    return StereoRig(left, right, Pose(turn.R, -turn.R @ (length * centre)))


@st.composite
def rectified_rigs(draw: st.DrawFn) -> StereoRig:
    """Rectified, with doffs and non-square pixels."""
    left = draw(lenses(distorted=False))
    right = Intrinsics(left.width, left.height, left.fx, left.fy, left.cx + draw(_within(100.0)), left.cy)
    return StereoRig.rectified(left, draw(st.floats(0.001, 10.0)), right=right)


def same_lens(found: Intrinsics, expected: Intrinsics, tolerance: float = 1e-9) -> None:
    assert (found.width, found.height) == (expected.width, expected.height)
    for name in ("fx", "fy", "cx", "cy"):
        a, b = getattr(found, name), getattr(expected, name)
        assert abs(a - b) <= tolerance * max(1.0, abs(b)), (name, a, b)
    assert found.lens == expected.lens


def same_rig(found: StereoRig, expected: StereoRig, tolerance: float = 1e-9) -> None:
    """Equal within `tolerance`: m and rotation absolutely, px relatively."""
    same_lens(found.left, expected.left, tolerance)
    same_lens(found.right, expected.right, tolerance)
    np.testing.assert_allclose(found.right_from_left.R, expected.right_from_left.R, rtol=0, atol=tolerance)
    np.testing.assert_allclose(found.right_from_left.t, expected.right_from_left.t, rtol=0, atol=tolerance)
