"""How far rows are apart, as `calc depth` and `calc limits` tell of a rig that is not rectified."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

import numpy as np
import pytest

import rigsim
from rigsim.cli.app import run
from rigsim.study.calc.plane import rows_apart

RIG = ("--baseline", "100", "--focal", "1000", "--resolution", "1280x960")
KEYS = ("row_px", "row_least_px", "row_most_px")


def printed(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    assert run(["calc", *words]) == 0
    return capsys.readouterr().out


def document(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(printed(capsys, *words, "--json"))
    return found


def rows(capsys: pytest.CaptureFixture[str], *words: str) -> list[float]:
    found = document(capsys, "depth", *RIG, *words)
    return [found[key] for key in KEYS]


def test_a_shift_and_a_turn_by_hand(capsys: pytest.CaptureFixture[str]) -> None:
    # 1000 px x .5 mm / 1 m, everywhere; a camera that is higher sees things lower
    assert rows(capsys, "--vertical=-0.5mm", "--z", "1m") == pytest.approx([0.5] * 3)
    assert rows(capsys, "--vertical=0.5mm", "--z", "2m") == pytest.approx([-0.25] * 3)
    # tan .1 deg; f (1 + y^2 / f^2) at the edge y = 480 px; a camera that looks up sees things lower
    turn = np.tan(np.radians(0.1))
    on_axis, least, most = rows(capsys, "--pitch", "0.1", "--z", "1m")
    assert on_axis == pytest.approx(1000 * turn)
    assert least == pytest.approx(1000 * turn)
    assert most == pytest.approx(480 - 1000 * np.tan(np.arctan(0.48) - np.radians(0.1)), abs=1e-6)
    # the right image's own edges: a roll by .2 deg moves rows by x, right ones up where it turns clockwise
    on_axis, least, most = rows(capsys, "--roll", "0.2", "--z", "1m")
    assert on_axis == pytest.approx(100 * np.sin(np.radians(0.2)), abs=1e-4)
    assert (least, most) == (pytest.approx(-1.88, abs=0.02), pytest.approx(2.23, abs=0.02))
    assert rows(capsys, "--z", "1m") == [0, 0, 0]


def test_against_tolerances_formula() -> None:
    rig = rigsim.make_rig(baseline_mm=100, focal_px=1000, resolution_px=(1280, 960))
    off = rigsim.make_rig(rig, pitch_deg=0.01, vertical_mm=-0.05, yaw_deg=0.02)
    per_unit = rigsim.row_sensitivity(rig, [[0.0, 0.0, 1.5]])
    expected = (
        np.radians(0.01) * per_unit["pitch_rad"][0]
        - 0.05e-3 * per_unit["vertical_m"][0]
        + np.radians(0.02) * per_unit["yaw_rad"][0]
    )
    assert rows_apart(off, 1.5, sized=True).on_axis_px == pytest.approx(float(expected), rel=1e-3)


def test_limits_tells_the_same_at_each_distance(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--pitch", "0.1", "--vertical=-0.5mm", "--z", "1,2m")
    found = document(capsys, "limits", *RIG, *words)
    assert found["row_px"] is None  # of several distances they stand in `at`
    assert [one["row_px"] for one in found["at"]] == pytest.approx(
        [1.745331 + 0.5, 1.745331 + 0.25], abs=1e-4
    )
    beside = document(capsys, "depth", *RIG, *words)
    assert [[row[key] for key in KEYS] for row in beside["rows"]] == [
        [one[key] for key in KEYS] for one in found["at"]
    ]


def test_people_read_it_where_it_matters(capsys: pytest.CaptureFixture[str]) -> None:
    for command in ("depth", "limits"):
        text = printed(capsys, command, *RIG, "--vertical=-0.5mm", "--z", "1m")
        assert "rows apart, not rectified" in text
        lines = [line for line in text.splitlines() if line.startswith("rows apart")]
        assert [line.split("  px")[0].split()[-1] for line in lines] == ["0.50000"] * 3
        assert "rows apart" not in printed(capsys, command, *RIG, "--z", "1m")
    table = printed(capsys, "depth", *RIG, "--vertical=-0.5mm", "--z", "1m", "--csv")
    (row,) = csv.DictReader(io.StringIO(table))
    assert [float(row[key]) for key in KEYS] == pytest.approx([0.5] * 3)
    without_size = ("depth", *RIG[:-2], "--vertical=-0.5mm", "--z", "1m")
    assert "rows apart, least" not in printed(capsys, *without_size)
    found = document(capsys, *without_size)
    assert [found[key] for key in KEYS] == [pytest.approx(0.5), None, None]
    near = document(capsys, "depth", *RIG, "--pitch", "0.1", "--z", "50mm")
    assert (near["seen_by"], near["row_px"]) == ("left", None)
