"""Search ranges, overlap and blind zone by hand, and against what the cameras really see."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory.limits import (
    blind_zone_m,
    dead_band_px,
    depth_range_for_disparities,
    depth_step_m,
    field_of_view_deg,
    overlap_at_depth,
    overlap_fov_deg,
    shifts_for_range,
    world_per_pixel_m,
)
from rigsim.theory.uncertainty import depth_bounds
from tests.helpers.sampling import LENS, PLAIN, RIGS, close, vectors

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


def test_shifts_that_reach_a_range_by_hand() -> None:
    rig = StereoRig.rectified(PLAIN, 0.1)  # f B = 80 px m: 0.4 m is 200 px, 1 m 80 px
    close(shifts_for_range(rig, 0.4, None, 128.0), (72.0, math.inf))
    close(shifts_for_range(rig, 0.4, 1.0, 128.0), (72.0, 80.0))
    shifted = replace(rig, right=replace(PLAIN, cx=PLAIN.cx + 10))
    close(shifts_for_range(shifted, 0.4, 1.0, 128.0, 8.0), (62.0, 62.0))
    with pytest.raises(InvalidRig, match="not rectified"):
        shifts_for_range(RIGS["verged"], 0.4, None, 128.0)


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
    close(overlap_fov_deg(rig), (90.0, 2 * math.degrees(math.atan(0.75))))
    close(blind_zone_m(rig), 0.1)
    # at 1 m each sees 2 m; 0.2 m of the left image's 2 m, f B / Z = 64 columns, are its own
    overlap = overlap_at_depth(rig, 1.0)
    close(overlap, (1.8, 0.9, 1.5, 576.0, 480.0))
    close(dead_band_px(rig, [1.0, 2.0, 0.1, 0.05]), [64.0, 32.0, 640.0, 640.0])


def test_verged_overlap_by_hand() -> None:
    # each camera turned inwards by 15 degrees: its outer edge looks 30 degrees out, its inner edge 60 in
    rig = StereoRig.verged(WIDE, 0.2, 30.0)
    close(overlap_fov_deg(rig)[0], 60.0)
    # the inner edges meet half way between the cameras, 0.1 / tan 60 ahead: along the left axis, turned by 15
    sin, cos = math.sin(math.radians(15)), math.cos(math.radians(15))
    close(blind_zone_m(rig), 0.1 * sin + 0.1 / math.tan(math.radians(60)) * cos)


def test_a_camera_below_takes_rows_not_columns() -> None:
    # f 800 px, 960 rows: at 1 m 96 of them look under the lower camera's field of view
    below = StereoRig(PLAIN, PLAIN, Pose(t=np.array([0.0, -0.12, 0.0])))
    close(overlap_at_depth(below, 1.0), (1.6, 0.9, 1.08, 1280.0, 864.0))
    close(blind_zone_m(below), 800 * 0.12 / 960)
    # 2 m below: nothing is shared at 1 m, though the columns are the same
    chain = StereoRig(PLAIN, PLAIN, Pose(t=np.array([0.0, -2.0, 0.0])))
    close(overlap_at_depth(chain, 1.0), (0.0, 0.0, 0.0, 0.0, 0.0))
    close(blind_zone_m(chain), 2.0 / 1.2)


def test_a_camera_aside_and_below_takes_both() -> None:
    diagonal = StereoRig(PLAIN, PLAIN, Pose(t=np.array([-0.12, -0.06, 0.0])))
    close(overlap_at_depth(diagonal, 1.0).fraction, (1 - 0.12 / 1.6) * (1 - 0.06 / 1.2))
    # the last to overlap are opposite corners: the wider of both gaps decides
    close(blind_zone_m(diagonal), max(0.12 / 1.6, 0.06 / 1.2))


@pytest.mark.parametrize(("roll_deg", "share"), [(90.0, 0.75), (180.0, 0.925), (270.0, 0.75)])
def test_rolled_cameras_share_what_their_outlines_share(roll_deg: float, share: float) -> None:
    # at 1 m the left camera sees 1.6 x 1.2 m, the right one, 0.12 m to the right, 1.2 x 1.6 or 1.6 x 1.2 m
    roll = Pose.from_rotvec((0.0, 0.0, math.radians(roll_deg)))
    rig = StereoRig(PLAIN, PLAIN, roll @ Pose(t=np.array([-0.12, 0.0, 0.0])))
    close(overlap_at_depth(rig, 1.0).fraction, share)
    assert overlap_at_depth(rig, 1.0).width_m <= 1.6


def test_diverging_cameras_lose_the_far_field() -> None:
    close(overlap_fov_deg(StereoRig.verged(WIDE, 0.2, -30.0))[0], 60.0)
    away = StereoRig.verged(WIDE, 0.2, -100.0)
    assert overlap_fov_deg(away) == (0.0, 0.0)
    assert blind_zone_m(away) == math.inf
    assert overlap_at_depth(away, 5.0) == (0.0, 0.0, 0.0, 0.0, 0.0)


def test_the_camera_ahead_sets_the_blind_zone() -> None:
    rig = StereoRig(WIDE, WIDE, Pose(t=np.array([0.0, 0.0, -0.4])))
    close(blind_zone_m(rig), 0.4)
    # at the left camera's 1 m the right one, 0.6 m away, sees 1.2 x 0.9 m of its 2 x 1.5 m
    overlap = overlap_at_depth(rig, 1.0)
    close(overlap.width_m, 1.2)
    close(overlap.fraction, 0.36)


def counted(rig: StereoRig, depth: float, rays_per_side: int = 400) -> float:
    """Share of a dense grid of left pixels whose points at `depth` the right image shows."""
    left = rig.left
    step = np.array([left.width, left.height]) / rays_per_side
    places = np.arange(rays_per_side) + 0.5
    uv = np.stack(np.meshgrid(places * step[0] - 0.5, places * step[1] - 0.5), axis=-1).reshape(-1, 2)
    points = np.column_stack([left.normalize(uv), np.ones(len(uv))]) * depth
    return float(rig.right.contains(rig.right.project(rig.right_from_left.apply(points))).mean())


@settings(max_examples=25, deadline=None)
@given(vectors(1.2), vectors(0.4), st.floats(40, 110), st.floats(30, 110), st.floats(0.2, 5.0))
def test_overlap_is_what_both_images_show(
    turn: Array, place: Array, hfov_left: float, hfov_right: float, depth: float
) -> None:
    assume(np.linalg.norm(place) > 0.01)
    left = replace(Intrinsics.from_hfov(640, 480, hfov_left), cx=300.0)
    rig = StereoRig(left, Intrinsics.from_hfov(800, 600, hfov_right), Pose.from_rotvec(turn, place))
    share = overlap_at_depth(rig, depth).fraction
    assert abs(share - counted(rig, depth)) < 4e-3
    blind = blind_zone_m(rig)
    assert share == 0 or depth >= blind * (1 - 1e-9)
    if 0 < blind < math.inf:
        assert overlap_at_depth(rig, blind * 0.99).fraction == 0
        assert overlap_at_depth(rig, blind * 1.000001 + 1e-9).fraction > 0


@pytest.mark.parametrize("depth", [0.2, 1.0, 30.0])
def test_distorted_overlap_is_what_both_images_show(depth: float) -> None:
    rig = RIGS["distorted"]
    close(overlap_at_depth(rig, depth).fraction, counted(rig, depth, 1200), atol=6e-4)


def test_the_blind_zone_of_distorted_lenses_ends_where_images_begin_to_share() -> None:
    rig = RIGS["distorted"]
    blind = blind_zone_m(rig)
    assert overlap_at_depth(rig, blind * 0.998).fraction == 0
    assert overlap_at_depth(rig, blind * 1.002).fraction > 0


def test_distortion_moves_the_edges() -> None:
    camera = replace(PLAIN, lens=LENS)
    rig = StereoRig.rectified(camera, 0.1)
    corners = camera.normalize(np.array([[-0.5, -0.5], [-0.5, 959.5], [1279.5, -0.5], [1279.5, 959.5]]))
    widest = np.degrees(np.arctan(corners[:, 0].max()) - np.arctan(corners[:, 0].min()))
    close(overlap_fov_deg(rig)[0], widest)
    close(field_of_view_deg(camera)[0], widest)


def test_where_a_lens_shows_nothing_nothing_is_shared() -> None:
    # k1 -0.4 folds at a radius of 0.913 in x/z: an image circle of 0.913 (1 - 0.4 0.833) = 0.609, f 268.5
    folded = replace(Intrinsics.from_hfov(640, 480, 100.0), lens=BrownConrady(k1=-0.4))
    rig = StereoRig.rectified(folded, 0.1)
    share = overlap_at_depth(rig, 1e6).fraction
    close(share, math.pi * (0.6086 * 268.51) ** 2 / (640 * 480), atol=1e-3)
    # 2 x 0.913 m wide at 1 m: the circles touch where they are 0.1 m apart
    close(blind_zone_m(rig), 0.1 / 2 / 0.91287, rtol=2e-3)


def test_no_depth_no_overlap() -> None:
    rig = StereoRig.rectified(WIDE, 0.2)
    for depth in (0.0, -1.0, math.nan):
        assert np.all(np.isnan(overlap_at_depth(rig, depth)))
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
