"""Inverse solve against brute force, against `theory.limits`, and published figures backwards."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.special import ndtr

from rigsim.errors import InvalidRange
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.theory.inverse import (
    GATES,
    LOWER,
    Camera,
    Interval,
    Requirement,
    baseline_interval,
    relaxations,
)
from rigsim.theory.inverse_error import P95_OVER_STD, noise_allowed, noise_error
from rigsim.theory.limits import depth_range_for_disparities, overlap_at_depth
from rigsim.theory.uncertainty import depth_bounds, predict_depth_std
from tests.helpers.sampling import close

GRID_M = np.geomspace(1e-5, 1e4, 30_001)
STEP = float(GRID_M[1] / GRID_M[0])  # 1.0007


def brute_force(requirement: Requirement, camera: Camera, noise_px: float) -> NDArray[np.bool_]:
    """Which baselines of the grid meet the requirement, from where rays fall rather than from the table."""
    B, f, Z = GRID_M, camera.focal_px, requirement.depth_m
    half = camera.width_px / 2
    if requirement.kind == "depth_error":
        d = f * B / Z
        h = 1e-4 * d
        slope = (f * B / (d - h) - f * B / (d + h)) / (2 * h)  # dZ/dd, by differences
        sigma = slope * math.hypot(noise_px, noise_px)
        return keeps(sigma / Z, requirement.limit / Z, requirement.per_std)
    if requirement.kind == "far_disparity":
        u_left, u_right = 0.0, f * (0 - B) / Z
        return np.asarray(u_left - u_right >= requirement.limit * math.hypot(noise_px, noise_px))
    if requirement.kind == "max_disparity":
        return np.asarray(0 - f * (0 - B) / Z <= requirement.limit)
    # what each camera's outermost rays reach at Z, and what the two have in common
    left, right = (-half / f * Z, half / f * Z), (B - half / f * Z, B + half / f * Z)
    common = np.minimum(left[1], right[1]) - np.maximum(left[0], right[0])
    if requirement.kind == "overlap":
        return np.asarray(common / (left[1] - left[0]) >= requirement.limit)
    if requirement.kind == "cover":
        return np.asarray(common >= requirement.limit)
    if requirement.kind == "max_baseline":
        return np.asarray(requirement.limit >= B)
    if requirement.kind == "fov":
        edge = np.array([half, f]) / math.hypot(half, f)
        angle = math.acos(edge[1] ** 2 - edge[0] ** 2)  # between the left and the right edge's ray
        return np.full(len(B), angle >= requirement.limit)
    return np.full(len(B), camera.width_px * camera.height_px <= requirement.limit)


def keeps(std: NDArray[np.float64], error: float, per_std: float) -> NDArray[np.bool_]:
    """Whether depths that are off by `std` to first order keep `error`; all are shares of the depth.

    By the first order where all orders are within 1 % of it, else by all of them.
    """

    def whole_within(bound: NDArray[np.float64]) -> NDArray[np.bool_]:
        if per_std == 1:
            return np.asarray(std**2 + 9 * std**4 + 75 * std**6 <= bound**2)
        with np.errstate(divide="ignore"):
            near = np.where(bound < 1, bound / (1 - np.minimum(bound, 1)), np.inf)
        return np.asarray(ndtr(near / std) - ndtr(-bound / (1 + bound) / std) >= 0.95)

    first = std * per_std
    return np.asarray(
        (first <= error) & (whole_within(first * 1.01) | whole_within(np.full(len(std), error)))
    )


@st.composite
def specifications(draw: st.DrawFn) -> tuple[Camera, list[Requirement], float]:
    width, height = draw(st.integers(200, 5000)), draw(st.integers(200, 4000))
    camera = Camera(width, height, width * draw(st.floats(0.3, 3.0)))
    near = draw(st.floats(0.1, 5.0))
    far = near * draw(st.floats(1.2, 20.0))
    noise_px = draw(st.floats(0.02, 1.5))
    inside = st.floats(near, far)
    asked = [Requirement("far_disparity", 4.0, far)]
    for _ in range(draw(st.integers(1, 3))):
        depth = draw(inside)
        per_std = draw(st.sampled_from([1.0, P95_OVER_STD]))
        asked.append(Requirement("depth_error", depth * draw(st.floats(1e-4, 0.3)), depth, per_std))
    asked.append(Requirement("overlap", draw(st.floats(0.0, 0.95)), near))
    options = [
        Requirement("max_disparity", draw(st.floats(16, 1000)), near),
        Requirement("cover", draw(st.floats(0.05, 10)), draw(inside)),
        Requirement("max_baseline", draw(st.floats(0.01, 3))),
        Requirement("fov", draw(st.floats(0.2, 2.5))),
        Requirement("pixels", draw(st.floats(1e5, 2e7))),
    ]
    asked += [option for option in options if draw(st.booleans())]
    return camera, asked, noise_px


@settings(max_examples=200, deadline=None)
@given(specifications())
def test_interval_is_what_brute_force_finds(case: tuple[Camera, list[Requirement], float]) -> None:
    camera, asked, noise_px = case
    found = baseline_interval(camera, asked, noise_px)
    met = {requirement: brute_force(requirement, camera, noise_px) for requirement in asked}
    everywhere = np.logical_and.reduce(list(met.values()))
    gates = [r for r in asked if r.kind in GATES and not met[r].any()]
    assert list(found.failed) == gates
    first = {r: GRID_M[np.argmax(met[r])] for r in asked if r.kind in LOWER}
    last = {
        r: GRID_M[len(GRID_M) - 1 - np.argmax(met[r][::-1])] if met[r].any() else 0.0
        for r in asked
        if r.kind not in LOWER | GATES
    }
    low, high = max(first.values()), min(last.values())
    # a bound below the grid shows as its first value
    close(max(found.lower.baseline_m, GRID_M[0]), low, rtol=STEP - 1)
    if high > 0:
        close(found.upper.baseline_m, high, rtol=STEP - 1)
    else:
        assert found.upper.baseline_m < GRID_M[0] * STEP
    assert found.lower.requirement is not None
    assert found.upper.requirement is not None
    # the same constraint binds, unless two stand within one step of the grid
    assert first[found.lower.requirement] >= low / STEP
    assert last[found.upper.requirement] <= high * STEP
    if everywhere.any():
        assert found.is_feasible
        close([GRID_M[everywhere][0], GRID_M[everywhere][-1]], [low, high], rtol=1e-12)
    elif found.is_feasible:
        assert found.upper.baseline_m / found.lower.baseline_m < STEP**2


@settings(max_examples=200, deadline=None)
@given(specifications())
def test_a_relaxed_requirement_lets_a_rig_through_and_no_less_does(
    case: tuple[Camera, list[Requirement], float],
) -> None:
    camera, asked, noise_px = case
    if baseline_interval(camera, asked, noise_px).is_feasible:
        return
    factors = [found.factor for found in relaxations([camera], asked, noise_px)]
    np.testing.assert_allclose(factors, sorted(factors), rtol=1e-8)
    for found in relaxations([camera], asked, noise_px):
        assert found.factor > 1

        def feasible(value: float, found: object = found.requirement) -> bool:
            changed = [Requirement(r.kind, value, r.depth_m, r.per_std) if r is found else r for r in asked]
            sigma = value if found is None else noise_px
            return baseline_interval(camera, changed, sigma).is_feasible

        old = noise_px if found.requirement is None else found.requirement.limit
        assert feasible(found.needed + 1e-6 * (found.needed - old))
        assert not feasible(found.needed - 1e-3 * (found.needed - old))


def test_ends_satisfy_the_library_s_own_limits() -> None:
    camera = Camera(1280, 720, 900.0)
    errors = [Requirement("depth_error", 0.05, 3.0), Requirement("far_disparity", 4.0, 3.0)]
    for upper in (
        Requirement("max_disparity", 200, 0.5),
        Requirement("overlap", 0.8, 0.5),
        Requirement("cover", 0.6, 0.5),
    ):
        found = baseline_interval(camera, [*errors, upper], 0.25)
        assert found.lower.requirement is errors[0]
        assert found.upper.requirement is upper
        lens = Intrinsics.from_focal(1280, 720, 900.0)
        short, long = (StereoRig.rectified(lens, end.baseline_m) for end in (found.lower, found.upper))
        close(predict_depth_std(short, [[0.2, 0.1, 3.0]], PixelNoise(0.25)), [0.05], rtol=1e-9)
        value = {
            "max_disparity": depth_range_for_disparities(long, 200)[0] / 0.5 * 200,
            "overlap": float(overlap_at_depth(long, 0.5).fraction),
            "cover": float(overlap_at_depth(long, 0.5).width_m),
        }[upper.kind]
        close(value, upper.limit, rtol=1e-9)


def only(camera: Camera, requirement: Requirement, noise_px: float = 0.25) -> Interval:
    return baseline_interval(camera, [requirement], noise_px)


def test_w3_backwards_the_widest_lens_of_a_field_of_view() -> None:
    # Luxonis, "Depth perception": 71.9 deg on 640 / 1280 px is f 441.25 / 882.5; a longer lens is too narrow
    asked = Requirement("fov", math.radians(71.9))
    for width, focal_px in ((640, 441.251), (1280, 882.503)):
        assert not only(Camera(width, 400, focal_px - 0.01), asked).failed
        assert only(Camera(width, 400, focal_px + 0.01), asked).failed == (asked,)


def test_w4_and_w5_backwards_the_baseline_of_a_nearest_depth() -> None:
    # Luxonis: f 441.25, d 50 at 661.9 mm, and minZ 697 / 348 mm of d_max 95, come from 75 mm
    for focal_px, d, nearest_m, rtol in (
        (441.25, 50, 0.6619, 1e-4),
        (882.5, 95, 0.697, 1e-3),
        (441.0, 95, 0.348, 1e-3),
    ):
        found = only(Camera(1280, 800, focal_px), Requirement("max_disparity", d, nearest_m))
        close(found.upper.baseline_m, 0.075, rtol=rtol)


def test_w6_backwards_the_baseline_of_a_dead_band() -> None:
    # Luxonis: HFOV 72 deg, 640 px, a band of 33.03 px at 1 m comes from 75 mm
    camera = Camera(640, 400, Intrinsics.from_hfov(640, 400, 72).fx)
    found = only(camera, Requirement("overlap", 1 - 33.03 / 640, 1.0))
    close(found.upper.baseline_m, 0.075, rtol=2e-4)


def test_w7_backwards_the_baseline_of_a_depth_error() -> None:
    # changh95 visual-slam-roadmap: f 500, .25 px, .02 / .5 / 2 m at 2 / 10 / 20 m come from 0.1 m
    # (at 20 m the first order of 10 % is off by 5 %, so that figure is not asked for here)
    for depth_m, error_m in ((2, 0.02), (6, 0.18)):
        found = only(Camera(640, 480, 500.0), Requirement("depth_error", error_m, depth_m), 0.25 / 2**0.5)
        close(found.lower.baseline_m, 0.1, rtol=1e-9)
        p95 = Requirement("depth_error", error_m * P95_OVER_STD, depth_m, P95_OVER_STD)
        close(only(Camera(640, 480, 500.0), p95, 0.25 / 2**0.5).lower.baseline_m, 0.1, rtol=1e-9)


def test_w8_backwards_the_baseline_of_a_first_order_bound() -> None:
    # g-rousseau pinhole-stereo-error: HFOV 90 deg, 1280 px, 1.5 px at 10 m: [8.10, 13.06] m from 0.1 m;
    # the first-order error of those bounds is their harmonic one, Z^2 p / (f B) = 2.34 m
    camera = Camera(1280, 720, 640.0)
    first_order = (1 / 8.10 - 1 / 13.06) / 2 * 10**2
    rig = StereoRig.rectified(Intrinsics.from_focal(1280, 720, 640.0), 0.1)
    close(np.ravel(depth_bounds(rig, [[0.0, 0.0, 10.0]], 1.5)), [8.10, 13.06], rtol=2e-3)
    close(predict_depth_std(rig, [[0.0, 0.0, 10.0]], PixelNoise(1.5 / 2**0.5)), [first_order], rtol=2e-3)
    # with an error of 23 % the first order asks for too short a baseline: see the higher orders below
    found = only(camera, Requirement("depth_error", first_order, 10.0), 1.5 / 2**0.5)
    assert found.lower.baseline_m > 0.115


def drawn_errors(std: float, n: int = 2_000_000) -> NDArray[np.float64]:
    """Errors of depths 1 / (1 + std n), but for draws beyond four standard deviations."""
    rng = np.random.default_rng(11)
    normal = rng.standard_normal(n)
    normal = normal[np.abs(normal) < 4]
    return np.asarray(1 / (1 + std * normal) - 1)


@pytest.mark.parametrize("std", [0.06, 0.1, 0.15, 0.186])
def test_higher_orders_are_what_noise_does(std: float) -> None:
    errors = drawn_errors(std)
    # at 18.6 % the RMS is 22 %, where the first order is 15 % short, and 2 % are all that three terms leave
    close(noise_error(std), math.sqrt((errors**2).mean()), rtol=0.02)
    close(noise_error(std, p95=True), np.quantile(np.abs(errors), 0.95), rtol=0.01)
    assert noise_error(std) > 1.01 * std


def test_a_depth_error_of_22_percent_by_hand() -> None:
    # a + 9 a^2 + 75 a^3 = 0.22^2 at a = 0.034556: sigma / Z = 0.18589, not 0.22
    a = 0.0345560
    close(a + 9 * a**2 + 75 * a**3, 0.22**2, rtol=2e-4)
    close(noise_allowed(0.22), math.sqrt(a), rtol=2e-4)
    # f 1194.256 px, sigma_d 0.35355 px, 25 m: 25 x 0.35355 / (1194.256 x 0.18589) = 39.81 mm, not 33.6
    camera = Camera(640, 480, 320 / math.tan(math.radians(15)))
    found = only(camera, Requirement("depth_error", 5.5, 25.0))
    close(found.lower.baseline_m, 0.03981, rtol=1e-3)


@pytest.mark.parametrize("p95", [False, True])
def test_the_noise_allowed_is_the_most_that_keeps_the_error(p95: bool) -> None:
    errors = np.geomspace(0.001, 0.45, 300)
    allowed = np.array([noise_allowed(float(error), p95) for error in errors])
    assert (np.diff(allowed) >= 0).all()
    for error, std in zip(errors, allowed, strict=True):
        assert noise_error(float(std) * (1 - 1e-9), p95) <= error
        assert noise_error(float(std) * 1.011, p95) > error
    # where the first order is within 1 % it is what it was
    close(noise_allowed(0.02, p95), 0.02 / (P95_OVER_STD if p95 else 1), rtol=1e-12)


def test_relaxing_by_hand() -> None:
    # f 1000, sigma_d 0.5: 10 mm at 2 m needs 200 mm; 100 px at 0.5 m allows 50 mm: a factor of four
    camera = Camera(1280, 960, 1000.0)
    asked = [Requirement("depth_error", 0.010, 2.0), Requirement("max_disparity", 100, 0.5)]
    noise_px = 0.5 / 2**0.5
    found = baseline_interval(camera, asked, noise_px)
    assert not found.is_feasible
    close([found.lower.baseline_m, found.upper.baseline_m], [0.2, 0.05], rtol=1e-12)
    assert relaxations([camera], asked, noise_px)[-1].requirement is None  # all three are a factor of four
    needed = {r.requirement: r.needed for r in relaxations([camera], asked, noise_px)}
    close([needed[asked[0]], needed[asked[1]], needed[None]], [0.040, 400, noise_px / 4], rtol=1e-12)


def test_two_that_must_both_give_leave_nothing_to_relax() -> None:
    asked = [
        Requirement("depth_error", 0.001, 2.0),
        Requirement("max_disparity", 20, 0.5),
        Requirement("fov", 2.0),
        Requirement("pixels", 1000),
    ]
    assert relaxations([Camera(1280, 960, 1000.0)], asked, 0.25) == ()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Requirement("depth_error", 0.0, 1.0), "must be > 0"),
        (lambda: Requirement("depth_error", 0.01), "distance must be > 0"),
        (lambda: Requirement("overlap", 1.0, 1.0), "must be < 100 %"),
        (lambda: Requirement("fov", 3.2), "must be < 180 deg"),
        (lambda: Camera(0, 480, 500.0), "must be > 0"),
        (lambda: only(Camera(640, 480, 500.0), Requirement("max_baseline", 1.0), 0.0), "must be > 0"),
    ],
)
def test_what_cannot_be_is_refused(make: object, words: str) -> None:
    assert callable(make)
    with pytest.raises(InvalidRange, match=words):
        make()
