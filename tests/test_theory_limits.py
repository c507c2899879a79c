"""Search ranges, overlap and blind zone by hand, and against what the cameras really see."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from sampling import LENS, PLAIN, RIGS, close

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.rig.arrays import Array, Mask
from rigsim.rig.distortion import BrownConrady
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory.limits import (
    blind_zone_m,
    dead_band_px,
    depth_range_for_disparities,
    depth_step_m,
    overlap_at_depth,
    overlap_fov_deg,
    world_per_pixel_m,
)
from rigsim.theory.uncertainty import depth_bounds

WIDE = Intrinsics.from_hfov(640, 480, 90.0)  # f = 320: sees exactly 45 degrees to either side


def test_search_range_by_hand() -> None:
    rig = StereoRig.rectified(PLAIN, 0.1)  # f B = 80 px m
    close(depth_range_for_disparities(rig, 100.0), (0.8, math.inf))
    close(depth_range_for_disparities(rig, 100.0, 20.0), (0.8, 4.0))
    # N = 60 disparities from a shift of 20
    close(depth_range_for_disparities(rig, 60.0, shift_px=20.0), (1.0, 4.0))
    close(depth_range_for_disparities(rig, 100.0, -5.0), (0.8, math.inf))
    shifted = replace(rig, right=replace(PLAIN, cx=PLAIN.cx + 10))
    close(depth_range_for_disparities(shifted, 90.0, 10.0), (0.8, 4.0))


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((20.0, 20.0), "disparities 20 to 20 px: must grow"),
        ((math.nan,), "disparities 0 to nan px: must grow"),
        ((math.inf,), "disparities 0 to inf px: must grow, and be finite"),
        ((44.0, 0.0), "largest disparity -1 px, shift and doffs added: must be > 0"),
    ],
)
def test_impossible_searches_are_named(arguments: tuple[float, ...], says: str) -> None:
    with pytest.raises(InvalidRange, match=says):
        depth_range_for_disparities(RIGS["rectified"], *arguments)
    with pytest.raises(InvalidRig, match="not rectified: give the rig of the rectified images"):
        depth_range_for_disparities(RIGS["verged"], 100.0)


def test_rectified_overlap_by_hand() -> None:
    rig = StereoRig.rectified(WIDE, 0.2)
    close(overlap_fov_deg(rig), 90.0)
    close(blind_zone_m(rig), 0.1)
    # at 1 m each sees 2 m; 0.2 m of the left image's 2 m, f B / Z = 64 columns, are its own
    overlap = overlap_at_depth(rig, 1.0)
    close(overlap.width_m, 1.8)
    close(overlap.fraction, 0.9)
    close(dead_band_px(rig, [1.0, 2.0, 0.1, 0.05]), [64.0, 32.0, 640.0, 640.0])


def test_verged_overlap_by_hand() -> None:
    # each camera turned inwards by 15 degrees: its outer edge looks 30 degrees out, its inner edge 60 in
    rig = StereoRig.verged(WIDE, 0.2, 30.0)
    close(overlap_fov_deg(rig), 60.0)
    # the inner edges, 60 degrees, cross at once; the overlap there is bounded by the inner edges
    close(blind_zone_m(rig), 0.1 / math.tan(math.radians(60)))
    # far away the outer edges bound it: -0.1 - tan 30 and 0.1 + tan 30 at 1 m
    close(overlap_at_depth(rig, 1.0).width_m, 2 * math.tan(math.radians(30)) + 0.2)
    # the left image's first column to the one that looks from -0.1 to 0.1 + tan 30, 35.8 - 15 degrees inwards
    angle = math.atan(0.2 + math.tan(math.radians(30))) - math.radians(15)
    close(overlap_at_depth(rig, 1.0).fraction, (320 + 320 * math.tan(angle)) / 640)


def test_diverging_cameras_lose_the_far_field() -> None:
    close(overlap_fov_deg(StereoRig.verged(WIDE, 0.2, -30.0)), 60.0)
    away = StereoRig.verged(WIDE, 0.2, -100.0)
    assert overlap_fov_deg(away) == 0.0
    assert blind_zone_m(away) == math.inf
    assert overlap_at_depth(away, 5.0) == (0.0, 0.0)


def test_the_camera_ahead_sets_the_blind_zone() -> None:
    rig = StereoRig(WIDE, WIDE, Pose(t=np.array([0.0, 0.0, -0.4])))
    close(blind_zone_m(rig), 0.2)
    # 1 m ahead of the middle the right camera, 0.8 m away, sees 1.6 m of the left one's 2.4
    overlap = overlap_at_depth(rig, 1.0)
    close(overlap.width_m, 1.6)
    close(overlap.fraction, 1.6 / 2.4)


def both_see(rig: StereoRig, x: Array, depth: float) -> Mask:
    """Whether both images show points of the mid plane."""
    points = rig.rig_from_left.inverse.apply(np.column_stack([x, np.zeros_like(x), np.full_like(x, depth)]))
    uv_left, uv_right = rig.project(points)
    # only columns are asked for
    uv_left[:, 1], uv_right[:, 1] = rig.left.cy, rig.right.cy
    return rig.left.contains(uv_left) & rig.right.contains(uv_right)


@given(
    st.floats(0.05, 0.5),
    st.floats(-0.3, 0.3),
    st.floats(-100, 100),
    st.floats(40, 120),
    st.floats(40, 120),
    st.floats(0.1, 5.0),
)
def test_overlap_is_what_both_images_show(
    baseline: float, ahead: float, vergence: float, hfov_left: float, hfov_right: float, depth: float
) -> None:
    left = replace(Intrinsics.from_hfov(640, 480, hfov_left), cx=300.0)
    right = Intrinsics.from_hfov(800, 600, hfov_right)
    rig = StereoRig(left, right, Pose.from_rotvec((0.0, np.radians(vergence), 0.0), (-baseline, 0.0, ahead)))
    overlap = overlap_at_depth(rig, depth)
    assume(overlap.width_m < 20)
    x = np.linspace(-60, 60, 24_001)
    seen = both_see(rig, x, depth)
    assume(not (seen[0] or seen[-1]))
    close(overlap.width_m, seen.sum() * 5e-3, atol=1e-2)
    blind = blind_zone_m(rig)
    assert overlap.width_m == 0 or depth >= blind * (1 - 1e-9)
    if blind < math.inf:
        assert not overlap_at_depth(rig, blind * 0.99).width_m > 0
        assert overlap_at_depth(rig, blind * 1.000001 + 1e-9).width_m > 0


def test_overlap_angle_is_the_far_overlap() -> None:
    rig = StereoRig.verged(WIDE, 0.2, 20.0, right=Intrinsics.from_hfov(800, 600, 60.0))
    far = 1e6
    x = np.linspace(-2, 2, 400_001)
    seen = np.degrees(np.arctan(x[both_see(rig, x * far, far)]))
    close(overlap_fov_deg(rig), seen.max() - seen.min(), atol=2e-3)


def test_distortion_moves_the_edges() -> None:
    camera = replace(PLAIN, distortion=LENS)
    rig = StereoRig.rectified(camera, 0.1)
    edges = camera.normalize(np.array([[-0.5, camera.cy], [1279.5, camera.cy]]))[:, 0]
    close(overlap_fov_deg(rig), np.degrees(np.arctan(edges[1]) - np.arctan(edges[0])))
    folded = replace(Intrinsics.from_hfov(640, 480, 100.0), distortion=BrownConrady(k1=-0.4))
    with pytest.raises(InvalidRig, match="the image's edges lie beyond where the lens can be inverted"):
        blind_zone_m(StereoRig.rectified(folded, 0.1))


def test_no_depth_no_overlap() -> None:
    rig = StereoRig.rectified(WIDE, 0.2)
    for depth in (0.0, -1.0, math.nan):
        assert np.isnan(overlap_at_depth(rig, depth)).all()
        assert np.isnan(dead_band_px(rig, depth))
        assert np.isnan(depth_step_m(rig, depth))


def test_depth_step_by_hand() -> None:
    rig = StereoRig.rectified(PLAIN, 0.1)
    close(depth_step_m(rig, [[1.0, 2.0], [4.0, 8.0]]), [[1 / 80, 4 / 80], [16 / 80, 64 / 80]])
    close(depth_step_m(rig, 4.0, 0.25), 0.05)
    close(world_per_pixel_m(rig, [0.8, 4.0]), [1e-3, 5e-3])


@pytest.mark.parametrize("kind", RIGS)
def test_depth_step_is_the_slope_of_the_bounds(kind: str) -> None:
    rig = RIGS[kind]
    near, far = depth_bounds(rig, [[0.0, 0.0, 2.0]], 1e-5)
    close(depth_step_m(rig, 2.0), (far - near)[0] / 2e-5, rtol=1e-6)
