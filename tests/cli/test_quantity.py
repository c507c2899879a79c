"""Quantities as people type them: hand cases, laws, and one line for every slip."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rigsim.errors import InvalidRange
from rigsim.rig.quantity import PLAIN
from rigsim.typed import quantity
from rigsim.typed.quantity import BASELINE, DEPTH, FOCAL_PX, HFOV, NOISE, PIXEL_PITCH, VERGENCE


@pytest.mark.parametrize(
    ("text", "expected_mm"),
    [
        ("120", 120.0),
        ("120mm", 120.0),
        ("12cm", 120.0),
        ("0.12m", 120.0),
        ("120000um", 120.0),
        ("120000µm", 120.0),
        (" 120 mm ", 120.0),
        ("1.2e2", 120.0),
        ("+7", 7.0),
        (".5", 0.5),
        ("5.", 5.0),
        ("63.5", 63.5),
    ],
)
def test_length(text: str, expected_mm: float) -> None:
    assert quantity.value(text, BASELINE) == expected_mm


def test_each_option_has_its_own_plain_unit() -> None:
    assert quantity.value("3.45", PIXEL_PITCH) == 0.00345
    assert quantity.value("3.45um", DEPTH) == 0.00345
    assert quantity.value("60deg", HFOV) == quantity.value("60", HFOV) == 60.0
    assert quantity.value("-5", VERGENCE) == -5.0
    assert quantity.value("0", NOISE) == 0.0
    assert quantity.value("1200px", FOCAL_PX) == 1200.0


@pytest.mark.parametrize(
    ("text", "expected_mm"),
    [
        ("50:500", [50, 100, 150, 200, 250, 300, 350, 400, 450, 500]),
        ("50:500:50", [50, 100, 150, 200, 250, 300, 350, 400, 450, 500]),
        ("50:500:100", [50, 150, 250, 350, 450]),
        ("50:500/4", [50, 200, 350, 500]),
        ("50:500/2", [50, 500]),
        ("50,120,500", [50, 120, 500]),
        ("500,50", [500, 50]),
        ("120", [120]),
        ("0.1,0.2", [0.1, 0.2]),
        ("0.1:0.5:0.1", [0.1, 0.2, 0.3, 0.4, 0.5]),
        ("0.1:1", [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]),
        ("1:2:0.3333333333", [1, 4 / 3, 5 / 3, 2]),
        ("1:2:0.3333333334", [1, 4 / 3, 5 / 3, 2]),
    ],
)
def test_range(text: str, expected_mm: list[float]) -> None:
    assert quantity.values(text, BASELINE) == tuple(expected_mm)


@pytest.mark.parametrize(
    "text", ["50:500mm/4", "5:50cm/4", "0.05:0.5m/4", "0.05m:0.5m/4", "50mm:0.5m/4", "5cm:500/4"]
)
def test_units_stand_on_any_part(text: str) -> None:
    assert quantity.values(text, BASELINE) == (50, 200, 350, 500)


@pytest.mark.parametrize(
    ("text", "count", "second"),
    [
        ("50:500", 10, 100),
        ("50:300", 11, 75),  # 250 / 10
        ("100:300", 11, 120),  # 200 / 10 before 200 / 8
        ("0.05:0.3m", 11, 75),
        ("100:400", 10, 100 + 300 / 9),  # no round step at all
    ],
)
def test_a_range_without_a_count_has_round_steps(text: str, count: int, second: float) -> None:
    found = quantity.values(text, quantity.BASELINE)
    assert (len(found), found[1]) == (count, pytest.approx(second))


def test_unit_of_the_last_part_serves_the_whole_list() -> None:
    assert quantity.values("1,2,3cm", BASELINE) == (10, 20, 30)
    assert quantity.values("1mm,2,3cm", BASELINE) == (1, 20, 30)
    assert quantity.values("1cm,2,3", BASELINE) == (10, 2, 3)


def test_step_without_unit_is_in_the_unit_of_the_end() -> None:
    assert quantity.values("0.5:2m:0.5", DEPTH) == (500, 1000, 1500, 2000)
    assert quantity.values("0.5:2m:500mm", DEPTH) == (500, 1000, 1500, 2000)


def test_span() -> None:
    assert quantity.span("0.5:5m", DEPTH) == (500.0, 5000.0)
    assert quantity.span("500:5000", DEPTH) == (500.0, 5000.0)


def test_focal_length_says_its_unit() -> None:
    assert quantity.focal_lengths("1200") == ((1200.0,), "px")
    assert quantity.focal_lengths("1e3px") == ((1000.0,), "px")
    assert quantity.focal_lengths("6mm") == ((6.0,), "mm")
    assert quantity.focal_lengths("4:12mm:4") == ((4.0, 8.0, 12.0), "mm")


def test_resolutions_and_points() -> None:
    assert quantity.resolutions("640x480,1280×960") == ((640, 480), (1280, 960))
    assert quantity.point("980,500.5", "left") == (980.0, 500.5)
    assert quantity.point("-3,0", "left") == (-3.0, 0.0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", ["baseline empty", "must be a number"]),
        ("abc", ["abc", "must be a number"]),
        ("50:", ["empty"]),
        (":", ["empty"]),
        ("50,,60", ["empty"]),
        ("500:50", ["500:50", "end 50 mm must be > start 500 mm", "swap"]),
        ("0.5m:50", ["end 50 mm must be > start 500 mm"]),
        ("50:50", ["one value"]),
        ("50:500:0", ["step 0 mm must be > 0"]),
        ("50:500:-1", ["step -1 mm must be > 0"]),
        ("50:500:451", ["step 451 mm must be <= 450 mm"]),
        ("50:500/1", ["count 1", ">= 2"]),
        ("50:500/0", ["count 0", ">= 2"]),
        ("50:500/2.5", ["count 2.5", "whole"]),
        ("50:500/", ["count empty"]),
        ("50/3", ["50/3", "must be a number"]),
        ("50:500:10/3", ["a:b:step or a:b/count"]),
        ("1:2:3:4", ["a:b:step or a:b/count"]),
        ("1:2,3", ["not both"]),
        ("50mm,5cm", ["50 mm is given twice"]),
        ("nan", ["nan", "finite"]),
        ("50:inf", ["inf", "finite"]),
        ("-infinity", ["finite"]),
        ("1e999", ["1e999", "1e300"]),
        ("1e-999999999", ["1e-300"]),
        ("0", ["0 mm", "must be > 0"]),
        ("-0.12m", ["-120 mm", "must be > 0"]),
        ("0:500", ["0 mm", "must be > 0"]),
        ("-100:100/3", ["-100 mm", "must be > 0"]),
        ("5furlong", ["'furlong'", "um, mm, cm, m"]),
        ("5px", ["'px'"]),
        ("1:1000000000000:1", ["1000000000000 values", "<= 1000000"]),
        ("1:2/9999999", ["9999999 values", "<= 1000000"]),
        ("1:2/99999999999999999999", ["count"]),
        ("1_000", ["must be a number"]),
        ("١٢٠", ["must be a number"]),
    ],
)
def test_slips_are_named_in_one_line(text: str, words: list[str]) -> None:
    with pytest.raises(InvalidRange) as raised:
        quantity.values(text, BASELINE)
    message = str(raised.value)
    assert message.startswith("baseline ")
    assert "\n" not in message
    for word in words:
        assert word in message


@pytest.mark.parametrize("text", ["180", "0", "-10", "200deg", "nan"])
def test_field_of_view_is_bounded(text: str) -> None:
    with pytest.raises(InvalidRange, match="horizontal field of view"):
        quantity.value(text, HFOV)


def test_bounds_of_other_kinds() -> None:
    with pytest.raises(InvalidRange, match=r"noise -0\.1 px: must be >= 0"):
        quantity.values("-0.1,0.2", NOISE)
    with pytest.raises(InvalidRange, match=r"focal length 0 px: must be > 0"):
        quantity.focal_lengths("0")
    with pytest.raises(InvalidRange, match="px or mm, not both"):
        quantity.focal_lengths("6mm,1200px")
    with pytest.raises(InvalidRange, match="unknown unit 'ft'"):
        quantity.focal_lengths("6ft")
    with pytest.raises(InvalidRange, match="vergence"):
        quantity.value("180", VERGENCE)


@pytest.mark.parametrize(
    "text", ["", "640", "640x", "x480", "640x480x3", "-640x480", "640.5x480", "640x480,", "axb"]
)
def test_resolution_slips(text: str) -> None:
    with pytest.raises(InvalidRange, match="WIDTHxHEIGHT"):
        quantity.resolutions(text)


def test_resolution_bounds() -> None:
    with pytest.raises(InvalidRange, match="0x480 px: width and height must be >= 1"):
        quantity.resolutions("0x480")
    with pytest.raises(InvalidRange, match="twice"):
        quantity.resolutions("640x480,640X480")


@pytest.mark.parametrize("text", ["", "980", "980,", "980,500,1", "a,b", "nan,0", "980;500"])
def test_point_slips(text: str) -> None:
    with pytest.raises(InvalidRange, match="left position"):
        quantity.point(text, "left position")


@pytest.mark.parametrize("text", ["5", "5m:0.5m", "0.5:5m/3", "0.5:1:5m", "", "0:5m", "a:b", "1,2"])
def test_span_slips(text: str) -> None:
    with pytest.raises(InvalidRange, match="depth"):
        quantity.span(text, DEPTH)


positive = st.floats(1e-6, 1e6)


@given(positive)
def test_a_number_stays_itself(number: float) -> None:
    assert quantity.values(repr(number), BASELINE) == (number,)


@given(st.integers(1, 10**9), st.sampled_from(["um", "mm", "cm", "m"]))
def test_units_differ_by_powers_of_ten(number: int, unit: str) -> None:
    factor_um = {"um": 1, "mm": 1000, "cm": 10_000, "m": 1_000_000}[unit]
    assert quantity.value(f"{number}{unit}", BASELINE) == number * factor_um / 1000


@given(positive, positive, st.integers(2, 300))
def test_even_values_hold_both_ends_and_rise_evenly(a: float, b: float, count: int) -> None:
    start, stop = sorted((a, b))
    if start == stop:
        return
    found = quantity.values(f"{start!r}:{stop!r}/{count}", BASELINE)
    assert len(found) == count
    assert (found[0], found[-1]) == (start, stop)
    gap = (stop - start) / (count - 1)
    assert all(math.isclose(y - x, gap, abs_tol=4e-16 * stop) for x, y in itertools.pairwise(found))


@given(st.integers(1, 10_000), st.integers(1, 200), st.integers(1, 999), st.integers(0, 3))
def test_a_step_reaches_the_end_it_divides_and_never_passes_it(
    start: int, steps: int, step: int, decimals: int
) -> None:
    scale = 10**decimals
    stop = start + steps * step
    text = f"{start / scale!r}:{stop / scale!r}:{step / scale!r}"
    assert quantity.values(text, BASELINE) == tuple((start + i * step) / scale for i in range(steps + 1))
    short = f"{start / scale!r}:{(stop - 0.5) / scale!r}:{step / scale!r}"
    if steps > 1:
        assert quantity.values(short, BASELINE) == tuple((start + i * step) / scale for i in range(steps))


@given(st.one_of(st.text(max_size=12), st.text("0123456789.:,/-+eEmcux nif", max_size=12)))
def test_any_text_is_read_within_bounds_or_refused(text: str) -> None:
    try:
        found = quantity.values(text, BASELINE)
    except InvalidRange:
        found = ()
    assert all(0 < number < math.inf for number in found)
    assert len(found) <= quantity.MAX_VALUES


def test_numbers_without_a_unit():
    ratio = quantity.QuantityKind("ratio", "", PLAIN, above=0)
    assert quantity.values("10:50/3", ratio) == (10, 30, 50)
    for text, words in (
        ("x", "ratio x: must be a number"),
        ("3mm", "ratio 3mm: unknown unit 'mm'; write none"),
        ("0", "ratio 0: must be > 0"),
    ):
        with pytest.raises(InvalidRange, match=f"^{words}$"):
            quantity.values(text, ratio)
