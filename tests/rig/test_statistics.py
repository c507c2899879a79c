"""Sizes of errors, by hand: one definition each, so that no two tables mean different things by one word."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from rigsim.statistics import abs_p95, inner_range, nmad, rms, robust_rms

ERRORS = np.array([1.0, 2.0, 3.0, 4.0, 100.0])
ROOM = Path(__file__).resolve().parents[2] / "rigsim"


def test_values_by_hand():
    assert rms(np.array([3.0, -4.0, 0.0, 0.0])) == 2.5
    assert robust_rms(-ERRORS) == pytest.approx(1.4826 * 3)  # the median of 1 2 3 4 100
    assert nmad(ERRORS) == pytest.approx(1.4826 * 1)  # about 3 they are off by 2 1 0 1 97
    assert nmad(ERRORS - 50) == nmad(ERRORS)
    # linear between the two largest of five: 0.8 of the way
    assert abs_p95(np.array([-1.0, 2.0, -3.0, 4.0, -14.0])) == pytest.approx(4 + 0.8 * 10)


def test_the_outermost_hundredth_is_left_out_and_so_is_what_is_not_finite():
    values = np.concatenate([np.arange(101.0), [np.nan, np.inf]])
    assert inner_range(values) == (1.0, 99.0)
    assert inner_range(values, 0.02) == (2.0, 98.0)


def test_no_errors_have_no_size():
    none = np.empty(0)
    assert all(math.isnan(size(none)) for size in (rms, robust_rms, nmad, abs_p95))
    assert all(map(math.isnan, inner_range(np.array([np.nan]))))


def test_normal_errors_have_one_size_by_both_ways():
    errors = np.random.default_rng(0).normal(0, 3, 200_000)
    assert robust_rms(errors) == pytest.approx(rms(errors), rel=0.01)
    assert nmad(errors + 7) == pytest.approx(3, rel=0.01)


def test_the_factor_of_the_median_stands_in_one_file():
    stated = [
        path.name for path in ROOM.rglob("*.py") if re.search(r"= ?1\.4826|1\.4826 \*", path.read_text())
    ]
    assert stated == ["statistics.py"]
