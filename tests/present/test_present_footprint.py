"""Where the fields of view lie on paper, against geometry done by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rigsim.present.kit.footprint import footprint
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory.limits import blind_zone_m

# 800 px wide, f 400 px: the edges of the image lie 45 degrees to both sides
WIDE = Intrinsics.from_focal(800, 600, 400.0)
H = np.sqrt(0.5)


def test_rectified_cameras_stand_left_and_right_and_look_up_the_page() -> None:
    view = footprint(StereoRig.rectified(WIDE, 0.2))
    np.testing.assert_allclose(view.left.center, [-0.1, 0.0], atol=1e-15)
    np.testing.assert_allclose(view.right.center, [0.1, 0.0], atol=1e-15)
    for camera in (view.left, view.right):
        np.testing.assert_allclose(camera.axis, [0, 1], atol=1e-15)
        np.testing.assert_allclose(camera.left_edge, [-H, H], atol=1e-12)
        np.testing.assert_allclose(camera.right_edge, [H, H], atol=1e-12)


def test_rectified_overlap_begins_where_the_inner_edges_cross() -> None:
    view = footprint(StereoRig.rectified(WIDE, 0.2))
    # 45 degrees from both ends of 0.2 m: the edges meet 0.1 m ahead (Z = f B / W)
    assert view.nearest is not None
    np.testing.assert_allclose(view.nearest, [0.0, 0.1], atol=1e-12)
    assert view.blind is not None
    np.testing.assert_allclose(view.blind, [[-0.1, 0.0], [0.1, 0.0], [0.0, 0.1]], atol=1e-12)


def test_a_principal_point_to_the_right_widens_the_view_to_the_left() -> None:
    shifted = Intrinsics.from_focal(800, 600, 400.0, cx=599.5)  # 600 px to the left, 200 px to the right
    camera = footprint(StereoRig.rectified(shifted, 0.2)).left
    np.testing.assert_allclose(camera.left_edge[0] / camera.left_edge[1], -1.5, atol=1e-12)
    np.testing.assert_allclose(camera.right_edge[0] / camera.right_edge[1], 0.5, atol=1e-12)


def test_toe_in_turns_the_left_camera_to_the_right() -> None:
    view = footprint(StereoRig.verged(WIDE, 0.2, 30.0))
    np.testing.assert_allclose(view.left.center, [-0.1, 0.0], atol=1e-12)
    fifteen = np.radians(15)
    np.testing.assert_allclose(view.left.axis, [np.sin(fifteen), np.cos(fifteen)], atol=1e-12)
    np.testing.assert_allclose(view.right.axis, [-np.sin(fifteen), np.cos(fifteen)], atol=1e-12)
    # the left camera's left edge is 45 - 15 = 30 degrees to the left, its right edge 60 to the right
    np.testing.assert_allclose(view.left.left_edge, [-0.5, np.sqrt(0.75)], atol=1e-12)
    np.testing.assert_allclose(view.left.right_edge, [np.sqrt(0.75), 0.5], atol=1e-12)
    # the inner edges rise at 30 degrees: they meet tan(30) * 0.1 m ahead
    assert view.nearest is not None
    np.testing.assert_allclose(view.nearest, [0.0, 0.1 * np.tan(np.radians(30))], atol=1e-12)


def test_cameras_that_look_apart_share_nothing() -> None:
    narrow = Intrinsics.from_hfov(640, 480, 30.0)
    view = footprint(StereoRig.verged(narrow, 0.3, -60.0))
    assert view.nearest is None
    assert view.blind is None


def test_a_camera_upside_down_sees_the_same_wedge() -> None:
    upright = StereoRig.rectified(WIDE, 0.2)
    rolled = StereoRig(WIDE, WIDE, Pose.from_rotvec((0, 0, np.pi)) @ upright.right_from_left)
    # the rig's frame is halfway, rolled by 90 degrees: compare the widths, which do not depend on it
    camera = footprint(rolled).right
    assert camera.left_edge @ _turned_left(camera.axis) > 0
    assert camera.right_edge @ _turned_left(camera.axis) < 0


def _turned_left(direction: np.ndarray) -> np.ndarray:
    return np.array([-direction[1], direction[0]])


def test_a_lens_that_cannot_be_undistorted_at_the_edge_is_drawn_as_a_pinhole() -> None:
    folded = Intrinsics.from_focal(800, 600, 400.0, lens=BrownConrady(k1=-0.6))
    camera = footprint(StereoRig.rectified(folded, 0.2)).left
    assert np.isfinite(camera.left_edge).all()


def test_clip_of_a_square_by_a_right_angle() -> None:
    camera = footprint(StereoRig.rectified(WIDE, 2.0)).left  # at (-1, 0), 45 degrees to both sides
    square = np.array([[-2.0, 0.0], [0.0, 0.0], [0.0, 1.0], [-2.0, 1.0]])
    seen = camera.clip(square)
    # what is left is the triangle (-1, 0), (0, 1), (-2, 1), of area 1
    x, z = seen.T
    assert abs(np.sum(x * np.roll(z, -1) - z * np.roll(x, -1))) / 2 == pytest.approx(1.0, abs=1e-12)
    assert len(camera.clip(np.array([[-2.0, -1.0], [0.0, -1.0], [0.0, -0.1]]))) == 0


@settings(max_examples=40, deadline=None)
@given(st.floats(0.02, 1.0), st.floats(-15.0, 40.0), st.floats(25.0, 100.0), st.floats(-80.0, 80.0))
def test_the_nearest_overlap_is_where_theory_ends_the_blind_zone(
    baseline: float, vergence: float, hfov: float, doffs: float
) -> None:
    lens = Intrinsics.from_hfov(640, 480, hfov)
    right = Intrinsics.from_focal(640, 480, lens.fx, cx=lens.cx + doffs)
    rig = StereoRig.verged(lens, baseline, vergence, right=right)
    nearest = footprint(rig).nearest
    blind = blind_zone_m(rig)
    if blind < 300 * baseline:
        assert nearest is not None
        # the plan's nearest point is one of those that both cameras see: theory's nearest is no farther
        in_left = rig.rig_from_left.inverse.apply([nearest[0], 0.0, nearest[1]])
        assert in_left[2] >= blind * (1 - 1e-9)
        if rig.is_rectified:
            assert nearest[1] == pytest.approx(blind, rel=1e-6, abs=1e-9)


@settings(max_examples=60, deadline=None)
@given(
    st.floats(0.02, 1.0),
    st.floats(-20.0, 40.0),
    st.floats(25.0, 110.0),
    st.floats(-2.0, 2.0),
    st.floats(0.05, 6.0),
)
def test_a_point_in_the_wedge_is_a_point_in_the_image(
    baseline: float, vergence: float, hfov: float, x: float, z: float
) -> None:
    lens = Intrinsics.from_hfov(640, 480, hfov)
    rig = StereoRig.verged(lens, baseline, vergence)
    view = footprint(rig)
    point_left = rig.rig_from_left.inverse.apply(np.array([[x, 0.0, z]]))
    for camera, uv in zip((view.left, view.right), rig.project(point_left), strict=True):
        u = uv[0, 0]
        margin = min(abs(u + 0.5), abs(u - 639.5)) if np.isfinite(u) else 1.0
        if margin > 1e-6:
            assert bool(camera.sees(np.array([[x, z]]))[0]) == bool(-0.5 <= u <= 639.5)
