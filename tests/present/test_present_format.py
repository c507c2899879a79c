from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.present.kit import format as fmt
from rigsim.present.sweep.phrases import mm, say
from rigsim.study.design.words import size


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


# --- digits follow the uncertainty ---


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (1.00312, 0.00296, "1.0031 ± 0.0030"),
        (1.00312, 0.000304, "1.00312 ± 0.00030"),
        (29.31, 9.28, "29.3 ± 9.3"),
        (-3.04, 0.42, "−3.04 ± 0.42"),
        (12.8, 0.0996, "12.80 ± 0.10"),  # not 0.100
        (12.8, 0.0994, "12.800 ± 0.099"),
        (49.2, 11.4, "49 ± 11"),
        (12345.6, 99.6, "12,346 ± 100"),
        (-0.00004, 0.0067, "0.0000 ± 0.0067"),  # nothing has no sign
        (0.5, 0.0, "0.500 ± 0"),
        (1.0, 1e-17, "1.00 ± 0"),  # rounding is no uncertainty
        (0.0, 0.0, "0 ± 0"),
        (math.nan, 0.1, "–"),
        (1.0, math.nan, "–"),
        (1.0, math.inf, "–"),
    ],
)
def test_a_value_has_the_digits_that_its_error_leaves(value: float, error: float, text: str) -> None:
    assert fmt.with_error(value, error) == text
    if math.isfinite(value) and math.isfinite(error):
        assert fmt.to_error(value, error) == text.partition(" ")[0]


def test_an_interval_has_two_digits_of_half_its_width() -> None:
    # half of 0.438 - 0.299 is 0.0695: thousandths
    assert fmt.with_interval(0.36218, 0.29904, 0.43848) == ("0.362", "0.299", "0.438")
    # half of 4.7 - 1.3 is 1.7: tenths
    assert fmt.with_interval(2.4449, 1.3, 4.7) == ("2.4", "1.3", "4.7")
    assert fmt.with_interval(2.4449, math.nan, math.nan) == ("2.44", "–", "–")
    # one unit for the three: half of 1.2 - 0.8 m is 0.2 m
    assert fmt.lengths_within(1.0, 0.8, 1.2) == ("1.00 m", "0.80 m", "1.20 m")
    assert fmt.lengths_within(0.00852, 0.00704, 0.0103) == ("8.5 mm", "7.0 mm", "10.3 mm")
    assert fmt.lengths_within(0.00852, math.nan, math.nan) == ("8.52 mm", "–", "–")


@given(st.floats(-1e4, 1e4), st.floats(1e-5, 1e4))
def test_what_is_shown_is_off_by_little_of_the_error(value: float, error: float) -> None:
    shown, shown_error = (
        float(text.replace(",", "").replace("−", "-")) for text in fmt.with_error(value, error).split(" ± ")
    )
    # 0.10 stands for 0.0995 to 0.105, so rounding is at most a twentieth of the error; half a unit from 10 on
    assert abs(shown - value) <= max(0.0505 * error, 0 if error < 9.95 else 0.5) * 1.0001
    assert abs(shown_error - error) <= max(0.0505 * error, 0 if error < 9.95 else 0.5) * 1.0001
    decimals = [len(text.partition(".")[2]) for text in fmt.with_error(value, error).split(" ± ")]
    assert decimals[0] == decimals[1]
    digits = fmt.with_error(value, error).split(" ± ")[1].replace(",", "").replace(".", "").lstrip("0")
    assert len(digits) == 2 or error >= 99.5


@pytest.mark.parametrize(
    ("n_good", "n", "text"),
    [
        (2, 300, "0.67"),  # 0.667 +- 0.47
        (98, 300, "32.7"),  # 32.67 +- 2.7
        (7491, 10_000, "74.9"),  # 74.91 +- 0.43: three digits are enough
        (1, 10, "10"),
        (0, 300, "0"),
        (300, 300, "100"),
        (4, 10_000, "< 0.1"),
        (9_996, 10_000, "> 99.9"),
    ],
)
def test_a_sampled_share_has_the_digits_that_sampling_leaves(n_good: int, n: int, text: str) -> None:
    assert fmt.sampled_percent(n_good, n) == text


def test_sentences_have_no_powers_of_ten() -> None:
    # each was 1e+03 mm, 1.25e+04 mm, 1e+03 mm
    assert mm(999.9) == "1 m"
    assert say("baseline_mm", 12500.0) == "12500 mm of baseline"
    assert size(0.9999) == "1 m"
    assert size(0.9999, 4) == "999.9 mm"
    assert size(1234.0) == "1234 m"
