"""Numbers in sentences have a few digits and no powers of ten."""

from __future__ import annotations

import pytest

from rigsim.digits import length, short


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (290.3, 2, "290"),  # g: 2.9e+02
        (293.7, 2, "294"),
        (19.3, 2, "19"),
        (9.249, 2, "9.2"),
        (99.6, 2, "100"),  # g: 1e+02
        (1234.5, 3, "1234"),
        (0.0000432, 2, "0.000043"),
        (-290.3, 2, "-290"),
        (0.0, 3, "0"),
        (float("inf"), 3, "inf"),
    ],
)
def test_short(value: float, digits: int, text: str) -> None:
    assert short(value, digits) == text


@pytest.mark.parametrize(
    ("length_mm", "digits", "text"),
    [
        (999.9, 3, "1 m"),  # not 1e+03 mm
        (999.9, 4, "999.9 mm"),
        (999.4, 3, "999 mm"),
        (1234.0, 3, "1.23 m"),
        (-1234.0, 3, "-1.23 m"),
        (2.5e6, 3, "2500 m"),
        (0.00002, 3, "0.00002 mm"),
    ],
)
def test_length(length_mm: float, digits: int, text: str) -> None:
    assert length(length_mm, digits) == text
