"""Two cameras: where they stand, what they see, and when a pair counts as rectified."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.errors import InvalidRig, InvalidScene
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.presets import PRESETS, preset
from rigsim.rig.stereo import StereoRig
from tests.helpers.sampling import LENS, PLAIN, RIGS, close, points_in_view, rigs


def test_rectified_pixels_by_hand() -> None:
    left = Intrinsics(640, 480, 500.0, 400.0, 300.0, 250.0)
    rig = StereoRig.rectified(left, 0.2, right=replace(left, cx=310.0))
    uv_left, uv_right = rig.project([[1.0, -2.0, 4.0]])
    close(uv_left, [[425.0, 50.0]])
    # the right camera stands 0.2 m to the right: u = 500 * 0.8/4 + 310
    close(uv_right, [[410.0, 50.0]])
    close(rig.doffs_px, 10.0)
    close(500 * 0.2 / (425 - 410 + rig.doffs_px), 4.0)


@given(st.floats(0.05, 1.0), st.floats(0.5, 20.0))
def test_verged_cameras_look_at_the_point_their_axes_meet_in(baseline: float, depth: float) -> None:
    rig = StereoRig.verged(PLAIN, baseline, 2 * math.degrees(math.atan(baseline / 2 / depth)))
    # the point `depth` ahead of the middle lies on both optical axes
    ahead = rig.rig_from_left.inverse.apply([[0.0, 0.0, depth]])
    close(ahead, [[0.0, 0.0, math.hypot(depth, baseline / 2)]], atol=1e-12)
    for uv in rig.project(ahead):
        close(uv, [[PLAIN.cx, PLAIN.cy]], atol=1e-9)


def test_verged_signs() -> None:
    rig = StereoRig.verged(PLAIN, 0.12, 2 * math.degrees(math.atan(0.06 / 2.0)))
    left_from_rig = rig.rig_from_left.inverse
    # a farther point of the middle line lies inwards of both axes, a nearer one outwards
    (far_left, far_right), (near_left, near_right) = (
        (a[0, 0] - PLAIN.cx, b[0, 0] - PLAIN.cx)
        for a, b in (rig.project(left_from_rig.apply([[0.0, 0.0, z]])) for z in (4.0, 1.0))
    )
    assert far_left < 0 < far_right
    assert near_left > 0 > near_right
    close(far_left, -far_right)
    # tan of the half angles subtracted: (0.03 - 0.015) / (1 + 0.03 * 0.015)
    close(far_right, 800 * 0.015 / 1.00045)


@given(st.floats(0.05, 1.0), st.floats(-60.0, 60.0))
def test_the_rig_frame_stands_in_the_middle(baseline: float, vergence: float) -> None:
    rig = StereoRig.verged(PLAIN, baseline, vergence)
    close(rig.vergence_deg, vergence, atol=1e-9)
    close(rig.baseline_m, baseline)
    rig_from_left = rig.rig_from_left
    close(rig_from_left.t, [-baseline / 2, 0.0, 0.0], atol=1e-12)
    rig_from_right = rig_from_left @ rig.right_from_left.inverse
    close(rig_from_right.t, [baseline / 2, 0.0, 0.0], atol=1e-12)
    # the left camera's forward axis points to the right when vergence is positive
    close(
        rig_from_left.R[:, 2],
        [math.sin(math.radians(vergence) / 2), 0, math.cos(math.radians(vergence) / 2)],
        atol=1e-12,
    )


@given(rigs())
def test_the_rig_frame_is_halfway_for_any_pose(rig: StereoRig) -> None:
    half = rig.rig_from_left
    from_right = half @ rig.right_from_left.inverse
    close(half.t, -from_right.t, atol=1e-14)
    # left to rig and rig to right turn by the same rotation
    close(half.R, from_right.R.T, atol=1e-13)


@given(rigs(distorted=True), st.integers(0, 2**32 - 1))
def test_jacobian_is_the_slope_of_both_projections(rig: StereoRig, seed: int) -> None:
    points = points_in_view(rig, 5, 1.0, 8.0, seed)
    step = 1e-6
    slopes = [
        (np.hstack(rig.project(points + d)) - np.hstack(rig.project(points - d))) / (2 * step)
        for d in step * np.eye(3)
    ]
    close(rig.jacobian(points), np.stack(slopes, axis=-1), rtol=1e-6, atol=1e-4)


def test_a_point_behind_one_camera_is_unseen_there_alone() -> None:
    rig = RIGS["forward"]  # the right camera stands 0.3 m ahead
    uv_left, uv_right = rig.project([[0.0, 0.0, 0.2]])
    assert np.isfinite(uv_left).all()
    assert np.isnan(uv_right).all()


@pytest.mark.parametrize(
    "change",
    [
        lambda r: replace(r, right=replace(r.right, fx=r.right.fx + 1e-9)),
        lambda r: replace(r, right=replace(r.right, fy=r.right.fy + 1e-9)),
        lambda r: replace(r, right=replace(r.right, cy=r.right.cy + 1e-9)),
        lambda r: replace(r, left=replace(r.left, lens=LENS)),
        lambda r: replace(r, right=replace(r.right, lens=LENS)),
        lambda r: replace(r, right_from_left=Pose(t=[0.1, 0.0, 0.0])),
        lambda r: replace(r, right_from_left=Pose(t=[-0.1, 1e-9, 0.0])),
        lambda r: replace(r, right_from_left=Pose(t=[-0.1, 0.0, 1e-9])),
        lambda r: replace(r, right_from_left=Pose.from_rotvec([1e-9, 0, 0], [-0.1, 0, 0])),
    ],
)
def test_rectified_means_all_of_it(change) -> None:
    rig = RIGS["rectified"]
    assert rig.is_rectified
    assert replace(rig, right=replace(rig.right, cx=1.0)).is_rectified
    assert not change(rig).is_rectified


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: StereoRig.rectified(PLAIN, 0.0), "baseline 0 mm: must be > 0"),
        (lambda: StereoRig.rectified(PLAIN, -0.05), "baseline -50 mm: must be > 0"),
        (lambda: StereoRig.rectified(PLAIN, math.nan), "baseline nan mm: must be > 0"),
        (lambda: StereoRig.verged(PLAIN, 0.1, 180.0), "vergence 180 deg: must be between"),
        (lambda: StereoRig(PLAIN, PLAIN, Pose.from_rotvec([0.1, 0, 0])), "baseline 0 mm: must be > 0"),
    ],
)
def test_impossible_rigs_are_named(make, says: str) -> None:
    with pytest.raises(InvalidRig, match=says):
        make()


def test_presets_are_found_by_name() -> None:
    branch, artifact = preset("branch").rig, preset("artifact").rig
    close(
        [branch.left.fx, branch.baseline_m, artifact.left.fx, artifact.baseline_m], [1200, 0.15, 2000, 0.08]
    )
    assert all(item.name == name and item.rig.is_rectified for name, item in PRESETS.items())
    with pytest.raises(InvalidScene, match="unknown preset 'nope': choose one of boards, branch"):
        preset("nope")
