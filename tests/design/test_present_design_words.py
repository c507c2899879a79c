"""What a design says of built rigs: shares beside the 95 % that are required."""

from __future__ import annotations

from dataclasses import replace

import pytest

from rigsim.present.design.tolerance import advice_says
from rigsim.present.design.words import more_in_pictures
from rigsim.study.design import words
from rigsim.study.design.checks import RequirementCheck
from rigsim.study.design.help import Attempt, Best
from rigsim.study.saying import saying
from rigsim.study.tolerance.count import Count
from rigsim.theory.inverse import Requirement

BEFORE = Best("printed", True, Count(400, 1000))


@pytest.mark.parametrize(
    ("share", "said"),
    [(0.9444, "94"), (0.9461, "94.6"), (0.94999, "94.9"), (0.95, "95"), (0.953, "95"), (0.997, "> 99")],
)
def test_a_share_that_is_too_small_does_not_read_as_the_one_that_is_required(share: float, said: str) -> None:
    assert words.share(share) == said


def test_pictures_that_are_noisier_than_promised_are_told_beside_verified() -> None:
    """By hand: of 450 matches an RMS scatters by 1 / sqrt(900), 3.3 %; three of them are 10 %."""
    asked = Requirement("depth_error", 1e-3, 1.2)
    held = RequirementCheck(asked, 0.467e-3, "points", 200, 1.1, 1.3, measured=0.907e-3, n_measured=450)
    assert held.is_met
    assert more_in_pictures([held], 0.2 / 2**0.5) == (
        "But the measured depth error at 1.2 m is 0.907 mm, 1.9 times the simulated 0.467 mm, which the "
        "scatter of 450 matches does not explain: what is found in these pictures has about 0.27 px of "
        "noise per coordinate, not 0.141. It still meets what is asked, with less left for the build."
    )
    for measured_mm, more in ((0.512, False), (0.516, True), (0.2, False)):
        assert replace(held, measured=measured_mm * 1e-3).is_more_in_pixels is more
    # what misses is told by what was not verified
    assert more_in_pictures([replace(held, measured=1.2e-3)], 0.25) == ""


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
