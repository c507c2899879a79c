"""Counts that no machine can serve: refused with the number and the way out, before memory or time is taken."""

from __future__ import annotations

from pathlib import Path

import pytest

from rigsim.cli import quantity
from rigsim.cli.app import run
from rigsim.errors import InvalidRange
from rigsim.rig import extent

REFUSED = [
    ("tolerance --rigs 100000000 --preset boards", "rigs 100000000, about 40 GB: must be <= 1,000,000"),
    ("tolerance --points 100000000 --preset boards", "points 100000000, about 200 GB: must be <= 100,000"),
    ("sweep --baseline 100 --points 1000000000", "points 1000000000, about 2000 GB: must be <= 1,000,000"),
    ("sweep --baseline 100 --trials 1000000000000", "trials 1000000000000: must be <= 1,000,000"),
    ("sweep --baseline 100 --trials 1000000 --points 1000000", "points times trials 1000000000000: must be"),
    ("sweep --baseline 100 --jobs 1000000", "jobs 1000000, about 450000 GB: must be <= 256"),
    (f"sweep --baseline 100 --jobs 1{'0' * 400}", "must be within 1e308"),
    ("sweep --baseline 1:1000/100000000", "100000000 values, must be <= 1000000"),
    (
        f"sweep --baseline 100 --noise {','.join(map(str, range(1, 2000)))}",
        "noise levels 1999: must be <= 1,000",
    ),
    ("compare --points 10000000000", "points 10000000000: must be between 100 and 1,000,000"),
    (
        "design --range 0.5:3m --depth-error 10mm@3m --lens 100:1000:0.01px",
        "cameras 540006: must be <= 10,000",
    ),
    ("export dataset --format kitti --frames 1000000000", "frames 1000000000: must be <= 100,000"),
]


@pytest.mark.parametrize(("words", "said"), REFUSED)
def test_what_nobody_can_mean_is_refused(
    words: str, said: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    code = run([*words.split(), "--out", str(tmp_path / "out")])
    told = capfd.readouterr().err
    assert code == 2
    assert said in told
    assert told.count("\n") == 1
    assert len(told) < 700
    assert not (tmp_path / "out").exists()


def test_a_count_within_its_bounds_passes() -> None:
    bound = extent.Extent("things", 10, least=2, way_out="take fewer")
    bound.check(2)
    bound.check(10)
    with pytest.raises(InvalidRange, match=r"things 1: must be >= 2$"):
        bound.check(1)
    with pytest.raises(InvalidRange, match=r"things 11: must be <= 10; take fewer$"):
        bound.check(11)


def test_a_range_of_a_million_is_exact() -> None:
    values = quantity.values("0.1:1000/1000000", quantity.BASELINE)
    assert len(values) == 1_000_000
    assert values[0] == 0.1
    assert values[-1] == 1000.0
    # (1 + 9999 * 123456 / 999999) / 10 by hand, to the last bit of a double
    assert values[123456] == (999999 + 9999 * 123456) / 9999990
