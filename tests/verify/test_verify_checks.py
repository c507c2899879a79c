"""The checks hold a triangulator to what its pixels allow: no less, and no more."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from rigsim.errors import InvalidRange, TriangulatorTimeout
from rigsim.present.verify import words
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.noise import PixelNoise
from rigsim.rig.stereo import StereoRig
from rigsim.study.triangulators.registry import KNOWN
from rigsim.study.verify.bound import bound, depth_reach
from rigsim.study.verify.case import Case
from rigsim.study.verify.checks import Judgement, judge
from rigsim.study.verify.geometries import GEOMETRIES, Geometry, random_geometry
from rigsim.study.verify.result import Check
from rigsim.study.verify.runner import run_case, verify
from rigsim.study.verify.suite import stream, synthetic_cases
from rigsim.study.verify.synthetic import degenerate, exact, noisy
from rigsim.theory.custom import CheckedTriangulator, TriangulatorFunction
from rigsim.theory.triangulation import METHODS, triangulate

RIG = StereoRig.rectified(Intrinsics.from_focal(1001, 1001, 1000.0), 0.1)
BY_NAME = {geometry.name: geometry for geometry in GEOMETRIES}


def named(judgement: Judgement) -> dict[str, Check]:
    return {check.name: check for check in judgement.checks}


def test_one_pixel_of_disparity_by_hand() -> None:
    # (0, 0, 1) m: u 500 and 400, disparity 100 px; one pixel less is a depth of 100/99 m
    case = Case(
        "by hand",
        "by hand",
        "noisy",
        "",
        RIG,
        np.array([[500.0, 500.0]]),
        np.array([[401.0, 500.0]]),
        np.array([[0.0, 0.0, 1.0]]),
        np.eye(4),
    )
    checks = named(judge(case, np.array([[0.0, 0.0, 100 / 99]]), 1e-3))
    assert checks["size"].value == pytest.approx(math.sqrt(1 / 3))  # one px^2 where three are due
    assert checks["depth"].value == pytest.approx(1 / math.sqrt(2))  # a disparity errs by sqrt(2) px
    assert checks["efficient"].high == pytest.approx(math.sqrt(stats.chi2.isf(5e-4, 3) / 3))
    assert checks["answered"].value == 0


def test_a_micrometre_is_not_exact() -> None:
    case = exact(BY_NAME["rectified"], 50, stream(0, "x"))
    assert named(judge(case, case.points_left, 1e-4))["exact"].ok
    off = named(judge(case, case.points_left + np.array([0, 0, 1e-6]), 1e-4))["exact"]
    assert not off.ok
    assert off.value == pytest.approx(1e-6, rel=1e-3)
    assert 1e-9 <= off.high < 2e-8


def test_the_truth_itself_is_too_good_for_noisy_pixels() -> None:
    case = noisy(BY_NAME["verged"], 500, stream(0, "x"))
    size = named(judge(case, case.points_left, 1e-4))["size"]
    assert size.value == 0
    assert not size.ok


def test_rows_without_an_answer_may_be_nan_behind_or_at_infinity_but_nowhere_else() -> None:
    (swapped,) = (case for case in degenerate(5, stream(0, "x")) if case.name == "swapped images")
    found = np.array([[np.nan] * 3, [0.0, 0.0, -2.0], [0.0, 0.0, 1e12], [0.0, 0.0, 2.0], [0.0, 0.0, 0.0]])
    check = named(judge(swapped, found, 1e-4))["nowhere"]
    assert check.value == 2
    assert not check.ok


def test_what_came_back_behind_a_camera_is_told_from_what_did_not_come_back() -> None:
    case = exact(BY_NAME["rectified"], 50, stream(0, "x"))
    found = case.points_left.copy()
    found[:5] *= -1
    found[5:8] = np.nan
    answered = named(judge(case, found, 1e-4))["answered"]
    assert (answered.name, answered.value, answered.n_behind) == ("answered", 8, 5)


def test_noise_may_push_as_many_rows_behind_the_camera_as_it_does_and_no_more() -> None:
    # disparities of 0.2 px under 0.1 px of noise: sigma_d 0.1414, so 7.9 % are negative
    points_left = np.tile([0.0, 0.0, 500.0], (4000, 1))
    noise = PixelNoise(0.1)
    uv_left, uv_right = noise.apply(*RIG.project(points_left), stream(0, "x"))
    case = Case("far", "far", "noisy", "", RIG, uv_left, uv_right, points_left, noise.covariance_px2)
    found = triangulate(RIG, uv_left, uv_right)
    answered = named(judge(case, found, 1e-4))["answered"]
    expected = 4000 * stats.norm.sf(0.2 / (0.1 * math.sqrt(2)))
    assert answered.ok
    assert answered.value == pytest.approx(expected, rel=0.2)
    lost = found.copy()
    lost[::5] = np.nan
    assert not named(judge(case, lost, 1e-4))["answered"].ok


@pytest.mark.parametrize("name", ["rectified", "forward", "distorted", "far"])
def test_the_bounds_are_quantiles(name: str) -> None:
    # a false alarm probability of 0.2 must come true: 20 % outside size's two sides, and above depth's bound
    geometry, runs = BY_NAME[name], 300
    points = exact(geometry, 60, stream(0, "points"))
    noise = PixelNoise(geometry.noise_px)
    outside = {"size": 0, "depth": 0}
    for seed in range(runs):
        pixels = noise.apply(points.uv_left, points.uv_right, stream(seed, "noise"))
        case = replace(
            points, kind="noisy", uv_left=pixels[0], uv_right=pixels[1], covariance_px2=noise.covariance_px2
        )
        checks = named(judge(case, triangulate(case.rig, *pixels), 0.2))
        low, high = checks["size"].low, checks["efficient"].high
        outside["size"] += not low <= checks["size"].value <= high
        outside["depth"] += checks["depth"].value > checks["depth"].high / 1.5
    for count in outside.values():
        assert stats.binomtest(count, runs, 0.2).pvalue > 1e-3


@pytest.mark.parametrize("method", KNOWN)
def test_correct_triangulators_pass_where_they_apply(method: str) -> None:
    cases = [case for seed in range(3) for case in synthetic_cases("quick", seed)]
    (result,) = verify(cases, {method: KNOWN[method]})
    bad = [(case.case.name, case.failed_checks, case.error) for case in result.results]
    assert result.passed(), [entry for entry in bad if entry[1] or entry[2]]


def test_only_least_squares_is_efficient_with_unequal_cameras() -> None:
    case = noisy(BY_NAME["unequal"], 5000, stream(0, "x"))
    status = {label: run_case(case, label, METHODS[label], 1e-6) for label in ("optimal", "midpoint")}
    assert status["optimal"].status(strict=True) == "passed"
    assert status["midpoint"].status() == "inefficient"
    assert status["midpoint"].status(strict=True) == "failed"
    assert 1.05 < status["midpoint"].efficiency < 1.2


def swapped(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return triangulate(rig, uv_right, uv_left)


def half_pixel(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return triangulate(rig, uv_left + 0.5, uv_right + 0.5)


def other_sign(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
    return -triangulate(rig, uv_left, uv_right)


@pytest.mark.parametrize("mutant", [swapped, half_pixel, other_sign])
def test_a_sign_a_swap_and_half_a_pixel_fail_in_every_geometry(mutant: TriangulatorFunction) -> None:
    for geometry in (*GEOMETRIES, random_geometry(1, stream(0, "rig 1"))):
        result = run_case(exact(geometry, 100, stream(0, "x")), "mutant", mutant, 1e-4)
        assert result.status() == "failed", geometry.name


def test_a_noisy_estimate_is_told_from_an_efficient_one() -> None:
    def wasteful(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        more = stream(0, "more").normal(0, 0.5, uv_left.shape)  # sqrt(0.25^2 + 0.5^2) = 2.2 times the noise
        return triangulate(rig, uv_left + more, uv_right - more)

    case = noisy(BY_NAME["rectified"], 2000, stream(0, "x"))
    result = run_case(case, "wasteful", wasteful, 1e-4)
    assert result.efficiency == pytest.approx(math.sqrt(5), rel=0.15)
    assert {check.name for check in result.failed_checks} >= {"size", "depth"}


def test_what_breaks_is_one_line_and_the_next_case_runs() -> None:
    def broken(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        if rig.is_rectified:
            raise ZeroDivisionError("no\nluck")
        return triangulate(rig, uv_left, uv_right)

    cases = [exact(BY_NAME[name], 10, stream(0, "x")) for name in ("rectified", "verged")]
    (result,) = verify(cases, {"broken": broken})
    first, second = result.results
    assert first.status() == "error"
    assert first.error == "triangulator 'broken' raised ZeroDivisionError: no"
    assert second.status() == "passed"
    assert not result.passed()


def test_the_rows_of_a_case_are_the_same_whatever_else_is_asked_for() -> None:
    alone = {case.name: case for case in synthetic_cases("quick", 5)}
    beside = {case.name: case for case in synthetic_cases("quick", 5, RIG)}
    assert set(beside) - set(alone) == {"your rig exact", "your rig noisy"}
    assert all(np.array_equal(alone[name].uv_left, beside[name].uv_left) for name in alone)


def test_every_case_says_by_itself_what_it_shows() -> None:
    for geometry in GEOMETRIES:
        about = words.about(noisy(geometry, 1, stream(0, "x")))
        assert about.startswith(words.about(exact(geometry, 1, stream(0, "x"))))
        assert f"{geometry.noise_px:g} px of noise" in about


def test_one_that_never_comes_back_is_asked_three_times() -> None:
    calls = []

    class Hanging:
        name = "hanging"

        def __call__(self, rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
            calls.append(len(uv_left))
            raise TriangulatorTimeout("took longer than 1 s")

    cases = [exact(geometry, 5, stream(0, "x")) for geometry in GEOMETRIES[:6]]
    (result,) = verify(cases, {"hanging": CheckedTriangulator(lambda *_: None, "x"), "slow": Hanging()})[1:]
    assert len(calls) == 3
    assert [one.error for one in result.results[3:]] == ["not asked: the 3 cases before took too long"] * 3
    assert not result.passed()


@pytest.mark.parametrize(
    ("left_f", "right_f", "bent"), [(2000.0, 500.0, None), (500.0, 2000.0, None), (700.0, 700.0, -0.25)]
)
def test_lost_rows_are_as_many_as_noise_must_lose_whatever_the_lenses(
    left_f: float, right_f: float, bent: float | None
) -> None:
    def lens(f: float) -> Intrinsics:
        own = None if bent is None else BrownConrady(k1=bent, k2=0.06)
        return replace(Intrinsics.from_focal(1280, 960, f), lens=own)

    rig = StereoRig.rectified(lens(left_f), 0.05, right=lens(right_f))
    far = Geometry("far", rig, (6.0, 40.0), noise_px=1.0)
    case = noisy(far, 20_000, stream(0, "x"))
    found = triangulate(rig, case.uv_left, case.uv_right)
    judgement = judge(case, found, 1e-4)
    answered = named(judgement)["answered"]
    expected = stats.norm.sf(depth_reach(rig, case.points_left, 1.0)).sum()
    assert answered.value > 20
    assert answered.value == pytest.approx(expected, rel=0.25)
    assert all(check.ok for check in judgement.checks), [check for check in judgement.checks if not check.ok]
    # the rows that are lost have the largest errors: what is left is smaller than the bound of all
    assert named(judgement)["size"].value == pytest.approx(
        math.sqrt(bound(rig, case.points_left, 1.0).squares), rel=0.01
    )


@pytest.mark.parametrize("filled", [-1.0, 1e9])
def test_a_missing_pixel_leaves_no_point_anywhere(filled: float) -> None:
    (case,) = (case for case in degenerate(9, stream(0, "x")) if case.name == "missing pixels")
    found = np.where(case.answerable[:, None], case.points_left, filled)
    assert named(judge(case, found, 1e-4))["nowhere"].value == 3
    assert named(judge(case, case.points_left, 1e-4))["nowhere"].ok


def test_many_points_are_found_where_few_are_shared() -> None:
    geometry = BY_NAME["forward"]
    assert len(exact(geometry, 150_000, stream(0, "x"))) == 150_000
    apart = Geometry("apart", StereoRig.verged(RIG.left, 0.1, -120.0), (1.0, 2.0))
    with pytest.raises(InvalidRange, match="turn the cameras towards each other"):
        exact(apart, 10, stream(0, "x"))
