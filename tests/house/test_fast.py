"""`./check --fast` runs what a change can break: found by import graph, the nearest first."""

from __future__ import annotations

import importlib.util
import subprocess
from pathlib import Path
from types import SimpleNamespace

import pytest

ROOT = Path(__file__).resolve().parents[2]
_spec = importlib.util.spec_from_file_location("fast", ROOT / "tools" / "fast.py")
assert _spec is not None
assert _spec.loader is not None
fast = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(fast)


def test_a_formula_breaks_its_own_tests_first_and_then_those_of_who_uses_it() -> None:
    found = fast.affected(["rigsim/theory/triangulation.py"])
    rooms = [test.split("/")[1] for test in found]
    # the room's own come first
    assert rooms[: rooms.count("theory")] == ["theory"] * rooms.count("theory")
    # tests/verify/test_verify_golden.py imports it; the console of sweeps is further away
    assert found.index("tests/verify/test_verify_golden.py") < found.index("tests/sweep/test_cli_sweep.py")
    assert "tests/rig/test_rig_pose.py" not in found


def test_a_use_case_s_tests_come_first_from_every_floor() -> None:
    for path in (
        "rigsim/study/tolerance/batch.py",
        "rigsim/cli/tolerance.py",
        "rigsim/present/templates/tolerance.html",
    ):
        found = fast.affected([path])
        own = sorted(file.relative_to(ROOT).as_posix() for file in ROOT.glob("tests/tolerance/test_*.py"))
        assert found[: len(own)] == own


def test_a_helper_breaks_those_who_import_it_alone() -> None:
    assert fast.affected(["benchmarks/subjects/checker_images.py"]) == [
        "tests/measure/test_study_pair.py",
        "tests/pixels/test_measure_corners.py",
        "tests/sim/test_measure_sensor.py",
    ]


def test_pages_break_the_house_and_a_changed_test_comes_before_all() -> None:
    changed = ["README.md", "tests/rig/test_rig_pose.py"]
    first, *others = fast.affected(changed)
    assert first == "tests/rig/test_rig_pose.py"
    assert {test.split("/")[1] for test in others} == {"house"}


def test_what_changed_is_what_git_says(tmp_path: Path) -> None:
    def git(*words: str) -> None:
        name = ["-c", "user.name=one", "-c", "user.email=one@example.org"]
        subprocess.run(["git", *name, *words], cwd=tmp_path, check=True, capture_output=True)

    def write(name: str) -> None:
        (tmp_path / name).write_text(name)

    git("init", "-b", "main")
    for name in ("a.py", "b.py"):
        write(name)
        git("add", ".")
        git("commit", "-m", name)
    assert fast.changed(tmp_path) == ["b.py"]  # nothing since: the last commit
    write("c.py")
    assert fast.changed(tmp_path) == ["c.py"]
    git("checkout", "-b", "branch")
    git("add", ".")
    git("commit", "-m", "c")
    (tmp_path / "a.py").write_text("other")
    assert fast.changed(tmp_path) == ["a.py", "c.py"]  # all that main does not have


def test_no_test_is_begun_once_the_time_is_over(monkeypatch: pytest.MonkeyPatch) -> None:
    now = iter([100.0, 129.0, 131.0])
    monkeypatch.setattr(fast, "time", SimpleNamespace(monotonic=lambda: next(now)))
    deadline = fast.Deadline(30.0)  # from the first test, however long it took to find them
    assert [deadline.pytest_runtest_protocol() for _ in range(3)] == [None, None, True]
