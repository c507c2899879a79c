from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.present.kit import format as fmt


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (9.8, "9.80"),
        (9.996, "10.0"),
        (99.96, "100"),
        (0.01234, "0.0123"),
        (1234.5, "1234"),
        (12345.6, "12,346"),
        (-2.5, "−2.50"),
        (0.0, "0"),
        (1e-13, "≈ 0"),
        (math.nan, "–"),
        (math.inf, "–"),
    ],
)
def test_number(value: float, text: str) -> None:
    assert fmt.number(value) == text


@pytest.mark.parametrize(
    ("value", "text"), [(120.0, "120"), (0.25, "0.25"), (882.503, "882.5"), (1200, "1200"), (-0.5, "−0.5")]
)
def test_plain_is_as_short_as_it_can_be(value: float, text: str) -> None:
    assert fmt.plain(value) == text


@pytest.mark.parametrize(
    ("value_mm", "text"),
    [(9.8, "9.80 mm"), (1240.0, "1.24 m"), (0.012, "12.0 µm"), (999.7, "1.00 m"), (0.0, "0 mm")],
)
def test_length_takes_the_unit_that_suits_it(value_mm: float, text: str) -> None:
    assert fmt.length_mm(value_mm) == text
    assert fmt.length(value_mm / 1e3) == text


@pytest.mark.parametrize(
    ("share", "text"), [(1.0, "100"), (0.9999, "> 99.9"), (0.0, "0"), (1e-5, "< 0.1"), (0.703, "70.3")]
)
def test_percent_says_all_and_none_only_when_exact(share: float, text: str) -> None:
    assert fmt.percent(share) == text


def test_thousands_of_a_count_stand_apart() -> None:
    assert fmt.count(2000) == "2,000"
    assert fmt.count(999) == "999"


@given(st.floats(1e-3, 1e6), st.integers(2, 5))
def test_a_number_reads_back_to_its_digits_and_is_never_long(value: float, digits: int) -> None:
    text = fmt.number(value, digits)
    back = float(text.replace(",", ""))
    assert abs(back - value) <= 0.5 * 10 ** (math.floor(math.log10(value)) - digits + 1) * 1.0001 or (
        abs(back - value) <= 0.5000001
    )
    assert len(text) <= 9
