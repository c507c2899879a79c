"""Pixels, lenses and their derivatives."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from rigsim.errors import InvalidRig
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from tests.helpers.sampling import LENS, cameras, close, vectors

CAMERA = Intrinsics(640, 480, 500.0, 400.0, 300.0, 250.0)


def test_project_by_hand() -> None:
    # u = 500 * 1/4 + 300, v = 400 * (-2)/4 + 250
    close(CAMERA.project([[1.0, -2.0, 4.0]]), [[425.0, 50.0]])
    close(CAMERA.normalize([[425.0, 50.0]]), [[0.25, -0.5]])
    close(CAMERA.K @ [1.0, -2.0, 4.0], [4 * 425.0, 4 * 50.0, 4.0])


def test_distortion_by_hand() -> None:
    # r2 = 0.25 + 0.25 = 0.5, radial = 1 + 0.1*0.5 + 0.02*0.25 + 0.004*0.125 = 1.0555
    lens = BrownConrady(k1=0.1, k2=0.02, p1=0.01, p2=0.03, k3=0.004)
    x = 0.5 * 1.0555 + 2 * 0.01 * 0.5 * -0.5 + 0.03 * (0.5 + 2 * 0.25)
    y = -0.5 * 1.0555 + 0.01 * (0.5 + 2 * 0.25) + 2 * 0.03 * 0.5 * -0.5
    close(lens.distort(np.array([[0.5, -0.5]])), [[x, y]])
    camera = Intrinsics(640, 480, 500.0, 400.0, 300.0, 250.0, lens)
    close(camera.project([[2.0, -2.0, 4.0]]), [[500 * x + 300, 400 * y + 250]])


def test_nothing_is_seen_behind_the_camera() -> None:
    uv = CAMERA.project([[0.0, 0.0, 0.0], [1.0, 1.0, -1.0], [0.0, 0.0, 1e-3], [np.nan, 0.0, 1.0]])
    assert np.isnan(uv[:2]).all()
    close(uv[2], [300.0, 250.0])
    assert np.isnan(uv[3, 0])
    assert np.isnan(CAMERA.jacobian(np.array([[0.0, 0.0, -1.0]])))[0, 0, 0]


@given(cameras(distorted=True), st.floats(-0.7, 0.7), st.floats(-0.5, 0.5), st.floats(0.2, 50.0))
def test_normalize_inverts_project(camera: Intrinsics, x: float, y: float, z: float) -> None:
    close(camera.normalize(camera.project([[x * z, y * z, z]])), [[x, y]], atol=1e-12)


@given(cameras(distorted=True), vectors(1.0), st.floats(0.5, 20.0))
def test_jacobian_is_the_slope_of_project(camera: Intrinsics, direction: np.ndarray, z: float) -> None:
    point = np.array([[0.6 * z * direction[0], 0.5 * z * direction[1], z]])
    step = 1e-6 * z
    slope = np.stack(
        [(camera.project(point + d) - camera.project(point - d)) / (2 * step) for d in step * np.eye(3)],
        axis=-1,
    )
    close(camera.jacobian(point), slope, rtol=1e-6, atol=1e-5 * camera.fx / z)


def test_nothing_is_seen_beyond_the_fold_of_a_lens() -> None:
    # with k1 = -0.3 the radius r (1 - 0.3 r^2) grows to 0.7027 at r^2 = 1/0.9 and then shrinks
    lens = BrownConrady(k1=-0.3)
    close(lens.fold_radius2, 1 / 0.9)
    ideal = lens.undistort(np.array([[0.7, 0.0], [0.72, 0.0], [np.nan, 0.0]]))
    close(ideal[0], [1.0, 0.0])
    assert np.isnan(ideal[1:]).all()
    camera = Intrinsics.from_focal(640, 480, 300.0, lens=lens)
    uv = camera.project([[1.05, 0.0, 1.0], [1.06, 0.0, 1.0], [1.8, 0.0, 1.0]])
    assert camera.contains(uv).tolist() == [True, False, False]


def test_the_first_fold_counts() -> None:
    # slope 1 - 3 s + 2 s^2 = (1 - s)(1 - 2 s) vanishes at s = 0.5 first
    close(BrownConrady(k1=-1.0, k2=0.4).fold_radius2, 0.5)
    assert BrownConrady(k1=0.1, k2=0.02, k3=0.001).fold_radius2 == math.inf
    assert BrownConrady(k1=5e-324).fold_radius2 == math.inf


def test_what_a_lens_shows_is_found_again_up_to_its_fold() -> None:
    # slope 1 + .75 s + s^2 - 1.75 s^3 vanishes at s = 1.26626; r = 1 and r = 1.1 by hand:
    # 1 (1 + .25 + .2 - .25) = 1.2 and 1.1 (1 + .25*1.21 + .2*1.4641 - .25*1.771561) = 1.267672725
    lens = BrownConrady(k1=0.25, k2=0.2, k3=-0.25)
    close(lens.fold_radius2, 1.2662629711920275)
    close(lens.undistort(np.array([[1.2, 0.0], [0.0, -1.267672725]])), [[1.0, 0.0], [0.0, -1.1]], rtol=1e-8)
    # Newton's method from the distorted radius swings between .0037 and 1.0891 for ever here
    cycle = BrownConrady(k1=0.011821624700256717, k2=0.4504636963259353, k3=-0.35584038728036627)
    ideal = np.array([[0.9796696666989924, 0.0]])
    close(cycle.undistort(cycle.distort(ideal)), ideal)


@pytest.mark.parametrize("tangential", [0.0, 0.003, 0.02])
def test_random_lenses_are_inverted_wherever_they_show(tangential: float) -> None:
    rng = np.random.default_rng(8)
    for _ in range(60):
        k1, k2, k3 = rng.uniform(-0.5, 0.5, 3)
        lens = BrownConrady(k1, k2, *rng.uniform(-tangential, tangential, 2), k3)
        camera = Intrinsics.from_focal(1280, 720, float(rng.uniform(300, 2000)), lens=lens)
        radius = min(math.sqrt(lens.fold_radius2), 3.0) * np.sqrt(rng.random(1000))
        angle = rng.uniform(0, 2 * np.pi, 1000)
        points = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.ones(1000)], axis=1)
        uv = camera.project(points)
        shown = camera.contains(uv)
        ideal = camera.normalize(uv[shown])
        assert np.isfinite(ideal).all()
        assert np.abs(camera.project(np.c_[ideal, np.ones(len(ideal))]) - uv[shown]).max(initial=0) < 1e-9
        # the radial fold is sharp: what lies past its image is shown by nothing
        if not tangential and math.isfinite(lens.fold_radius2):
            edge = math.sqrt(lens.fold_radius2) * (1 - 1e-9)
            reach = lens.distort(np.array([[edge, 0.0]]))[0, 0]
            assert np.isnan(lens.undistort(np.array([[reach * 1.0001, 0.0], [0.0, 30.0]]))).all()


@example((0.0, -5.2472246509975805e-158, 0.0, 0.5, 3.42424630571578e-173), 5e-324, 1.5)
@given(st.tuples(*5 * [st.floats(-0.5, 0.5)]), st.floats(0, 1), st.floats(0, 2 * math.pi))
def test_any_lens_is_inverted_within_its_fold(terms: tuple[float, ...], share: float, angle: float) -> None:
    k1, k2, p1, p2, k3 = terms
    lens = BrownConrady(k1, k2, p1 / 25, p2 / 25, k3)
    radius = share * min(math.sqrt(lens.fold_radius2), 2.0)
    ideal = radius * np.array([[math.cos(angle), math.sin(angle)]])
    seen = lens.shows(ideal)
    distorted = lens.distort(ideal)
    found = lens.undistort(distorted)[seen]
    close(lens.distort(found), distorted[seen], rtol=1e-12, atol=1e-12)


def test_p1_and_p2_may_fold_what_the_radial_terms_do_not() -> None:
    # 1 + 3 k1 s + 5 k2 s^2 is least, .049, at s = 1.08; p2 takes 6 * .012 * 1.04 where x < 0
    lens = BrownConrady(k1=-0.587, k2=0.163, p2=0.012)
    assert lens.fold_radius2 == math.inf
    points = np.array([[-1.04, 0.0], [-1.5, 0.0], [1.04, 0.0], [1.5, 0.0]])
    assert lens.shows(points).tolist() == [False, False, True, True]
    # the second sheet repeats pixels of the first
    found = lens.undistort(lens.distort(np.array([[-1.2, 0.0]])))
    assert not np.isfinite(found).any() or -1.0 < found[0, 0] < 0


def test_the_slope_is_unknown_where_the_lens_shows_nothing() -> None:
    lens = BrownConrady(k1=-0.3)
    camera = Intrinsics.from_focal(640, 480, 300.0, lens=lens)
    points = np.array([[1.05, 0.0, 1.0], [1.06, 0.0, 1.0], [0.1, 0.1, -1.0]])
    assert np.isnan(camera.jacobian(points)).any(axis=(1, 2)).tolist() == [False, True, True]
    assert np.isnan(camera.project(points)).any(axis=1).tolist() == [False, True, True]


def test_zero_distortion_is_no_distortion() -> None:
    assert Intrinsics.from_focal(640, 480, 500.0, lens=BrownConrady()).lens is None
    assert Intrinsics.from_focal(640, 480, 500.0, lens=LENS).lens == LENS


def test_field_of_view_spans_the_outer_edges_of_the_pixels() -> None:
    camera = Intrinsics.from_hfov(640, 480, 90.0)
    close([camera.fx, camera.fy, camera.cx, camera.cy], [320.0, 320.0, 319.5, 239.5])
    close(camera.hfov_deg, 90.0)
    close(camera.vfov_deg, 2 * math.degrees(math.atan(240 / 320)))
    close(camera.normalize([[-0.5, 239.5], [639.5, 239.5]])[:, 0], [-1.0, 1.0])
    # off centre: atan(300.5/500) + atan(339.5/500)
    close(CAMERA.hfov_deg, math.degrees(math.atan(300.5 / 500) + math.atan(339.5 / 500)))


def test_from_lens() -> None:
    camera = Intrinsics.from_lens(1280, 960, 6.0, 7.68)
    close([camera.fx, camera.fy, camera.cx, camera.cy], [1000.0, 1000.0, 639.5, 479.5])


def test_contains_ends_half_a_pixel_outside() -> None:
    uv = np.array([[-0.5, -0.5], [639.5, 479.5], [-0.51, 0], [0, 479.51], [np.nan, 0]])
    assert CAMERA.contains(uv).tolist() == [True, True, False, False, False]


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Intrinsics(0, 480, 500, 500, 0, 0), "image width 0 px: must be a whole number >= 1"),
        (lambda: Intrinsics(640, 480.5, 500, 500, 0, 0), "image height 480.5 px: must be a whole number"),
        (lambda: Intrinsics(640, 480, 0, 500, 0, 0), "focal length fx 0 px: must be > 0"),
        (lambda: Intrinsics(640, 480, 500, math.nan, 0, 0), "focal length fy nan px: must be > 0"),
        (lambda: Intrinsics(640, 480, 500, 500, math.inf, 0), "principal point cx inf px: must be a finite"),
        (lambda: Intrinsics.from_hfov(640, 480, 180), "field of view 180 deg: must be > 0 and < 180"),
        (lambda: Intrinsics.from_lens(640, 480, 8, 0), "sensor width 0 mm: must be > 0"),
        (lambda: Intrinsics.from_lens(640, 480, -8, 5), "focal length -8 mm: must be > 0"),
        (lambda: BrownConrady(k2=math.nan), "distortion k2 nan: must be a finite number"),
    ],
)
def test_impossible_cameras_are_named(make, says: str) -> None:
    with pytest.raises(InvalidRig, match=says):
        make()


def test_a_point_all_but_in_the_cameras_plane_is_infinitely_far_off() -> None:
    camera = Intrinsics.from_focal(640, 480, 300.0)
    uv = camera.project([[0.25, 0.0, 3e-308]])
    assert uv[0, 0] == math.inf
    assert not camera.contains(uv).any()
