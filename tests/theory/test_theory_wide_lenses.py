"""Triangulation and its uncertainty where lenses are no pinholes, past 90 degrees included."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares

import rigsim
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig
from rigsim.theory import limits
from rigsim.theory.epipolar import pair_gap

_POSE = Pose.from_rotvec((0.02, -0.05, 0.03), (-0.11, 0.004, -0.006))


def _fisheye(k1: float = 0.01) -> Intrinsics:
    # 190 degrees on 640 px: 193 px a radian
    return Intrinsics(640, 640, 193.0, 192.0, 321.0, 318.0, rigsim.KannalaBrandt(k1, -0.003, 5e-4, -1e-4))


RIGS = {
    "fisheye": StereoRig(_fisheye(), _fisheye(0.013), _POSE),
    "rational": StereoRig(
        Intrinsics(1280, 720, 700, 698, 640, 352, rigsim.Rational(-0.2, 0.1, 1e-3, -2e-3, 0.01, 0.1, 0.02)),
        Intrinsics(1280, 720, 702, 701, 633, 361, rigsim.Rational(-0.1, 0.1, tau_x=0.02, s1=1e-3)),
        _POSE,
    ),
    "omni": StereoRig(
        Intrinsics(752, 480, 833, 830, 373.8, 253.7, rigsim.Mei(1.3, -0.3, 0.1, 5e-4, 5e-4)),
        Intrinsics(752, 480, 700, 702, 370, 240, rigsim.DoubleSphere(-0.2, 0.57)),
        _POSE,
    ),
}
each_rig = pytest.mark.parametrize("rig", RIGS.values(), ids=RIGS.keys())


def _seen(rig: StereoRig, count: int, seed: int = 2) -> Array:
    """Points .5 to 4 m off in all directions that both images show."""
    rng = np.random.default_rng(seed)
    uv = rng.uniform((-0.5, -0.5), (rig.left.width - 0.5, rig.left.height - 0.5), (12 * count, 2))
    points = rig.left.ray(uv) * rng.uniform(0.5, 4, (len(uv), 1))
    both = rig.right.contains(rig.project(points)[1]) & np.isfinite(points[:, 0])
    # near the line through both cameras no distance can be seen
    along = np.abs(points @ rig.right_from_left.inverse.t) / (np.linalg.norm(points, axis=1) * rig.baseline_m)
    return points[both & (along < 0.9)][:count]


@each_rig
@pytest.mark.parametrize("method", ["optimal", "dlt", "midpoint"])
def test_exact_pixels_give_the_point_back(rig: StereoRig, method: str) -> None:
    points = _seen(rig, 400)
    assert len(points) == 400
    found = rigsim.triangulate(rig, *rig.project(points), method)
    np.testing.assert_allclose(found, points, rtol=0, atol=1e-9)


def test_some_of_them_lie_beside_and_behind() -> None:
    points = _seen(RIGS["fisheye"], 400)
    assert (points[:, 2] < 0).sum() > 5


@each_rig
def test_optimal_is_the_least_squares(rig: StereoRig) -> None:
    rng = np.random.default_rng(5)
    points = _seen(rig, 25)
    uv = np.hstack(rig.project(points)) + 0.25 * rng.standard_normal((25, 4))
    found = rigsim.triangulate(rig, uv[:, :2], uv[:, 2:], "optimal")

    def off(X: Array, seen: Array) -> Array:
        return np.asarray(np.hstack(rig.project(X[None]))[0] - seen)

    for point, seen, start in zip(found, uv, points, strict=True):
        best = least_squares(off, start, args=(seen,), xtol=1e-15, ftol=1e-15, gtol=1e-15, method="lm")
        assert np.linalg.norm(best.x - point) < 1e-6 * np.linalg.norm(point)
        assert (off(point, seen) ** 2).sum() <= (best.fun**2).sum() * (1 + 1e-9)


@each_rig
def test_the_covariance_holds(rig: StereoRig) -> None:
    """Squared errors over their covariance are 3 in the mean: 40,000 of them tell it to 1 %."""
    points = np.repeat(_seen(rig, 40), 1000, axis=0)
    noise = PixelNoise(0.02)
    rng = np.random.default_rng(8)
    uv = np.hstack(rig.project(points)) + 0.02 * rng.standard_normal((len(points), 4))
    error = rigsim.triangulate(rig, uv[:, :2], uv[:, 2:], "optimal") - points
    covariance = rigsim.predict_covariance(rig, points, noise)
    nees = np.einsum("ni,nij,nj->n", error, np.linalg.inv(covariance), error)
    assert np.isfinite(nees).all()
    assert np.sqrt(nees.mean() / 3) == pytest.approx(1, abs=0.02)


@each_rig
def test_the_gap_of_a_pair_is_a_chi_squared(rig: StereoRig) -> None:
    points = _seen(rig, 400)
    rng = np.random.default_rng(4)
    uv = np.hstack(rig.project(points))
    assert np.abs(pair_gap(rig, uv[:, :2], uv[:, 2:], np.eye(4)).off_px).max() < 1e-9
    uv = np.tile(uv, (20, 1)) + 0.1 * rng.standard_normal((8000, 4))
    gap = pair_gap(rig, uv[:, :2], uv[:, 2:], 0.01 * np.eye(4))
    assert np.sqrt(np.mean((gap.off_px / gap.off_std_px) ** 2)) == pytest.approx(1, abs=0.03)


def test_a_pair_of_wide_fisheyes_shares_nearly_all() -> None:
    camera = _fisheye()
    rig = StereoRig.rectified(camera, 0.1)
    assert limits.blind_zone_m(rig) == 0  # each sees the other
    across, up = limits.overlap_fov_deg(rig)
    # far away both see the same
    assert (across, up) == pytest.approx((camera.hfov_deg, camera.vfov_deg), abs=0.1)
    assert limits.field_of_view_deg(camera) == pytest.approx((camera.hfov_deg, camera.vfov_deg))


@each_rig
def test_the_overlap_is_what_projection_says(rig: StereoRig) -> None:
    """The share of left pixels whose point on a plane the right image shows, pixel by pixel."""
    z = 0.4
    u, v = np.meshgrid(np.arange(rig.left.width), np.arange(rig.left.height))
    rays = rig.left.ray(np.stack([u, v], axis=-1).reshape(-1, 2))
    rays = rays[rays[:, 2] > 1e-3]
    shown = rig.right.contains(rig.project(rays / rays[:, 2:] * z)[1])
    expected = shown.sum() / (rig.left.width * rig.left.height)
    assert 0.1 < expected < 0.99
    assert float(limits.overlap_at_depth(rig, z).fraction) == pytest.approx(expected, abs=0.004)


def test_a_pixel_s_width_is_by_the_slope_on_the_axis() -> None:
    def width_m(lens: rigsim.Mei | rigsim.DoubleSphere | rigsim.FieldOfView) -> float:
        camera = Intrinsics(640, 480, 500.0, 500.0, 319.5, 239.5, lens)
        return float(limits.world_per_pixel_m(StereoRig.rectified(camera, 0.1), 2.0))

    # a pinhole's is 2 m / 500 px = 4 mm; the sphere's image is 1 / (1 + xi) of that one, the arc's 2 tan(.5)
    assert width_m(rigsim.Mei(1.2)) == pytest.approx(4e-3 * 2.2, rel=1e-12)
    assert width_m(rigsim.DoubleSphere(-0.2, 0.6)) == pytest.approx(4e-3 * 0.8, rel=1e-12)
    assert width_m(rigsim.FieldOfView(1.0)) == pytest.approx(4e-3 / (2 * np.tan(0.5)), rel=1e-12)


@pytest.mark.parametrize("focal_px", [200.0, 215.0, 400.0])
def test_field_and_overlap_of_equal_cameras_are_one_far_away(focal_px: float) -> None:
    # the corners lie 97, 90 and 49 degrees off the axis
    camera = Intrinsics(480, 480, focal_px, focal_px, 239.5, 239.5, rigsim.KannalaBrandt(0.005, -0.001))
    rig = StereoRig.rectified(camera, 0.1)
    field = limits.field_of_view_deg(camera)
    assert field == pytest.approx((camera.hfov_deg, camera.vfov_deg))
    assert limits.overlap_fov_deg(rig) == pytest.approx(field, abs=0.05)


def test_the_overlap_of_a_cut_out_without_its_principal_point() -> None:
    camera = _fisheye()
    rig = StereoRig.rectified(camera, 0.1).cropped(430, 400, 150, 120)
    across, up = limits.overlap_fov_deg(rig)
    rays = rig.left.ray(np.array([[-0.5, 0.0], [149.5, 0.0]]))  # the row next to the principal point
    angles = np.degrees(np.arctan2(rays[:, 0], rays[:, 2]))
    assert across == pytest.approx(angles[1] - angles[0], abs=0.1)
    assert up > 20
