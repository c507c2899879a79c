"""The page's numbers are the command line's, to the last digit, and its faults speak of its labels."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import numpy as np
import pytest

from rigsim.interop.documents.text import json_text
from rigsim.studio.logic import command, point
from rigsim.studio.state import State
from tests.helpers.cli import rigsim


def _random_state(rng: np.random.Generator) -> State:
    u, v = rng.uniform(0, 1900), rng.uniform(0, 1000)
    words = {
        "focal": f"{rng.uniform(300, 3000):.4g}",
        "baseline": f"{rng.uniform(20, 600):.4g}{rng.choice(['', 'mm', 'cm'])}",
        "left": f"{u:.5g},{v:.5g}",
        "right": f"{u - rng.uniform(1, 90):.5g},{v + rng.normal():.5g}",
        "noise": f"{rng.uniform(0, 1):.3g}",
    }
    if rng.random() < 0.5:
        words |= {"resolution": "1920x1080", "vergence": f"{rng.uniform(0, 4):.3g}"}
    return State(words)


@pytest.mark.parametrize("seed", range(40))
def test_the_page_tells_what_the_command_prints(seed: int, tmp_path: Path) -> None:
    state = _random_state(np.random.default_rng(seed))
    line = shlex.split(command.of_point(state))[1:]
    done = rigsim(*line, "--json", cwd=tmp_path)
    found = point.find(state)
    if done.returncode:
        assert found.answer is None
        assert found.fault.lower() == done.stderr.strip().removeprefix("rigsim: error: ").lower()
        return
    assert found.answer is not None
    assert json.loads(json_text(found.answer.document())) == json.loads(done.stdout)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ({"baseline": ""}, "Baseline is missing: give it, or a whole rig by a rig's file or a preset"),
        ({"focal": ""}, "Focal length or Field of view is missing"),
        ({"left": ""}, "X1, y1: type both numbers, in pixels"),
        ({"right": "910"}, "X2, y2: type both numbers, in pixels"),
        ({"focal": "8mm"}, "Focal length 8mm: mm needs Sensor width or Pixel pitch; or give it in px"),
        ({"baseline": "-3"}, "Baseline -3 mm: must be > 0"),
        ({"right": "980,500"}, "Disparity 0 px: must be > 0; the point is at infinity"),
    ],
)
def test_faults_are_told_in_the_page_s_own_labels(words: dict[str, str], says: str) -> None:
    fault = point.find(point.DEFAULTS.with_words(**words)).fault
    assert fault.startswith(says)
    assert "--" not in fault


def test_two_boxes_are_one_word() -> None:
    assert point.pair("980", "500") == "980,500"
    assert point.pair(" ", "") == ""
    assert point.halves("980,") == ("980", "")
    assert point.halves(point.pair("", "500")) == ("", "500")


def test_the_summary_tells_all_and_the_command() -> None:
    lines = point.summary(point.EXAMPLES["Desktop scanner"]).splitlines()
    assert "Z                      1066.67 mm" in lines
    assert "baseline               80mm" in lines
    assert lines[-1] == "rigsim calc point --focal=2000 --baseline=80mm --left=1400,500 --right=1250,500"
