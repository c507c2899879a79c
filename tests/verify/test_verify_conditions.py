"""Mistakes that some rigs or rows alone bring out are caught, named, and told apart by what those share."""

from __future__ import annotations

import re

import cv2
import numpy as np
import pytest

from benchmarks.subjects import triangulators
from benchmarks.subjects.mutant import Mutant
from benchmarks.subjects.mutant_names import named_right
from benchmarks.subjects.mutants_on_condition import MUTANTS
from rigsim.present.kit.mistakes.of_symptoms import numbers as shown
from rigsim.present.kit.mistakes.said import in_words
from rigsim.present.verify.words import says
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.study.verify.case import Case
from rigsim.study.verify.diagnosis.conditions import set_apart
from rigsim.study.verify.diagnosis.diagnosis import diagnose
from rigsim.study.verify.diagnosis.kinds.of_rectification import rectified_cameras
from rigsim.study.verify.diagnosis.reenact import given
from rigsim.study.verify.diagnosis.symptoms_plain import numbers
from rigsim.study.verify.geometries import GEOMETRIES
from rigsim.study.verify.result import Diagnosis
from rigsim.study.verify.runner import run_case
from rigsim.study.verify.suite import stream, synthetic_cases
from rigsim.study.verify.synthetic import exact
from rigsim.theory.custom import TriangulatorFunction

BY_NAME = {geometry.name: geometry for geometry in GEOMETRIES}


@pytest.fixture(scope="module")
def cases() -> list[Case]:
    # those of random rigs too: some conditions hold in them alone
    return [case for case in synthetic_cases("quick", 5) if case.kind != "noisy"]


def diagnosed(cases: list[Case], function: TriangulatorFunction) -> tuple[Diagnosis, ...]:
    return diagnose([run_case(case, "one", function, 1e-6) for case in cases])


def small_case(name: str) -> Case:
    return exact(BY_NAME[name], 5, stream(0, name))


@pytest.mark.parametrize("mutant", MUTANTS, ids=[mutant.name for mutant in MUTANTS])
def test_each_is_caught_without_noise_and_scenes(cases: list[Case], mutant: Mutant) -> None:
    statuses = [run_case(case, "one", mutant.function, 1e-6).status() for case in cases]
    assert {"failed", "error"} & set(statuses)


def test_what_sets_cases_apart_by_hand() -> None:
    # 'toe-out' turns outwards by 12 deg, 'verged' inwards by 20, 'rectified' not at all
    words = in_words(set_apart([small_case("toe-out")], [small_case("verged"), small_case("rectified")]))
    assert words == "only with a turn outwards of 12 deg or more (up to 0 deg passes)"
    # of 'unequal' nothing is special beside itself
    assert in_words(set_apart([small_case("unequal")], [small_case("unequal")])) == "only in unequal exact"


@pytest.mark.parametrize(
    ("name", "condition"),
    [
        ("transposed-beyond-40", "a turn between the cameras of"),
        ("like-lenses-taken-as-equal", "a difference of the focal lengths of"),
        ("normalised-with-k", ""),
        ("rectified-matrices-raw-pixels", ""),
        ("small-angle-rotation", ""),
        ("single-r", ""),
    ],
)
def test_the_diagnosis_names_the_mistake_and_its_condition(
    cases: list[Case], name: str, condition: str
) -> None:
    (mutant,) = (mutant for mutant in MUTANTS if mutant.name == name)
    told = diagnosed(cases, mutant.function)
    assert named_right(mutant, told), told
    assert condition in says(told[0])


def test_a_condition_is_no_excuse_for_a_poor_explanation(cases: list[Case]) -> None:
    """Answers that no known mistake gives, in some cases alone, are not called one of them."""

    def odd(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        points = triangulators.linear(rig, uv_left, uv_right)
        if rig.right_from_left.R[2, 2] < 0.8:
            points = points + 0.3 * np.sin(37 * points[:, ::-1])
        return points

    assert all(diagnosis.explained < 0.9 for diagnosis in diagnosed(cases, odd))


def test_rounding_is_not_called_single_precision(cases: list[Case]) -> None:
    """Pixels with seven digits after the point, cut by a rule that is nobody's: not float32 for certain."""

    def cut(rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        step = 7e-4
        return triangulators.linear(rig, np.round(uv_left / step) * step, np.round(uv_right / step) * step)

    told = diagnosed(cases, cut)
    assert told
    assert all("single" not in diagnosis.mistake for diagnosis in told)
    assert told[0].mistake == "lost-digits"


def test_every_answer_is_zero_only_where_it_is(cases: list[Case]) -> None:
    tiny = diagnosed(cases, lambda rig, a, b: 1e-9 * triangulators.linear(rig, a, b))
    assert all(diagnosis.mistake != "zeros" for diagnosis in tiny)
    zeros = diagnosed(cases, lambda rig, a, b: np.zeros((len(a), 3)))
    assert "zeros" in [diagnosis.mistake for diagnosis in zeros]


def test_rounding_noise_is_printed_as_nothing() -> None:
    assert shown(numbers(np.array([1.5, -2.27e-13, 0.25]))) == "1.5, 0, 0.25"
    assert not re.search("e-", shown(numbers(np.array([0.0, 0.0]))))


@pytest.mark.parametrize("name", ["verged", "rolled", "unequal", "vertical", "upside-down", "left-handed"])
def test_rectified_cameras_are_opencv_s(name: str) -> None:
    rig = BY_NAME[name].rig
    c = triangulators.calibration(rig)
    _, _, P1, P2, *_ = cv2.stereoRectify(
        c.K_left, c.lens_left, c.K_right, c.lens_right, c.size, c.R, c.t.reshape(3, 1), flags=0
    )
    nothing = np.zeros((1, 2))
    left, right, t = rectified_cameras(given([rig], [1], nothing, nothing))
    np.testing.assert_allclose(left.f[0], P1[[0, 1], [0, 1]], rtol=1e-9)
    np.testing.assert_allclose(left.c[0], P1[:2, 2], atol=1e-6)
    np.testing.assert_allclose(right.c[0], P2[:2, 2], atol=1e-6)
    np.testing.assert_allclose(right.f[0] * t[0, :2], P2[:2, 3], atol=1e-6)
