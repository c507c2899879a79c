"""Tolerances: hand-computed cases, laws, and independent solutions for the batches and the compensator."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import least_squares

from rigsim.api.make_rig import make_rig
from rigsim.errors import InvalidRange
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.motion import Motion
from rigsim.rig.perturbation import NAMES, Perturbation
from rigsim.rig.presets import PRESETS
from rigsim.rig.stereo import StereoRig
from rigsim.study.tolerance.batch import PARAMETERS, RigBatch, read_rays, read_rays_near
from rigsim.study.tolerance.classes import iso_2768_m_mm
from rigsim.study.tolerance.places import places
from rigsim.study.tolerance.recalibration.compensator import Compensator
from rigsim.study.tolerance.run import (
    Build,
    Recalibration,
    ToleranceResult,
    draw,
    make_compensator,
    run_tolerance,
)
from rigsim.study.tolerance.sensitivities import (
    CLASSES,
    QUANTITIES,
    BuildRequirement,
    Causes,
    Tolerances,
    causes,
    first_order,
    sensitivities,
    shared_points,
    with_values,
)
from rigsim.theory.triangulation import triangulate
from tests.helpers.sampling import PLAIN, RIGS, close, points_in_view, rigs

RIG = PRESETS["boards"].rig
STD = np.array([0.005, 0.005, 0.005, 3e-4, 3e-4, 3e-4, 5.0, 5.0, 0.01, 0.01, 5.0, 5.0])
EXACT = np.zeros((1, len(PARAMETERS)))
RANGE = (1.0, 5.0)


def small_run(tolerances: Tolerances, required: BuildRequirement, **more: object) -> ToleranceResult:
    words: dict[str, object] = {"n_rigs": 1000, "n_points": 120, **more}
    used = {key: words.pop(key) for key in ("noise_px", "recalibration") if key in words}
    return run_tolerance(Build(RIG, tolerances, **used), required, RANGE, **words)


def true_rig(rig: StereoRig, theta: Array) -> StereoRig:
    built = Perturbation(**dict(zip(NAMES, map(float, theta), strict=False))).apply(rig)
    right_cy_px, both_focal_px = map(float, theta[len(NAMES) :])
    longer = 1 + both_focal_px / rig.left.fx
    return StereoRig(
        replace(built.left, fx=longer * rig.left.fx, fy=longer * rig.left.fy),
        replace(
            built.right,
            fx=built.right.fx + (longer - 1) * rig.right.fx,
            fy=built.right.fy + (longer - 1) * rig.right.fy,
            cy=built.right.cy + right_cy_px,
        ),
        built.right_from_left,
    )


def test_a_tenth_of_a_degree_of_yaw_is_44_cm_at_5_m() -> None:
    # B 0.1 m, Z 5 m, on the right camera's axis: Z^2 / B x 0.1 deg = 250 x 0.0017453 = 0.436 m, nearer
    rig = StereoRig.rectified(PLAIN, 0.1)
    off = causes(rig, Tolerances(yaw_deg=0.1))
    close(first_order(rig, off, np.array([[0.1, 0.0, 5.0]])), [[-0.4363]], rtol=1e-4)
    # built for real, 0.01 deg is a tenth of that: the second order is below a percent
    theta = np.zeros((1, 12))
    theta[0, NAMES.index("yaw_rad")] = math.radians(0.01)
    pixels = RigBatch(rig, theta).project(np.array([[0.1, 0.0, 5.0]]))[:, 0]
    (found,) = triangulate(rig, pixels[:2].T, pixels[2:].T)
    assert found[2] - 5.0 == pytest.approx(-0.0436, rel=0.01)


def test_tolerances_needed_by_hand() -> None:
    # Z/B dB = 3/0.12 = 25; Z^2/(f B) dc = 9/108 m/px; both are the same all over the image
    off = causes(RIG, Tolerances(baseline_mm=0.2, right_cx_px=0.06, vertical_mm=1.0))
    planes = {depth: shared_points(RIG, depth, 40) for depth in (1.0, 3.0)}
    by_key = {item.key: item for item in sensitivities(RIG, off, planes, BuildRequirement(0.01, 3.0))}
    assert list(by_key)[2] == "vertical_mm"
    baseline, principal = by_key["baseline_mm"], by_key["right_cx_px"]
    close(baseline.depth_rms_mm, [0.2 / 0.12, 5.0])
    close([baseline.common_mm, principal.common_mm], [-5.0, 5.0])
    close([baseline.share, principal.share], [0.5, 0.5])
    # 10 mm are 0.4 mm of baseline or 0.12 px; 95 of 100 normal errors are within 1.96 standard deviations
    exact = np.array([0.4, 0.12])
    close([baseline.needed_alone, principal.needed_alone], exact / 1.95996, rtol=1e-4)
    # the two together are normal as well: each takes half of the variance
    both = np.array([baseline.needed_equal_share, principal.needed_equal_share])
    close(both, exact / 1.95996 / math.sqrt(2), rtol=0.02)
    assert abs(baseline.differing_mm) < 1e-9
    # a vertical shift of the right camera moves no depth, and needs no tolerance
    assert by_key["vertical_mm"].share < 1e-18
    assert by_key["vertical_mm"].needed_alone == math.inf


def test_lenses_that_are_off_by_hand() -> None:
    # 9 px of 900 that both are longer: everything seems 1/100 nearer; v of the right image moves no depth
    off = causes(RIG, Tolerances(both_focal_px=9.0, right_cy_px=3.0))
    close(first_order(RIG, off, np.array([[0.4, 0.1, 3.0]])), [[-0.03, 0.0]], atol=1e-12)


@pytest.mark.parametrize("kind", RIGS)
def test_first_order_is_the_slope_of_what_a_built_rig_measures(kind: str) -> None:
    rig, steps = RIGS[kind], 1e-4 * STD
    points = points_in_view(rig, 20, 1.0, 3.0)
    off = Causes(
        PARAMETERS,
        steps,
        steps,
        np.zeros(len(steps), dtype=bool),
        np.eye(len(steps)),
        np.zeros(len(steps), dtype=bool),
    )
    predicted = first_order(rig, off, points)
    for place, step in enumerate(steps):
        depths = []
        for sign in (1, -1):
            theta = np.zeros(len(steps))
            theta[place] = sign * step
            uv_left, uv_right = true_rig(rig, theta).project(points)
            depths.append(triangulate(rig, uv_left, uv_right)[:, 2])
        close((depths[0] - depths[1]) / 2, predicted[:, place], rtol=1e-4, atol=1e-8)


def test_time_and_temperature_move_the_baseline() -> None:
    # 2 m/s x 1 ms = 2 mm: Z/B x 2 mm = 50 mm further away; 120 mm x 23e-6 x 10 K = 27.6 um: 0.69 mm nearer
    off = causes(RIG, Tolerances(time_offset_ms=1.0, temperature_k=10.0, speed_m_s=2.0))
    close(first_order(RIG, off, np.array([[0.0, 0.1, 3.0]])) * 1e3, [[50.0, -0.69]])
    # witness: the object is seen 2 mm further right by the right camera
    point = np.array([[0.0, 0.1, 3.0]])
    uv_left, _ = RIG.project(point)
    _, uv_right = RIG.project([[0.002, 0.1, 3.0]])
    assert triangulate(RIG, uv_left, uv_right)[0, 2] - 3.0 == pytest.approx(0.050, rel=0.02)


@pytest.mark.parametrize("moving", ["rig", "object"])
def test_a_late_picture_is_the_motion_of_the_rig(moving: str) -> None:
    """The first order of `Motion.apply`, on rigs that are toed in and turned, by a second way."""
    held = Tolerances(
        time_offset_ms=1.0, speed_m_s=0.7, forward_speed_m_s=-1.5, turn_rate_deg_s=40.0, moving=moving
    )
    for rig in (RIG, StereoRig.verged(RIG.left, 0.12, 6.0), make_rig(RIG, roll_deg=20, vertical_mm=9)):
        points = shared_points(rig, 3.0, 50)
        (predicted,) = first_order(rig, causes(rig, held), points).T
        late = [Motion(t, 0.7, -1.5, math.radians(40), moving).apply(rig) for t in (1e-6, -1e-6)]
        after, before = (triangulate(rig, *one.project(points))[:, 2] for one in late)
        close((after - before) / 2 * 1e3, predicted, rtol=2e-3, atol=1e-6)


def test_a_turn_of_the_rig_by_hand() -> None:
    # 60 deg/s x 1 ms = 1.0472e-3 rad; f = 900 px: 0.9425 px less on the right camera's axis, where the swing
    # about the middle adds nothing: Z^2 / (f B) x -0.9425 px at 3 m is -78.54 mm
    held = Tolerances(time_offset_ms=1.0, speed_m_s=0.0, turn_rate_deg_s=60.0)
    (error,) = first_order(RIG, causes(RIG, held), np.array([[0.12, 0.0, 3.0]]))
    assert error * 1e3 == pytest.approx([-78.54], abs=0.01)


def test_uniform_bounds_are_sqrt_3_standard_deviations_wide() -> None:
    off = causes(RIG, Tolerances(yaw_deg=0.3, distribution="uniform"))
    close(off.std, [0.3 / math.sqrt(3)])
    drawn = draw(off, 2000, np.random.default_rng(0)) * off.std
    assert 0.299 < np.abs(drawn).max() <= 0.3
    normal = causes(RIG, Tolerances(yaw_deg=0.3))
    for either in (off, normal):
        close(draw(either, 2000, np.random.default_rng(0)).std(), 1.0, rtol=5e-3)
    # one may be a bound and another a standard deviation
    mixed = causes(RIG, Tolerances(yaw_deg=0.3, roll_deg=0.3, bounds=frozenset({"yaw_deg"})))
    close(mixed.std, [0.3 / math.sqrt(3), 0.3])
    yaw, roll = np.abs(draw(mixed, 2000, np.random.default_rng(0)) * mixed.std).max(axis=0)
    assert 0.299 < yaw <= 0.3
    assert roll > 0.9


@pytest.mark.parametrize("kind", RIGS)
def test_a_batch_is_many_single_rigs(kind: str) -> None:
    rig, rng = RIGS[kind], np.random.default_rng(3)
    points, thetas = points_in_view(rig, 30, *RANGE), rng.standard_normal((4, 12)) * STD
    batch = RigBatch(rig, thetas)
    pixels = batch.project(points)
    for i, theta in enumerate(thetas):
        close(pixels[:, i].T, np.hstack(true_rig(rig, theta).project(points)), rtol=1e-12)
    rays = batch.rays(pixels, read_rays(rig, pixels))
    close(
        np.stack(batch.triangulate(rays), axis=-1), np.broadcast_to(points, (4, 30, 3)), rtol=1e-9, atol=1e-9
    )
    assert np.abs(batch.epipolar_error_px(rays)).max() < 1e-8


@given(rigs(), st.integers(0, 2**32 - 1))
def test_batched_triangulation_is_the_optimal_one(rig: StereoRig, seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = points_in_view(rig, 8, 1.0, 3.0, seed)
    pixels = RigBatch(rig, EXACT).project(points) + 0.1 * rng.standard_normal((4, 1, 8))
    rays = read_rays(rig, pixels)
    found = np.stack(RigBatch(rig, EXACT).triangulate(rays), axis=-1)[0]
    best = triangulate(rig, pixels[:2, 0].T, pixels[2:, 0].T)
    close(found, best, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("kind", RIGS)
def test_one_step_misses_the_optimum_by_the_second_order_alone(kind: str) -> None:
    rig = RIGS[kind]
    points, assumed = points_in_view(rig, 50, *RANGE), RigBatch(rig, EXACT)
    missed = []
    for pitch_rad in (1e-4, 1e-3):
        theta = np.zeros((1, 12))
        theta[0, NAMES.index("pitch_rad")] = pitch_rad
        pixels = RigBatch(rig, theta).project(points)
        best = triangulate(rig, pixels[:2, 0].T, pixels[2:, 0].T)[:, 2]
        missed.append(np.abs(assumed.triangulate(read_rays(rig, pixels))[2][0] - best).max())
        # what is missed is small beside what the pitch does
        assert missed[-1] < 0.01 * np.abs(best - points[:, 2]).max()
    # ten times the pitch: a hundred times as much, not ten
    assert missed[1] > 50 * missed[0] or missed[1] < 1e-9


def test_epipolar_errors_are_pixels() -> None:
    # equal rows: half of a vertical difference belongs to each image, so its distance is 1/sqrt(2)
    points = shared_points(RIG, 2.0, 5)
    pixels = RigBatch(RIG, EXACT).project(points)
    pixels[3] += 0.5
    error = RigBatch(RIG, EXACT).epipolar_error_px(read_rays(RIG, pixels))
    close(np.abs(error), np.full((1, 5), 0.5 / math.sqrt(2)), rtol=1e-9)


@pytest.mark.parametrize("kind", RIGS)
def test_rays_read_from_nearby_are_the_same(kind: str) -> None:
    rig, rng = RIGS[kind], np.random.default_rng(7)
    points = points_in_view(rig, 200, *RANGE)
    # ten times what a printed rig is off by in the lenses
    thetas = rng.standard_normal((40, 12)) * STD * np.array([1, 1, 1, 1, 1, 1, 10, 10, 5, 5, 10, 10])
    pixels = RigBatch(rig, thetas).project(points)
    near, far = read_rays_near(rig, pixels, points), read_rays(rig, pixels)
    for one, other in zip((*near.left, *near.right), (*far.left, *far.right), strict=True):
        assert np.array_equal(np.isnan(one), np.isnan(other))
        close(one, other, rtol=0, atol=1e-9)


def test_points_behind_or_folded_are_nan() -> None:
    thetas = np.zeros((2, 12))
    thetas[1, NAMES.index("both_k1")] = -0.5
    wide = np.array([[0.95, 0.0, 1.0], [0.0, 0.0, -1.0], [0.1, 0.0, 1.0]])
    pixels = RigBatch(RIG, thetas).project(wide)
    assert np.isnan(pixels[0]).tolist() == [[False, True, False], [True, True, False]]


def test_first_order_is_the_monte_carlo_for_small_errors() -> None:
    result = small_run(CLASSES["calibrated"].tolerances(RIG), BuildRequirement(0.04, 3.0), n_rigs=4000)
    for depth in result.depths:
        assert not depth.parts
        assert depth.first_order_mm / depth.rms_mm == pytest.approx(1.0, abs=0.02)
        assert depth.first_over_simulated == pytest.approx(1.0, abs=0.02)


def test_where_they_part_is_flagged() -> None:
    result = small_run(CLASSES["printed"].tolerances(RIG), BuildRequirement(0.04, 3.0))
    assert [depth.parts for depth in result.depths] == [True, True, True]
    assert math.isinf(result.depths[-1].built.build_mm.max())


def test_yield_of_one_quantity_by_hand() -> None:
    # 0.2 mm of baseline is 5 mm at 3 m for every point: within 5 mm are 68.27 % of a normal's rigs
    result = small_run(Tolerances(baseline_mm=0.2), BuildRequirement(0.005, 3.0), n_rigs=4000)
    assert result.yield_before == pytest.approx(0.6827, abs=0.003)
    assert result.judged.rms_mm == pytest.approx(5.0, rel=0.003)
    # +-0.2 mm, even: all rigs are within 5 mm, half are within 2.5 mm
    even = Tolerances(baseline_mm=0.2, distribution="uniform")
    assert small_run(even, BuildRequirement(0.0025, 3.0)).yield_before == pytest.approx(0.5, abs=0.003)
    assert small_run(even, BuildRequirement(0.00502, 3.0)).yield_before == 1.0


def test_a_baseline_error_is_removed_by_one_known_length() -> None:
    exact = Recalibration(noise_px=0.0, length_std_mm=1e-4)
    result = small_run(
        Tolerances(baseline_mm=1.0), BuildRequirement(0.001, 3.0), recalibration=exact, n_rigs=200
    )
    recalibrated = result.judged.recalibrated
    assert recalibrated is not None
    after = recalibrated.build_mm
    # 25 mm before; the length is known to 1e-7 m in 1.3 m: 3 m x 1e-7 or so remain
    assert result.judged.rms_mm == pytest.approx(25.0, rel=0.02)
    assert after.max() < 2e-3
    assert result.yield_before < 0.05
    assert result.yield_after == 1.0
    # pitch and roll show in the epipolar errors alone
    turned = small_run(
        Tolerances(pitch_deg=0.2, roll_deg=0.2),
        BuildRequirement(0.001, 3.0),
        recalibration=Recalibration(noise_px=0.0, length_std_mm=1e3),
        n_rigs=200,
    )
    assert turned.judged.recalibrated is not None
    assert turned.judged.rms_mm > 50
    assert turned.judged.recalibrated.build_mm.max() < 0.05


@pytest.mark.parametrize(("tape_mm", "baseline_mm"), [(0.5, 1.0), (5.0, 1.0), (5.0, 0.35)])
def test_an_error_of_the_known_length_scales_every_depth(tape_mm: float, baseline_mm: float) -> None:
    session = Recalibration(noise_px=0.0, length_std_mm=tape_mm)
    result = small_run(
        Tolerances(baseline_mm=baseline_mm),
        BuildRequirement(0.005, 3.0),
        recalibration=session,
        n_rigs=4000,
        n_points=24,
        with_interactions=False,
    )
    judged = result.judged
    assert judged.recalibrated is not None
    assert judged.informed is not None
    # Z s / hypot(L1, L2) by the tape, Z dB / B by the tolerance; they weigh by their inverse squares
    by_tape, by_build = 3.0 * tape_mm / math.hypot(*result.known_lengths_m), 3.0 * baseline_mm / 0.12
    due_mm = 1 / math.hypot(1 / by_tape, 1 / by_build)
    # an RMS of 4000 has a standard error of 1.1 %
    assert math.sqrt((judged.informed.build_mm**2).mean()) == pytest.approx(due_mm, rel=0.04)
    # half a baseline either way is all that is known otherwise: the tape decides
    assert math.sqrt((judged.recalibrated.build_mm**2).mean()) == pytest.approx(by_tape, rel=0.04)


def test_what_comes_after_the_calibration_stays() -> None:
    late = Tolerances(baseline_mm=1.0, temperature_k=20.0)
    exact = Recalibration(noise_px=0.0, length_std_mm=1e-4)
    result = small_run(late, BuildRequirement(0.001, 3.0), recalibration=exact)
    # 120 mm x 23e-6 x 20 = 55.2 um: 1.38 mm at 3 m
    recalibrated = result.judged.recalibrated
    assert recalibrated is not None
    after = recalibrated.build_mm
    assert math.sqrt((after**2).mean()) == pytest.approx(1.38, rel=0.01)


@pytest.mark.parametrize("kind", ["rectified", "verged", "distorted"])
def test_compensator_is_the_least_squares_solution(kind: str) -> None:
    rig, rng = RIGS[kind], np.random.default_rng(5)
    thetas = rng.standard_normal((2, 12)) * STD
    marks = np.array([[-0.3, 0.1, 2.5], [0.4, -0.1, 2.7], [0.0, 0.1, 2.2], [0.1, -0.1, 3.4]])
    compensator = Compensator(rig, points_in_view(rig, 24, *RANGE), marks, STD, noise_px=0.05)
    pixels, lengths_m = compensator.observe(thetas, rng)
    found = compensator.solve(pixels, lengths_m)
    sigma_m = length_sigma(compensator)
    for i in range(len(thetas)):
        reference = least_squares(
            lambda scaled, i=i: independent_residuals(
                compensator, sigma_m, pixels[:, i], lengths_m[i], scaled * STD
            ),
            np.zeros(12),
            xtol=1e-15,
            ftol=1e-15,
            gtol=1e-15,
            x_scale=1.0,
            jac="3-point",
        )
        ours = (compensator.residuals(pixels, lengths_m, found)[i] ** 2).sum()
        assert ours == pytest.approx(2 * reference.cost, rel=1e-6)
        close(found[i] / STD, reference.x, rtol=0, atol=5e-5)


def independent_residuals(
    compensator: Compensator, sigma_m: Array, pixels: Array, known_m: Array, theta: Array
) -> Array:
    """The same residuals with one rig at a time: its own pose, lenses and optimal triangulation."""
    rig = true_rig(compensator.rig, theta)
    left = np.column_stack([rig.left.normalize(pixels[:2].T), np.ones(pixels.shape[1])])
    right = np.column_stack([rig.right.normalize(pixels[2:].T), np.ones(pixels.shape[1])])
    R, t = rig.right_from_left.R, rig.right_from_left.t
    # x_right . (t x R x_left), over its slope in the four pixels
    lines_right, lines_left = np.cross(t, left @ R.T), np.cross(right, t) @ R
    slopes = np.hstack(
        [lines_left[:, :2] / (rig.left.fx, rig.left.fy), lines_right[:, :2] / (rig.right.fx, rig.right.fy)]
    )
    epipolar = (right * lines_right).sum(axis=1) / np.linalg.norm(slopes, axis=1)
    marks = triangulate(rig, pixels[:2, -4:].T, pixels[2:, -4:].T)
    length_error = known_m * (1 - known_m / np.linalg.norm(marks[1::2] - marks[::2], axis=1))
    return np.concatenate(
        [
            epipolar[:-4] / compensator.noise_px,
            length_error / sigma_m,
            theta / compensator.std,
        ]
    )


def length_sigma(compensator: Compensator) -> Array:
    """By finite differences through the triangulation."""
    rig, marks = compensator.rig, compensator.marks_left
    pixels = np.hstack(rig.project(marks))
    variance = np.full(len(marks) // 2, compensator.length_std_m**2)
    for place in np.ndindex(*pixels.shape):
        lengths = []
        for step in (1e-3, -1e-3):
            moved = pixels.copy()
            moved[place] += step
            found = triangulate(rig, moved[:, :2], moved[:, 2:])
            lengths.append(np.linalg.norm(found[1::2] - found[::2], axis=1))
        variance += ((lengths[0] - lengths[1]) / 2e-3 * compensator.noise_px) ** 2
    return np.asarray(np.sqrt(variance))


def test_known_lengths_lie_across_the_middle_and_along_the_depth() -> None:
    off = causes(RIG, CLASSES["machined"].tolerances(RIG))
    compensator = make_compensator(RIG, off, Recalibration(), RANGE)
    # at 3 m both see 1280 - 36 columns; half of them are 622 px, 2.07 m
    # a quarter of 1 to 5 m from either end, and the middle
    close(compensator.marks_left[:, 2], [2, 2, 3, 3, 4, 4, 2, 4])
    _, across_m, _, along_m = compensator.lengths_m
    assert across_m == pytest.approx(622 / 900 * 3, rel=0.01)
    assert along_m == pytest.approx(2.0, rel=0.01)
    assert len(compensator.features_left) == 60
    assert RIG.right.contains(RIG.project(compensator.features_left)[1]).all()
    assert compensator.noise_px == pytest.approx(0.25 / math.sqrt(10))


def test_the_same_seed_builds_the_same_rigs() -> None:
    words = (CLASSES["machined"].tolerances(RIG), BuildRequirement(0.1, 3.0))
    runs = [small_run(*words, seed=seed, n_rigs=50).judged.built.build_mm for seed in (1, 1, 2)]
    assert np.array_equal(runs[0], runs[1])
    assert not np.array_equal(runs[0], runs[2])


@pytest.mark.parametrize("name", CLASSES)
def test_classes_hold_every_calibrated_quantity(name: str) -> None:
    keys = causes(RIG, CLASSES[name].tolerances(RIG)).keys
    shared = tuple(QUANTITIES)[:12]
    if name != "calibrated":
        assert keys == shared
        return
    # a calibration leaves each lens off on its own, and both of them nothing in common
    left = {"left_focal_px", "left_cx_px", "left_cy_px", "left_k1"}
    assert set(keys) == {*shared, *left} - {"both_focal_px", "both_k1"}


def test_classes_follow_from_their_sources() -> None:
    # ISO 2768-1 m: 120 mm +-0.3, 121 mm +-0.5, a 30 mm seat +-0.2, angles of 10 to 50 mm +-30 minutes
    machined = CLASSES["machined"].tolerances(RIG)
    assert (machined.baseline_mm, machined.axial_mm, machined.yaw_deg) == (0.3, 0.2, 0.5)
    wider = StereoRig.rectified(RIG.left, 0.121)
    assert CLASSES["machined"].tolerances(wider).baseline_mm == 0.5
    assert [iso_2768_m_mm(length) for length in (3, 6, 7, 400, 401, 3000)] == [0.1, 0.1, 0.2, 0.5, 0.8, 2.0]
    assert machined.is_bound("yaw_deg")
    assert machined.std("yaw_deg") == pytest.approx(0.5 / math.sqrt(3))
    # filament: +-0.3 mm, or 0.5 % of what is longer than 100 mm; over 30 mm that tilts by 0.573 deg
    printed = CLASSES["printed"].tolerances(RIG)
    assert printed.baseline_mm == pytest.approx(0.6)
    assert printed.pitch_deg == pytest.approx(0.57294, abs=1e-5)
    # a lens of +-5 %: 45 px of 900
    assert printed.both_focal_px == pytest.approx(45.0)
    # the example calibration: 0.6533 px of 1038, 0.3408 px of 1280
    calibrated = CLASSES["calibrated"].tolerances(RIG)
    assert calibrated.right_focal_px / 900 == pytest.approx(0.6533 / 1038.0285, rel=0.01)
    assert calibrated.right_cx_px == pytest.approx(0.3408, rel=0.02)
    assert not calibrated.is_bound("right_cx_px")
    # what is no source's is called an estimate, and what is given is given
    assert (machined.source("yaw_deg"), machined.source("right_k1")) == ("ISO 2768-m", "estimate")
    given_one = with_values(machined, {"yaw_deg": 0.1})
    assert (given_one.source("yaw_deg"), given_one.is_bound("yaw_deg")) == ("given", False)
    assert given_one.is_bound("roll_deg")


def test_more_pictures_and_features_recalibrate_better() -> None:
    def left_mm(**session: float) -> float:
        # a length across the picture says nothing of a focal length that both share
        tolerances = with_values(CLASSES["machined"].tolerances(RIG), {"both_focal_px": 0.0})
        result = small_run(
            tolerances,
            BuildRequirement(0.1, 1.0),
            recalibration=Recalibration(**session),
            n_rigs=200,
        )
        assert result.judged.informed is not None
        return float(np.median(result.judged.informed.build_mm))

    base = left_mm()
    assert left_mm(pictures=100) < 0.9 * base
    assert left_mm(features=240) < 0.95 * base
    assert left_mm(noise_px=1.0) > 1.2 * base


def test_maps_hold_what_the_table_says() -> None:
    result = small_run(CLASSES["calibrated"].tolerances(RIG), BuildRequirement(0.04, 3.0))
    found = places(result)
    assert found.keys == tuple(item.key for item in result.sensitivities[:5])
    assert found.together_mm.shape == (len(found.v_px), len(found.u_px)) == (36, 64)
    worst, seen = result.sensitivities[0], np.isfinite(found.together_mm)
    # the right camera misses the first 36 columns of 1280 at 3 m: two of 64
    assert seen.mean() == pytest.approx(1 - 2 / 64)
    assert found.alone_mm[0][seen].mean() == pytest.approx(worst.common_mm, rel=0.02)
    whole = np.sqrt((found.together_mm[seen] ** 2).mean())
    assert whole == pytest.approx(result.judged.first_order_mm, rel=0.05)


def test_slips_are_named() -> None:
    with pytest.raises(InvalidRange, match="recalibration features 2000: must be <= 1000"):
        Recalibration(features=2000)
    with pytest.raises(InvalidRange, match="recalibration pictures 0: must be >= 1"):
        Recalibration(pictures=0)
    with pytest.raises(InvalidRange, match="tolerance 'tilt': choose one of yaw_deg"):
        Tolerances(yaw_deg=1, bounds=frozenset({"tilt"}))
    with pytest.raises(InvalidRange, match="tolerance yaw_deg -1: must be a finite number >= 0"):
        Tolerances(yaw_deg=-1)
    with pytest.raises(InvalidRange, match="distribution 'flat': choose one of normal, uniform"):
        Tolerances(distribution="flat")
    with pytest.raises(InvalidRange, match="tolerances: all are 0"):
        causes(RIG, Tolerances())
    with pytest.raises(InvalidRange, match="required depth error 0 mm: must be > 0"):
        BuildRequirement(0.0, 3.0)
    with pytest.raises(InvalidRange, match="must be < its distance 3000 mm"):
        BuildRequirement(3.0, 3.0)
    with pytest.raises(InvalidRange, match="depth 10 mm: no point there is in both images"):
        shared_points(RIG, 0.01, 10)
    with pytest.raises(InvalidRange, match="range 5000:1000 mm: must be 0 < near < far"):
        run_tolerance(Build(RIG, Tolerances(yaw_deg=1)), BuildRequirement(0.1, 3.0), (5.0, 1.0))
    with pytest.raises(InvalidRange, match="rigs 1: must be >= 2"):
        small_run(Tolerances(yaw_deg=1), BuildRequirement(0.1, 3.0), n_rigs=1)


def test_a_focal_length_of_both_is_a_share_of_unequal_lenses_too() -> None:
    # 1 % longer, both: every ray seems 1 % steeper and every depth 1/100 nearer, whatever the lenses
    right = Intrinsics.from_focal(1280, 720, 450.0)
    rig = StereoRig.rectified(Intrinsics.from_focal(1280, 720, 900.0), 0.12, right=right)
    points = np.array([[0.4, 0.1, 3.0], [-0.3, -0.2, 3.0]])
    off = causes(rig, Tolerances(both_focal_px=9.0))
    close(first_order(rig, off, points), [[-0.03], [-0.03]], rtol=1e-9)
    pixels = RigBatch(rig, 9.0 * np.eye(len(PARAMETERS))[[PARAMETERS.index("both_focal_px")]]).project(points)
    close(triangulate(rig, pixels[:2, 0].T, pixels[2:, 0].T)[:, 2], [3.0 / 1.01] * 2, rtol=1e-9)
