"""The net holds what it is for: right triangulators pass, and no mutant of them does."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from benchmarks.subjects import mutants_of_files, mutants_on_condition, triangulators
from benchmarks.subjects.mutant import Mutant
from benchmarks.subjects.mutant_names import NAMES, named_right
from benchmarks.subjects.mutants import MUTANTS
from rigsim.rig.arrays import Array
from rigsim.study.verify.checks import statistical_checks
from rigsim.study.verify.runner import FALSE_ALARM, run_case, verify
from rigsim.theory.custom import TriangulatorFunction
from rigsim.theory.triangulation import triangulate
from tests.helpers.sampling import RIGS, noisy, points_in_view
from tests.helpers.verify_results import quick

RIGHT: dict[str, TriangulatorFunction] = {
    "linear": triangulators.linear,
    "midpoint": triangulators.midpoint,
    "opencv": triangulators.opencv,
    "opencv's file": mutants_of_files.as_written,
}
# those on condition need the suite's rigs, and are held to them in test_verify_conditions.py
ALWAYS = [mutant for mutant in MUTANTS if mutant not in mutants_on_condition.MUTANTS]
mutants = pytest.mark.parametrize("mutant", MUTANTS, ids=[mutant.name for mutant in MUTANTS])


@cache
def observations(kind: str) -> tuple[Array, Array]:
    """Exact pixels; of one row nothing is known, and the rays of one meet behind the cameras."""
    rig = RIGS[kind]
    points = np.concatenate([points_in_view(rig, 30, 0.5, 20.0), points_in_view(rig, 10, 150.0, 300.0)])
    uv_left, uv_right = rig.project(points)
    uv_left[3] = np.nan
    behind = -points[5]
    behind_right = rig.right_from_left.apply(behind)
    uv_left[5] = rig.left.denormalize(behind[:2] / behind[2])
    uv_right[5] = rig.right.denormalize(behind_right[:2] / behind_right[2])
    return uv_left, uv_right


@cache
def truth(kind: str) -> Array:
    return triangulate(RIGS[kind], *observations(kind))


def relative_errors(function: TriangulatorFunction, kind: str) -> Array:
    """Distances over depths, (N,); infinite where only one of the two has a point, or rows are missing."""
    uv_left, uv_right = observations(kind)
    found, true = function(RIGS[kind], uv_left.copy(), uv_right.copy()), truth(kind)
    if found.shape != true.shape:
        return np.full(len(true), np.inf)
    known, answered = np.isfinite(true[:, 2]), np.isfinite(found).all(axis=1)
    with np.errstate(invalid="ignore"):
        errors = np.linalg.norm(found - true, axis=1) / true[:, 2]
    return np.where(known & answered, errors, np.where(known == answered, 0.0, np.inf))


@pytest.mark.parametrize("kind", RIGS)
@pytest.mark.parametrize("name", RIGHT)
def test_the_right_ones_are_right(name: str, kind: str) -> None:
    assert relative_errors(RIGHT[name], kind).max() < 1e-9
    nothing = np.empty((0, 2))
    assert RIGHT[name](RIGS[kind], nothing, nothing).shape == (0, 3)


@pytest.mark.parametrize("mutant", ALWAYS, ids=[mutant.name for mutant in ALWAYS])
def test_every_mutant_is_wrong_somewhere(mutant: Mutant) -> None:
    worst = max(relative_errors(mutant.function, kind).max() for kind in RIGS)
    assert (worst > 1e-9) == (not mutant.only_strict)


def test_the_wasteful_one_scatters_more() -> None:
    (wasteful,) = (mutant for mutant in MUTANTS if mutant.only_strict)
    rig = RIGS["rectified"]
    points = points_in_view(rig, 2000, 1.0, 3.0)
    pixels = noisy(rig, points, 0.2)
    spread = [np.std(f(rig, *pixels)[:, 2] - points[:, 2]) for f in (triangulators.linear, wasteful.function)]
    # the disparity's variance of 2 sigma^2 takes in that of v_left - v_right: as much again
    assert spread[1] / spread[0] == pytest.approx(np.sqrt(2), rel=0.05)


def test_names_are_unique_and_each_has_its_diagnosis() -> None:
    assert [mutant.name for mutant in MUTANTS] == list(NAMES)


@pytest.mark.parametrize("name", [*RIGHT, "unchecked"])
def test_the_right_ones_pass(name: str) -> None:
    (result,) = verify(quick().cases, {name: RIGHT.get(name, triangulators.unchecked)})
    assert result.passed()
    assert not result.diagnoses


@pytest.mark.parametrize("mutant", ALWAYS, ids=[mutant.name for mutant in ALWAYS])
def test_no_mutant_passes(mutant: Mutant) -> None:
    share = FALSE_ALARM / sum(statistical_checks(case) for case in quick().cases)
    statuses = (run_case(case, mutant.name, mutant.function, share).status() for case in quick().cases)
    if not mutant.only_strict:
        assert any(status in ("failed", "error") for status in statuses)  # the first is enough
        return
    by_case = {case.name: status for case, status in zip(quick().cases, statuses, strict=True)}
    assert "error" not in by_case.values()
    # cameras that look from two sides make more than half again as much of it: there it fails
    wide = {"convergent noisy", "from the side noisy"}
    assert {name for name, status in by_case.items() if status == "failed"} <= wide


@pytest.mark.parametrize(
    "name", ["swapped-pixels", "no-doffs", "millimetres", "rig-frame", "file-corner-origin"]
)
def test_the_commonest_are_named(name: str) -> None:
    (mutant,) = (mutant for mutant in MUTANTS if mutant.name == name)
    (result,) = verify(quick().cases, {name: mutant.function})
    assert named_right(mutant, result.diagnoses)
