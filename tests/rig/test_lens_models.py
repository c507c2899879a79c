"""Every lens model: by hand, by laws that hold for all, and against OpenCV where OpenCV has it."""

from __future__ import annotations

import math
from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rigsim
from rigsim.errors import InvalidRange, InvalidRig
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.mei import UnitSphere
from rigsim.rig.lens.registry import BY_NAME

RATIONAL = (-0.21, 0.06, 0.0011, -0.0017, 0.004, 0.12, 0.015, 0.003)
PRISM = (0.0012, -0.0004, -0.0021, 0.0003)
TILT = (0.03, -0.02)

LENSES: tuple[tuple[Lens, float], ...] = (
    (rigsim.BrownConrady(-0.2, 0.05, 0.001, -0.002, 0.003), 40),
    (rigsim.Rational(*RATIONAL), 40),
    (rigsim.Rational(*RATIONAL, *PRISM), 40),
    (rigsim.Rational(*RATIONAL, *PRISM, *TILT), 40),
    (rigsim.KannalaBrandt(0.01, -0.003, 0.0005, -0.0001), 95),
    (rigsim.KannalaBrandt(), 179),
    (rigsim.Mei(1.3, -0.2, 0.03, 0.0007, -0.0009), 95),
    (rigsim.Mei(0.8, -0.3, 0.1, 0.0005, 0.0006), 80),
    (rigsim.DoubleSphere(-0.24, 0.57), 95),
    (rigsim.DoubleSphere(0.1, 0.3), 80),
    (rigsim.Eucm(0.59, 1.13), 95),
    (rigsim.Eucm(0.4, 0.9), 80),
    (rigsim.FieldOfView(0.93), 120),
)
"""With an angle off the axis, deg, up to which each shows everything."""
each_lens = pytest.mark.parametrize(
    ("lens", "field_deg"), LENSES, ids=[f"{lens.model}-{place}" for place, (lens, _) in enumerate(LENSES)]
)


def _points(field_deg: float, count: int = 500, seed: int = 3) -> Array:
    """Points all over a cone about the axis, some metres off."""
    rng = np.random.default_rng(seed)
    angle, turn = np.radians(rng.uniform(0, field_deg, count)), rng.uniform(0, 2 * np.pi, count)
    rays = np.column_stack([np.sin(angle) * np.cos(turn), np.sin(angle) * np.sin(turn), np.cos(angle)])
    return rays * rng.uniform(0.2, 9, (count, 1))


def test_all_models_are_tried() -> None:
    assert {lens.model for lens, _ in LENSES} == set(BY_NAME)


@each_lens
def test_a_ray_comes_back(lens: Lens, field_deg: float) -> None:
    points = _points(field_deg)
    image = lens.project(points)
    assert np.isfinite(image).all()
    unit = points / np.linalg.norm(points, axis=1)[:, None]
    np.testing.assert_allclose(lens.ray(image), unit, rtol=0, atol=1e-12)


@each_lens
def test_only_the_direction_counts_and_the_axis_is_the_middle(lens: Lens, field_deg: float) -> None:
    points = _points(field_deg)
    np.testing.assert_allclose(lens.project(7.5 * points), lens.project(points), rtol=1e-13, atol=1e-15)
    if not (isinstance(lens, rigsim.Rational) and lens.tau_x):
        assert lens.project(np.array([0.0, 0.0, 3.0])).tolist() == [0.0, 0.0]
    assert np.isnan(lens.project(np.array([0.0, 0.0, 0.0]))).all()
    assert np.isnan(lens.project(np.array([np.nan, 0.0, 1.0]))).all()


@each_lens
def test_the_jacobian_is_the_slope(lens: Lens, field_deg: float) -> None:
    points = np.concatenate([_points(field_deg), [[0, 0, 2.0], [1e-9, 0, 2.0]]])
    steps = 1e-5 * np.linalg.norm(points, axis=1)[:, None]
    ahead, behind = ([lens.project(points + side * steps * e) for e in np.eye(3)] for side in (1, -1))
    numeric = (np.stack(ahead, axis=-1) - np.stack(behind, axis=-1)) / (2 * steps[..., None])
    analytic = lens.jacobian(points)
    size = np.abs(analytic).max(axis=(1, 2), keepdims=True)
    assert np.abs((numeric - analytic) / size).max() < 1e-6


@each_lens
def test_it_ends_where_it_turns_back(lens: Lens, field_deg: float) -> None:
    """Along any direction from the axis the image grows, and what ends is hidden for good."""
    angle = np.radians(np.linspace(0.05, 179.5, 4000))
    for turn in np.linspace(0, 2 * np.pi, 7):
        rays = np.column_stack([np.sin(angle) * np.cos(turn), np.sin(angle) * np.sin(turn), np.cos(angle)])
        image = lens.project(rays)
        shown = np.isfinite(image[:, 0])
        assert (shown == lens.sees(rays)).all()
        assert not (np.diff(shown.astype(int)) > 0).any()  # once hidden, hidden for good
        within = image[angle < np.radians(field_deg)] - lens.project(np.array([0, 0, 1.0]))
        assert (np.diff(np.hypot(*within.T)) > 0).all()
        assert np.degrees(angle[shown].max()) > field_deg - 0.1


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(LENSES), st.tuples(*[st.floats(-6, 6)] * 2))
def test_what_it_shows_projects_back(lens: tuple[Lens, float], image: tuple[float, float]) -> None:
    aim = np.array(image)
    ray = lens[0].ray(aim)
    if np.isfinite(ray).all():
        assert np.linalg.norm(ray) == pytest.approx(1, abs=1e-12)
        np.testing.assert_allclose(lens[0].project(ray), aim, rtol=1e-9, atol=1e-9)
    else:
        assert np.isnan(ray).all()


def _camera(lens: Lens | None) -> Intrinsics:
    return Intrinsics(1280, 960, 700.0, 690.0, 633.4, 471.9, lens)


@pytest.mark.parametrize("terms", [5, 8, 12, 14])
def test_opencv_projects_alike(terms: int) -> None:
    coefficients = np.array((*RATIONAL, *PRISM, *TILT)[:terms])
    lens = rigsim.BrownConrady(*coefficients) if terms == 5 else rigsim.Rational(*coefficients)
    points = _points(40)
    expected = cv2.projectPoints(points[:, None], np.zeros(3), np.zeros(3), _camera(None).K, coefficients)
    np.testing.assert_allclose(_camera(lens).project(points), expected[0][:, 0], rtol=0, atol=1e-9)


def test_opencv_s_fisheye_projects_alike() -> None:
    coefficients = np.array([0.01, -0.003, 0.0005, -0.0001])
    points = _points(85)  # OpenCV's ends at 90 degrees
    expected = cv2.fisheye.projectPoints(
        points[:, None], np.zeros(3), np.zeros(3), _camera(None).K, coefficients
    )
    camera = _camera(rigsim.KannalaBrandt(*coefficients))
    np.testing.assert_allclose(camera.project(points), expected[0][:, 0], rtol=0, atol=1e-9)


def test_by_hand() -> None:
    side = np.array([3.0, 0.0, 4.0])  # 5 long
    # second sphere: xi 5 + 4 = 5; sqrt(9 + 25); 3 / (.5 sqrt(34) + .5 * 5)
    assert rigsim.DoubleSphere(0.2, 0.5).project(side)[0] == pytest.approx(6 / (math.sqrt(34) + 5), rel=1e-15)
    # spheroid: sqrt(4 * 9 + 16) = sqrt(52)
    assert rigsim.Eucm(0.5, 4.0).project(side)[0] == pytest.approx(6 / (math.sqrt(52) + 4), rel=1e-15)
    # sphere of 2: 3 / (2 * 5 + 4) = 3 / 14, then 1 + k1 r^2, and p2 3 r^2
    r = 3 / 14
    assert rigsim.Mei(2.0, 0.5, 0.0, 0.0, 0.01).project(side)[0] == pytest.approx(
        r * (1 + 0.5 * r * r) + 0.03 * r * r, rel=1e-15
    )
    # straight to the side: the whole right angle
    assert rigsim.KannalaBrandt(k1=0.1).project(np.array([0, 1.0, 0]))[1] == pytest.approx(
        math.pi / 2 + 0.1 * (math.pi / 2) ** 3, rel=1e-15
    )
    assert rigsim.FieldOfView(1.0).project(np.array([1.0, 0, 0]))[0] == pytest.approx(math.pi / 2, rel=1e-15)
    # a sensor turned about x: y = z / (cos - y sin) of the point, seen from the lens
    assert rigsim.Rational(tau_x=0.1).project(np.array([0, 0.5, 1.0])).tolist() == pytest.approx(
        [0, 0.5 / (math.cos(0.1) - 0.5 * math.sin(0.1))], rel=1e-14
    )


def test_models_that_are_one_another() -> None:
    points = _points(70)
    sphere = rigsim.Eucm(0.4, 1.0).project(points)
    np.testing.assert_allclose(rigsim.DoubleSphere(0.0, 0.4).project(points), sphere, rtol=1e-13)
    # alpha = xi / (1 + xi), and a focal length that much longer
    np.testing.assert_allclose(UnitSphere(0.4 / 0.6).project(points) / 0.6, sphere, rtol=1e-13)
    np.testing.assert_allclose(
        rigsim.Rational(-0.2, 0.05, 0.001, -0.002, 0.003).project(_points(40)),
        rigsim.BrownConrady(-0.2, 0.05, 0.001, -0.002, 0.003).project(_points(40)),
        rtol=1e-14,
    )
    # a pole in the quotient ends the image: 1 - .5 r^2 is 0 at r = sqrt 2
    assert rigsim.Rational(k4=-0.5).fold_radius2 == pytest.approx(2)


@pytest.mark.parametrize(
    "lens", [rigsim.Mei(), rigsim.Eucm(), rigsim.DoubleSphere(), rigsim.FieldOfView(), rigsim.Rational()]
)
def test_one_that_distorts_nothing_is_a_pinhole(lens: Lens) -> None:
    assert _camera(lens).lens is None
    assert rigsim.KannalaBrandt().is_ideal is False  # a fisheye, but no pinhole


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: rigsim.Eucm(1.2, 1.0), "alpha 1.2: must be from 0 to 1"),
        (lambda: rigsim.Eucm(0.5, 0.0), "beta 0: must be > 0"),
        (lambda: rigsim.DoubleSphere(-1.0, 0.5), "xi -1: must be > -1"),
        (lambda: rigsim.Mei(-0.1), "xi -0.1: must be >= 0"),
        (lambda: rigsim.FieldOfView(3.2), "w 3.2 rad: must be >= 0 and below pi"),
        (lambda: rigsim.Rational(tau_x=1.5), "tau_x 1.5 rad: must be less than 80 degrees"),
        (lambda: rigsim.KannalaBrandt(math.nan), "k1 nan: must be a finite number"),
    ],
)
def test_coefficients_that_make_no_lens(make: object, says: str) -> None:
    assert callable(make)
    with pytest.raises(InvalidRig, match=says):
        make()


def test_the_field_of_view_is_the_lens_s() -> None:
    # 300 px a radian, 600 px to either side: 2 rad each
    camera = Intrinsics(1200, 900, 300.0, 300.0, 599.5, 449.5, rigsim.KannalaBrandt())
    assert camera.hfov_deg == pytest.approx(math.degrees(4.0))
    assert camera.vfov_deg == pytest.approx(math.degrees(3.0))
    # a circle that ends within the image, where the polynomial turns back: 1 - .3 t^2 = 0
    small = Intrinsics(1200, 900, 200.0, 200.0, 599.5, 449.5, rigsim.KannalaBrandt(-0.1))
    assert small.hfov_deg == pytest.approx(2 * math.degrees(math.sqrt(1 / 0.3)))
    assert np.isnan(small.ray(np.array([0.0, 449.5]))).all()
    barrel = Intrinsics(640, 480, 400.0, 400.0, 319.5, 239.5, rigsim.BrownConrady(-0.2))
    left, right = barrel.ray(np.array([[-0.5, 239.5], [639.5, 239.5]]))
    assert barrel.hfov_deg == pytest.approx(math.degrees(math.acos(left @ right)))
    assert barrel.hfov_deg > Intrinsics(640, 480, 400.0, 400.0, 319.5, 239.5).hfov_deg


def test_many_points_are_gone_through_in_blocks() -> None:
    camera = _camera(rigsim.KannalaBrandt(0.01, -0.003))
    points = _points(80, 10_000).reshape(50, 200, 3)
    whole = camera.project(points)
    assert whole.shape == (50, 200, 2)
    np.testing.assert_array_equal(whole[31, 7:19], camera.project(points[31, 7:19]))
    np.testing.assert_array_equal(camera.ray(whole)[31, 7:19], camera.ray(whole[31, 7:19]))


@pytest.mark.parametrize("lens", [None, rigsim.KannalaBrandt(0.01)])
def test_shapes_that_are_none(lens: Lens | None) -> None:
    camera = _camera(lens)
    for values in ([1.0, 2.0], 5.0, [1.0, 2.0, 3.0, 4.0], []):
        with pytest.raises(InvalidRange, match=r"points of shape .*: must be \(\.\.\., 3\)"):
            camera.project(values)
        with pytest.raises(InvalidRange, match="points of shape"):
            camera.jacobian(values)
    with pytest.raises(InvalidRange, match="pixels of shape"):
        camera.ray([1.0, 2.0, 3.0])
    with pytest.raises(InvalidRange, match="points 'abc': must be numbers"):
        camera.project("abc")
    assert camera.project(np.empty((0, 3))).shape == (0, 2)
    assert np.isnan(camera.jacobian([0.0, 0.0, -1.0])).all()


@each_lens
def test_slopes_are_what_a_small_change_of_each_coefficient_does(lens: Lens, field_deg: float) -> None:
    points = _points(field_deg, 200)
    slopes = lens.slopes(points)
    assert slopes.shape == (200, 2, len(lens.names()))
    for k, name in enumerate(lens.names()):
        now = getattr(lens, name)
        more, less = (replace(lens, **{name: now + way * 1e-6}).project(points) for way in (1, -1))
        known = np.isfinite(more) & np.isfinite(less)  # the rim moves too
        assert known.mean() > 0.95
        difference = (more - less)[known] / 2e-6
        np.testing.assert_allclose(slopes[..., k][known], difference, rtol=1e-6, atol=1e-6, err_msg=name)


def test_a_slope_by_hand() -> None:
    """``x (1 + k1 r2)`` grows by x r2: half of a half, twice."""
    assert rigsim.BrownConrady().slopes(np.array([[1.0, 1.0, 2.0]]))[0, :, 0].tolist() == [0.25, 0.25]
