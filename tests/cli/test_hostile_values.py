"""Counts that no machine can serve: refused with the number, before memory or time is taken."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from rigsim.cli.app import run
from rigsim.errors import InvalidRange, InvalidRig, MeasurementFailed
from rigsim.interop.formats.rig_toml import parse_rig
from rigsim.interop.formats.values import number, shown
from rigsim.interop.formats.yaml_text import yaml_table
from rigsim.pixels.dense.dense import dense_disparity
from rigsim.rig import extent
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.stereo import StereoRig
from rigsim.typed import quantity

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
        "cameras 90001: must be <= 10,000",
    ),
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


HUGE = f"0x{'f' * 100_000}"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"baseline_mm = {HUGE}", "baseline_mm a number of thousands of digits: must be"),
        (f"baseline_mm = {'9' * 1_000_000}", "is not TOML"),
        (f"{'a.' * 50_000}b = 1", "a line with more than 1000 points"),
        ("baseline_mm = 1e999", "must be"),
        (f"{'k' * 100_000} = 1", "unknown key kkk"),
    ],
)
def test_toml_that_nobody_can_mean(text: str, said: str) -> None:
    with pytest.raises(InvalidRig) as caught:
        parse_rig(text)
    assert said in str(caught.value)
    assert len(str(caught.value)) < 400


def test_a_number_of_thousands_of_digits_is_none() -> None:
    table = yaml_table(f"a: {HUGE}\nb: {':'.join(['59'] * 5000)}")
    for key in "ab":
        with pytest.raises(InvalidRig, match=f"{key} inf: must be finite"):
            number(table[key], key)
    assert shown(table["a"]) == "a number of thousands of digits"


@pytest.mark.parametrize(
    "text", ["a: !!timestamp x", "a: !!int x", "a: !!float x", "a: 0x_", "a: 9999-99-99"]
)
def test_yaml_that_lies_about_its_kind(text: str) -> None:
    with pytest.raises(InvalidRig, match="is not YAML"):
        yaml_table(text)


def test_a_rig_of_300_letters(capfd: pytest.CaptureFixture[str]) -> None:
    for name in ("n" * 300 + ".toml", "n" * 300 + ".yaml", "x/" * 3000 + "y"):
        assert run(["calc", "depth", "--z", "3m", "--rig", name]) == 1
        assert "cannot be read (File name too long)" in capfd.readouterr().err


def test_a_golden_folder_of_300_letters(capfd: pytest.CaptureFixture[str]) -> None:
    assert run(["verify", "--golden", "n" * 300]) == 1
    told = capfd.readouterr().err
    assert told.endswith("n: File name too long; name another one\n")
    assert told.count("\n") == 1


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f'"{"x" * 200_000}",b', "is not valid CSV: field larger than field limit"),
        (f"distance_mm,depth_std_mm\n{'9' * 200_000},1", "field larger than field limit"),
        (f"{'a,' * 400_000}\n", "column distance_mm is missing (found a, a, a"),
        ("distance_mm,depth_std_mm\n" + "1000,1\n" * 20_000, "number of rows 20001: must be <= 10,000"),
        ("distance_mm,depth_std_mm\n1000,1\n1e999,1\n", "line 3: distance_mm 1e999: must be a number"),
        ("", "column distance_mm is missing (found nothing)"),
    ],
)
def test_tables_that_nobody_can_mean(
    text: str, said: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "wall.csv"
    path.write_text(text)
    assert run(["infer", "--preset", "boards", "--data", str(path)]) == 2
    told = capfd.readouterr().err
    assert said in told
    assert told.count("\n") == 1
    assert len(told) < 500


def test_a_disparity_that_no_picture_holds() -> None:
    """Its picture took it for a place in a table of colours."""
    pictures = np.random.default_rng(0).integers(0, 256, (2, 48, 64), dtype=np.uint8)
    rig = StereoRig.rectified(Intrinsics.from_focal(64, 48, 60.0), 0.1)
    with pytest.raises(MeasurementFailed, match=r"a disparity of 1e\+308 px: must be within \+-1e\+06 px"):
        dense_disparity(*pictures, rig, matcher=lambda left, right, rig: np.full(left.shape[:2], 1e308))
