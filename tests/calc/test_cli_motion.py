"""`rigsim calc motion`: words to numbers, and what is asked back."""

from __future__ import annotations

import json
from typing import Any

import pytest

from rigsim.cli.app import run

RIG = ("--baseline", "120", "--focal", "900", "--resolution", "1280x720", "--z", "3m")


def document(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    assert run(["calc", "motion", *RIG, *words, "--json"]) == 0
    found: dict[str, Any] = json.loads(capsys.readouterr().out)
    return found


def test_a_thing_that_passes_by_hand(capsys: pytest.CaptureFixture[str]) -> None:
    found = document(capsys, "--time-offset", "2ms", "--speed", "3.6km/h", "--moving", "object")
    # 2 mm at 3 m are 0.6 px; 35.4 px of disparity instead of 36: 108000 / 35.4
    assert found["along_px"] == pytest.approx(0.6)
    assert found["depth_error"] == pytest.approx(108000 / 35.4 - 3000)
    assert found["most_along_px"] == pytest.approx(0.6)
    assert found["most_across_px"] == pytest.approx(0, abs=1e-9)
    # 0.25 sqrt(2) px of noise take 1.1785 ms
    assert found["allowed_ms"] == pytest.approx(2 * 0.25 * 2**0.5 / 0.6)
    assert found["motion"] == {
        "time_offset_ms": 2.0,
        "speed_m_s": 1.0,
        "forward_speed_m_s": 0.0,
        "vertical_speed_m_s": 0.0,
        "turn_rate_deg_s": 0.0,
        "pivot": "middle of the baseline",
        "moving": "object",
    }


def test_a_turning_rig_by_hand(capsys: pytest.CaptureFixture[str]) -> None:
    found = document(capsys, "--time-offset", "2000us", "--turn-rate", "30")
    # u = -36 px turned by 0.06 deg: 900 tan(atan(-0.04) - 0.0010472) = -36.944, and the swing of 0.06 mm
    assert found["along_px"] == pytest.approx(-0.944, abs=1.5e-3)
    assert found["depth_error"] == pytest.approx(108000 / 36.944 - 3000, abs=0.2)
    other = document(capsys, "--time-offset=-2ms", "--turn-rate=-30deg/s")
    assert other["along_px"] == pytest.approx(found["along_px"])


def test_a_drone_that_looks_down_with_its_baseline_across_the_flight(
    capsys: pytest.CaptureFixture[str],
) -> None:
    # flying up the pictures: 4 mm at 3 m are 900 x 0.004 / 3 = 1.2 px, down; half a pixel takes 1 / 2.4 ms
    found = document(capsys, "--time-offset", "1ms", "--vertical-speed=-4m/s", "--moving", "rig")
    assert found["across_px"] == pytest.approx(1.2)
    assert found["along_px"] == pytest.approx(0, abs=1e-9)
    assert found["allowed_rows_ms"] == pytest.approx(1 / 2.4)
    assert found["allowed_ms"] is None
    assert found["motion"]["vertical_speed_m_s"] == -4.0
    assert [remark["code"] for remark in found["remarks"]] == ["rows"]
    assert found["says"].startswith("At 3.00 m the depth is right: the disparity is off by 0 px and the rows")
    assert run(["calc", "motion", *RIG, "--time-offset", "1ms", "--vertical-speed", "4m/s"]) == 2
    assert "--moving is missing" in capsys.readouterr().err


def test_what_is_not_seen_has_no_error(capsys: pytest.CaptureFixture[str]) -> None:
    near = ("--z", "100mm", "--time-offset", "2ms", "--turn-rate", "30")
    assert run(["calc", "motion", *RIG[:-2], *near, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["seen_by"] == "left"
    assert (found["along_px"], found["depth_error"], found["depth_std"]) == (None, None, None)
    assert found["most_along_px"] is not None  # elsewhere in the picture both do


def test_people_read_what_moves(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--time-offset=-2ms", "--speed", "-1", "--forward-speed", "10m/s", "--moving", "rig")
    assert run(["calc", "motion", *RIG, *words, "--turn-rate=-3"]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    says = (
        "the rig moves at -1 m/s along the baseline and 10 m/s straight ahead, the rig turns left at 3 deg/s"
    )
    assert f"Motion: {says}; the right picture 2 ms earlier" in printed


def test_the_answer_comes_first(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("--time-offset", "2ms", "--turn-rate", "30")
    says = document(capsys, *words)["says"]
    # 900 tan(.06 deg + atan .04) - 36 = .944 px more, and the swing: 108000 / 36.943 = 2923.4 mm
    start = "At 3.00 m the depth comes out 76.6 mm (2.6 %) too small: the disparity is off by +0.943 px and "
    assert says.startswith(
        start + "the rows by 0 px. Over the image it is up to 112 mm, 1.40 px and 0.260 px."
    )
    assert says.endswith("The rig turns to the right (positive turn rate), about the middle of its baseline.")
    assert run(["calc", "motion", *RIG, *words]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert printed.startswith(says)
    assert run(["calc", "motion", *RIG, *words, "--markdown"]) == 0
    assert capsys.readouterr().out.startswith(f"{says}\n\n| quantity")
    assert run(["calc", "motion", *RIG, *words, "--csv"]) == 0
    assert capsys.readouterr().out.startswith("seen_by,")
    left = document(capsys, "--time-offset", "2ms", "--turn-rate=-30")["says"]
    assert "too large: the disparity is off by −0.943 px" in left
    assert left.endswith("The rig turns to the left (negative turn rate), about the middle of its baseline.")
    # a thing that passes: 2 mm at 3 m are .6 px, 108000 / 35.4 = 3050.8 mm; nobody turns
    passed = document(capsys, "--time-offset", "2ms", "--speed", "1m/s", "--moving", "object")["says"]
    assert "comes out 50.8 mm (1.7 %) too large: the disparity is off by −0.600 px" in passed
    assert "turns" not in passed
    assert "the depth is right" in document(capsys, "--time-offset", "2ms")["says"]
    none = document(capsys, "--time-offset", "2ms", "--speed", "100m/s", "--moving", "object")["says"]
    assert "At 3.00 m no depth is left: the disparity is off by −60.0 px" in none


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--time-offset", "2ms", "--speed", "1"], "--moving is missing: does the rig move, or the object?"),
        (["--time-offset", "2ms", "--moving", "car"], "moving 'car': must be one of rig, object"),
        (["--time-offset", "2kg"], "time offset 2kg: unknown unit 'kg'"),
        (["--time-offset", "2ms", "--turn-rate", "2m/s"], "turn rate 2m/s: unknown unit 'm/s'"),
        (["--time-offset", "2ms", "--z", "1,3m"], "depth 1,3m: 2 distances; give one"),
    ],
)
def test_words_that_say_no_motion(words: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["calc", "motion", *RIG, *words]) == 2
    assert told in capsys.readouterr().err
