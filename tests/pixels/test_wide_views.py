"""Pairs of wide lenses rectified to rows about the baseline."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from rigsim import BrownConrady, Intrinsics, KannalaBrandt, Pose, StereoRig
from rigsim.errors import InvalidRange
from rigsim.pixels.dense.pair import dense_of_any
from rigsim.pixels.dense.rectify import rectify
from rigsim.pixels.dense.views import Cylinder, LatLong, view_of
from rigsim.pixels.patches.patches import match_patches
from rigsim.study.measure.matches import patch_matches
from rigsim.study.measure.result import DenseMap

FISHEYE = Intrinsics(320, 300, 95.0, 94.0, 158.7, 151.2, KannalaBrandt(0.01, -0.003))
POSE = Pose.from_rotvec(np.radians([2.0, -3.0, 1.5]), np.array([-0.1, 0.004, 0.006]))
RIG = StereoRig(FISHEYE, replace(FISHEYE, fx=96.0, cx=160.3), POSE)
SPHERE_M = 1.3


def points(n: int = 400) -> np.ndarray:
    """Seen by both cameras: ahead, aside and behind, none near the baseline itself."""
    ray = np.random.default_rng(3).normal(size=(n, 3))
    ray /= np.linalg.norm(ray, axis=1)[:, None]
    ray = ray[(ray[:, 2] > -0.1) & (np.abs(ray[:, 0]) < 0.9)]
    return ray * np.random.default_rng(4).uniform(0.4, 5, len(ray))[:, None]


@pytest.mark.parametrize("lens", [LatLong(), Cylinder()])
def test_views_by_hand_and_back(lens: LatLong | Cylinder) -> None:
    # 30 degrees along x of a point 60 degrees below ahead: tan 30 on a cylinder
    a, b = math.radians(30), math.radians(60)
    point = np.array([[math.sin(a), math.cos(a) * math.sin(b), math.cos(a) * math.cos(b)]]) * 3
    along = a if isinstance(lens, LatLong) else math.tan(a)
    np.testing.assert_allclose(lens.project(point), [[along, b]], atol=1e-12)
    p = points()
    np.testing.assert_allclose(lens.ray(lens.project(p)), p / np.linalg.norm(p, axis=1)[:, None], atol=1e-12)
    h = 1e-6 * np.eye(3)
    slope = np.stack([(lens.project(p + d) - lens.project(p - d)) / 2e-6 for d in h], axis=-1)
    np.testing.assert_allclose(lens.jacobian(p), slope, atol=1e-6)


@pytest.mark.parametrize("view", ["latlong", "cylinder"])
def test_a_point_lies_in_one_row_of_both_pictures(view: str) -> None:
    rectification = rectify(RIG, view_of(view))
    assert rectification.view == view
    p = points()
    left, right = RIG.project(p)
    seen = RIG.left.contains(left) & RIG.right.contains(right)
    p, left, right = p[seen], left[seen], right[seen]
    assert (p[:, 2] < 0).sum() > 10
    rig = rectification.rig
    uv_left = rig.left.project(p @ rectification.rectified_from_left.T)
    uv_right = rig.right.project(RIG.right_from_left.apply(p) @ rectification.rectified_from_right.T)
    np.testing.assert_allclose(uv_left[:, 1], uv_right[:, 1], atol=1e-9)
    assert (uv_left[:, 0] > uv_right[:, 0]).all(), "disparity is positive before infinity"
    np.testing.assert_allclose(rectification.left_pixels(uv_left), left, atol=1e-7)
    np.testing.assert_allclose(rectification.right_pixels(uv_right), right, atol=1e-7)


def test_a_cylinders_disparity_is_baseline_over_distance_from_it() -> None:
    rig = rectify(RIG, "cylinder").rig
    p = np.array([[0.3, 0.8, -0.6]])  # one metre off the baseline
    uv_left, uv_right = rig.project(p)
    assert uv_left[0, 0] - uv_right[0, 0] == pytest.approx(rig.left.fx * RIG.baseline_m / 1.0)


def test_the_plainest_view_is_chosen() -> None:
    half = Pose(np.eye(3), np.array([-0.1, 0, 0]))
    narrow = Intrinsics(320, 240, 200.0, 200.0, 159.5, 119.5, KannalaBrandt(0.01))
    tall = Intrinsics(200, 320, 95.0, 95.0, 99.5, 159.5, KannalaBrandt(0.01))
    for camera, view in ((narrow, "perspective"), (tall, "cylinder"), (FISHEYE, "latlong")):
        assert rectify(StereoRig(camera, camera, half)).view == view
    bent = Intrinsics(320, 240, 200.0, 200.0, 159.5, 119.5, BrownConrady(-0.1))
    assert rectify(StereoRig(bent, bent, half)).rig.left.lens is None
    with pytest.raises(InvalidRange, match="choose one of perspective, cylinder, latlong"):
        view_of("equirect")


def sphere(rig: StereoRig) -> tuple[np.ndarray, np.ndarray]:
    """What both cameras see of the inside of a textured sphere about the left one, drawn by rays."""
    rng = np.random.default_rng(0)
    waves, phases = rng.normal(size=(60, 3)) * 14, rng.uniform(0, 6.28, 60)

    def picture(camera: Intrinsics, left_from_camera: Pose) -> np.ndarray:
        total = np.zeros((camera.height, camera.width))
        for dv in (-0.25, 0.25):
            for du in (-0.25, 0.25):
                v, u = np.mgrid[: camera.height, : camera.width]
                ray = camera.ray(np.stack([u + du, v + dv], axis=-1)) @ left_from_camera.R.T
                along = ray @ left_from_camera.t
                far = -along + np.sqrt(along**2 + SPHERE_M**2 - left_from_camera.t @ left_from_camera.t)
                at = left_from_camera.t + far[..., None] * ray
                total += np.nan_to_num(np.cos(at @ waves.T + phases).sum(axis=-1))
        return np.clip(np.rint(128 + 4 * total), 0, 255).astype(np.uint8)

    return picture(rig.left, Pose()), picture(rig.right, rig.right_from_left.inverse)


@pytest.fixture(scope="module")
def pictures() -> tuple[np.ndarray, np.ndarray]:
    return sphere(RIG)


def test_patches_lie_on_the_sphere_behind_the_cameras_too(pictures: tuple[np.ndarray, np.ndarray]) -> None:
    found = match_patches(*pictures, RIG, n_points=800)
    matches = patch_matches(found, RIG, None)
    assert matches.n > 80
    far = np.linalg.norm(matches.points_left, axis=1)
    assert np.median(far) == pytest.approx(SPHERE_M, rel=0.01)
    behind = matches.points_left[:, 2] < 0
    assert behind.sum() > 5
    assert np.median(far[behind]) == pytest.approx(SPHERE_M, rel=0.05)
    # what is claimed is in pixels of the picture given, where they are known exactly
    ray = RIG.left.ray(matches.uv_left)
    true = RIG.right.project(RIG.right_from_left.apply(ray * SPHERE_M))
    off = np.linalg.norm(matches.uv_right - true, axis=1)
    claimed = found.right_std_px[found.observations.valid]
    assert np.median(off) < 0.1
    assert 0.3 < np.median(off / claimed) < 1.5
    # and not of pictures exchanged: nothing then matches as well
    assert rms_or_inf(pictures[::-1]) > 3 * np.median(off)


def rms_or_inf(pair: tuple[np.ndarray, ...]) -> float:
    from rigsim.errors import MeasurementFailed

    try:
        found = match_patches(*pair, RIG, n_points=300)
    except MeasurementFailed:
        return math.inf
    valid = found.observations.valid
    true = RIG.right.project(
        RIG.right_from_left.apply(RIG.left.ray(found.observations.uv_left[valid]) * SPHERE_M)
    )
    return float(np.median(np.linalg.norm(found.observations.uv_right[valid] - true, axis=1)))


@pytest.mark.parametrize("view", ["latlong", "cylinder", "perspective"])
def test_dense_points_lie_on_the_sphere(pictures: tuple[np.ndarray, np.ndarray], view: str) -> None:
    disparity, rectification = dense_of_any(*pictures, RIG, view=view_of(view))
    picture = np.zeros(disparity.shape, np.uint8)
    dense = DenseMap(
        matcher="sgbm",
        disparity=disparity,
        rig=rectification.rig,
        rectified=True,
        view=rectification.view,
        image_left=picture,
        image_right=picture,
        left_from_rectified=rectification.rectified_from_left.T,
        errors=None,
    )
    found, known = dense.points_left()
    assert known.mean() > 0.4
    far = np.linalg.norm(found, axis=1)
    assert np.median(far) == pytest.approx(SPHERE_M, rel=0.02)
    assert np.mean(np.abs(far / SPHERE_M - 1) < 0.1) > 0.7
