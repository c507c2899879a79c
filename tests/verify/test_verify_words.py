"""What was checked, in words: units, bounds, verdicts, and the rows that are shown as the worst."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from rigsim.present.verify import words
from rigsim.study.verify.result import Check
from rigsim.study.verify.session import gather
from rigsim.study.verify.worst import pixel_errors, worst_rows
from tests.helpers.verify_results import DIAGNOSES, SMALL, one_of, right, swapped, too_far, wasteful


def check(name: str, value: float, low: float, high: float, unit: str = "") -> Check:
    return Check(name, value, low, high, unit, "because")


@pytest.mark.parametrize(
    ("length_m", "said"),
    [
        (1.66, "1.66 m"),
        (0.9999, "1.00 m"),
        (0.35, "350 mm"),
        (1e-9, "1.00 nm"),
        (2.5e-7, "250 nm"),
        (3.1e-6, "3.10 µm"),
        (4e-12, "4.00 pm"),
        (4e-13, "< 1 pm"),
        (0.0, "0 m"),
        (1986.4, "1986 m"),
        (2.5e12, "2.5e12 m"),
        (math.inf, "–"),
    ],
)
def test_lengths(length_m: float, said: str) -> None:
    assert words.length(length_m) == said


@pytest.mark.parametrize(
    ("value", "said"),
    [(0.0, "0"), (0.95449, "0.954"), (1.0, "1.00"), (99.97, "100"), (28048.2, "28048"), (1e-7, "1.0e-7")],
)
def test_numbers(value: float, said: str) -> None:
    assert words.number(value) == said


def test_found_and_allowed() -> None:
    missing = check("answered", 89, 0, 0, "rows")
    assert (words.found(missing, 200), words.allowed(missing)) == ("no point in 89 of 200 rows", "0 rows")
    for n_behind, said in ((89, "point behind in 89 of 200 rows"), (7, "none or behind in 89 of 200 rows")):
        assert words.found(replace(missing, n_behind=n_behind), 200) == said
    assert words.found(check("nowhere", 1, 0, 0, "rows")) == "a point in 1 row"
    assert words.allowed(check("answered", 9, 0, 3, "rows")) == "at most 3 rows"
    exact = check("exact", 1.66, 0, 1e-9, "m")
    assert words.sentence(exact) == "exact: 1.66 m off, allowed at most 1.00 nm"
    assert words.found(check("size", 479.2, 0.95449, 1.5701)) == "479 × expected"
    assert words.allowed(check("size", 479.2, 0.95449, 1.5701)) == "0.954 to 1.57"
    assert words.found(check("unbiased", 3.2, 0, 0.155, "sigma")) == "3.20 sigma"


def test_verdicts() -> None:
    assert words.verdict(one_of(right), False) == "right: all 8 cases passed"
    assert words.verdict(one_of(swapped), False) == "swapped: 7 of 8 cases failed"
    inefficient = "wasteful: all 8 cases passed; 2 of them have larger errors than least squares would leave"
    assert words.verdict(one_of(wasteful), False) == inefficient
    assert words.verdict(one_of(wasteful), True) == "wasteful: 2 of 8 cases failed"
    alone = replace(one_of(wasteful), results=one_of(wasteful).results[:1])
    assert words.verdict(alone, False) == "wasteful: the case passed"


def test_a_diagnosis_that_explains_nothing_new_is_less_likely() -> None:
    said = words.diagnoses(DIAGNOSES)
    assert said[0] == (
        "Diagnosis: swapped-images: Answers are what swapped images give: uv_left and uv_right are exchanged "
        "somewhere. That explains 100 % of the error in 2 failing cases."
    )
    assert [line.split(":")[0] for line in said] == ["Diagnosis", "Less likely", "Diagnosis"]
    assert said[1].endswith(" is taken for its inverse. That explains 70 % of the error in 1 failing case.")


def test_pixel_errors_of_a_point_too_far() -> None:
    result = next(item for item in one_of(too_far).results if item.case.name == "verged exact")
    case = result.case
    # found on the same left ray: the left pixel does not move, the right one does as the point does
    moved = case.rig.project(case.points_left * 1.001)[1] - case.uv_right
    np.testing.assert_allclose(pixel_errors(result), np.linalg.norm(moved, axis=1), rtol=1e-6)
    worst = worst_rows(result, 3)
    assert [row.row for row in worst] == list(np.argsort(-np.linalg.norm(moved, axis=1))[:3])
    assert worst[0].distance_m == pytest.approx(0.001 * float(np.linalg.norm(case.points_left[worst[0].row])))


def test_worst_rows_show_missing_and_wrong_ones() -> None:
    base = one_of(too_far).results[0]
    assert base.found_left is not None
    found = base.found_left.copy()
    found[10:60] = np.nan
    rows = [row.row for row in worst_rows(replace(base, found_left=found), 5)]
    assert rows[:3] == [10, 11, 12]
    assert len(rows) == 5
    assert not set(rows[3:]) & set(range(10, 60))


def test_rounding_is_no_worst_row_beside_missing_ones() -> None:
    base = one_of(right).results[0]
    assert base.found_left is not None
    found = base.found_left.copy()
    found[3:] = np.nan
    assert [row.row for row in worst_rows(replace(base, found_left=found), 4)] == [3, 4, 5, 6]


def test_made_up_points_are_worst() -> None:
    result = next(item for item in one_of(swapped).results if item.case.name == "swapped images")
    rows = worst_rows(result)
    assert len(rows) == 5
    assert all(np.isnan(row.expected_left).all() and np.isfinite(row.found_left).all() for row in rows)


def test_only_what_is_asked_for_is_made() -> None:
    names = [case.name for case in gather(SMALL).cases]
    assert names[:5] == ["rectified exact", "rectified noisy", "far exact", "verged exact", "verged noisy"]
    assert set(names[5:]) == {"behind", "identical images", "swapped images"}
