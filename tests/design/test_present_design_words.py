"""What a design says of built rigs: shares beside the 95 % that are required."""

from __future__ import annotations

import pytest

from rigsim.present.design.tolerance import advice_says
from rigsim.study.design import words
from rigsim.study.design.help import Attempt, Best
from rigsim.study.saying import saying
from rigsim.study.tolerance.count import Count

BEFORE = Best("printed", True, Count(400, 1000))


@pytest.mark.parametrize(
    ("share", "said"),
    [(0.9444, "94"), (0.9461, "94.6"), (0.94999, "94.9"), (0.95, "95"), (0.953, "95"), (0.997, "> 99")],
)
def test_a_share_that_is_too_small_does_not_read_as_the_one_that_is_required(share: float, said: str) -> None:
    assert words.share(share) == said


def test_what_is_not_enough_and_what_is_not_told_are_said_apart_with_the_class() -> None:
    short = Attempt(saying("more-pictures"), Count(113_520, 120_000))
    untold = Attempt(saying("known-length", std_mm=0.05), Count(1142, 1200))
    assert (short.count.is_enough, untold.count.is_enough) == (False, None)
    said = advice_says(BEFORE, [untold, short])
    assert said == (
        "The closest is class printed, recalibrated, 40 %; these help it, but not enough alone: ten times "
        "the pictures (94.6 %); these may be enough for it, which so few rigs do not tell: a length known to "
        "0.05 mm (95 %)."
    )
