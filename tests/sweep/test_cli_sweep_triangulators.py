"""`rigsim sweep --triangulator`: OpenCV's, and a stranger's function in a process of its own."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest

from rigsim.cli.app import run
from rigsim.errors import MeasurementFailed, TriangulatorError
from rigsim.rig.presets import preset
from rigsim.study.scene.plan import Plan
from rigsim.study.sweep.run import sweep
from rigsim.study.triangulators.registry import started

SMALL = ["--resolution", "160x120", "--points", "100", "--trials", "5", "--measure", "none", "--json"]
MODULE = """
import os, time
from rigsim import triangulate
def same(*a):
    with open("pids", "a") as file: print(os.getpid(), file=file)
    return triangulate(*a)
def raises(*a): raise ValueError("no luck\\nat all")
def crashes(*a): os.kill(os.getpid(), 11)
def hangs(*a): time.sleep(600)
"""


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A stranger's module in the working folder, of a name of its own: it is imported only once."""
    monkeypatch.chdir(tmp_path)
    name = f"stranger_{tmp_path.name}"
    Path(f"{name}.py").write_text(MODULE, encoding="utf-8")
    return name


def _rows(capsys: pytest.CaptureFixture[str], *words: str) -> list[dict[str, object]]:
    assert run(["sweep", *SMALL, *words]) == 0
    rows: list[dict[str, object]] = json.loads(capsys.readouterr().out)["rows"]
    return rows


def test_opencv_is_swept_and_finds_what_the_same_linear_method_finds(
    capsys: pytest.CaptureFixture[str],
) -> None:
    dlt, cv2 = _rows(capsys, "--vergence", "10", "--triangulator", "dlt,cv2")
    assert (dlt["triangulator"], cv2["triangulator"]) == ("dlt", "cv2")
    # two programs, one formula, the same noisy pixels
    for name in ("depth_rmse_mm", "depth_bias_mm", "point_rmse_mm", "nees", "predicted_over_simulated"):
        assert cv2[name] == pytest.approx(dlt[name], rel=1e-6), name
    assert cv2["agreement"] == "agrees"


def test_a_function_answers_the_same_in_its_process_in_this_one_and_in_several(
    module: str, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--baseline", "50,100", "--triangulator", f"optimal,{module}:same"]
    alone = _rows(capsys, *words)
    pids = set(Path("pids").read_text().split())
    assert len(pids) == 1
    assert str(os.getpid()) not in pids
    here = _rows(capsys, *words, "--in-process")
    assert str(os.getpid()) in Path("pids").read_text().split()
    Path("pids").unlink()
    spread = _rows(capsys, *words, "--jobs", "2")
    assert (
        len(set(Path("pids").read_text().split())) == 2
    )  # of each worker; the best row, on show, is of `optimal`
    assert alone == here == spread
    for ours, theirs in ((alone[0], alone[1]), (alone[2], alone[3])):
        assert {**ours, "triangulator": ""} == {**theirs, "triangulator": ""}


@pytest.mark.parametrize(
    ("function", "jobs", "words"),
    [
        ("raises", "1", "raised ValueError: no luck"),
        ("crashes", "1", "ended its process with signal 11 (SIGSEGV)"),
        ("crashes", "2", "ended its process with signal 11 (SIGSEGV)"),
        ("hangs", "1", "took longer than 0.5 s"),
        ("missing", "1", "has no attribute 'missing'"),
    ],
)
def test_whatever_a_function_does_is_one_line(
    module: str, capsys: pytest.CaptureFixture[str], function: str, jobs: str, words: str
) -> None:
    own = f"{module}:{function}"
    words_given = ["--baseline", "50,100", "--triangulator", own, "--jobs", jobs, "--timeout", "500ms"]
    assert run(["sweep", *SMALL, *words_given]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    (line,) = printed.err.strip().splitlines()
    assert line.startswith(f"rigsim: error: triangulator {own!r}")
    assert words in line


def test_a_triangulator_that_is_not_known_or_not_installed_is_refused_before_anything_is_drawn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(TriangulatorError, match=r"unknown triangulator 'dtl'.*optimal.*cv2"):
        sweep(preset("oak-d").rig, Plan(scene="no such scene", triangulators=("dtl",)))

    monkeypatch.setitem(sys.modules, "cv2", None)
    with pytest.raises(MeasurementFailed, match="OpenCV"), started(("cv2",), None):
        pass


def test_compare_calls_a_function_in_this_process_when_told(
    module: str, capsys: pytest.CaptureFixture[str]
) -> None:
    few = ["compare", "--points", "200", "--noise", "0.5", "--geometry", "rectified", "--json"]
    assert run([*few, "optimal", f"{module}:same", "--in-process"]) == 0
    optimal, same = json.loads(capsys.readouterr().out)["rows"]
    assert str(os.getpid()) in Path("pids").read_text().split()
    assert same["pixel_error_over_bound"] == optimal["pixel_error_over_bound"]
