"""A stranger's function in a worker process: whatever it does, one line and no harm."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from rigsim.errors import TriangulatorError
from rigsim.rig.arrays import Array
from rigsim.study.triangulators.isolated import IsolatedTriangulator
from rigsim.theory.triangulation import triangulate
from tests.helpers.processes import children, wait_for_end
from tests.helpers.sampling import RIGS, close, noisy, points_in_view

RIG = RIGS["distorted"]
PIXELS = noisy(RIG, points_in_view(RIG, 20, 1.0, 4.0), 0.3)

MODULE = """
import ctypes, os, subprocess, sys, time
from pathlib import Path
import numpy as np
from rigsim import triangulate as optimal

TEN = [[1, 2, 3]] * 20
ten = lambda *_: TEN
def ints(*_): return np.full((20, 3), 7)
def lists(*a): return optimal(*a).tolist()
def missing(rig, uv_left, uv_right):
    points = optimal(rig, uv_left, uv_right)
    points[1] = np.nan
    points[3, 1] = np.inf
    return points
def overwrites(rig, uv_left, uv_right):
    points = optimal(rig, uv_left, uv_right)
    uv_left[:] = uv_right[:] = 0
    return points
def prints(*a):
    print("\\x1b[31mhello"); print("again", file=sys.stderr); os.system("echo from a child")
    ctypes.CDLL(None).printf(b"words of C\\n")
    return optimal(*a)
def transposed(*a): return optimal(*a).T
def few(*a): return optimal(*a)[:5]
def nothing(*a): pass
def ragged(*a): return [[1, 2, 3]] * 19 + [[1, 2]]
def words(*a): return [["x", "y", "z"]] * 20
def holes(*a): return [[None] * 3] * 20
def imaginary(*a): return optimal(*a) + 0j
def raises(*a): raise ValueError("no luck\\nat all")
def leaves(*a): sys.exit("enough")
def dies(*a): print("the end", flush=True); os._exit(3)
def crashes(*a): os.kill(os.getpid(), 11)
def hangs(*a):
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
    Path("pids").write_text(f"{os.getpid()} {child.pid}")
    time.sleep(600)
def spins(*a):
    while True: pass
def once(*a):
    first = not Path("called").exists()
    Path("called").touch()
    if first: time.sleep(600)
    return optimal(*a)
def whose(*a): return np.full((20, 3), os.getpid())
def chatters(*a):
    for i in range(20000): print("line", i)
    return optimal(*a)
constant = 3
class nested:
    inner = staticmethod(optimal)
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A working folder with the stranger's module; nothing of its processes may be left."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "theirs.py").write_text(MODULE)
    before = children()
    yield tmp_path
    assert children() == before


def call(function: str, timeout_s: float = 30.0) -> tuple[Array, list[str]]:
    with IsolatedTriangulator(f"theirs:{function}", timeout_s) as theirs:
        return theirs(RIG, *PIXELS), theirs.notes


@pytest.mark.parametrize("function", ["optimal", "lists", "overwrites", "nested.inner"])
def test_the_answer_is_that_of_a_call_in_this_process(function: str) -> None:
    found, notes = call(function)
    assert np.array_equal(found, triangulate(RIG, *PIXELS))
    assert notes == []


@pytest.mark.parametrize(("function", "row"), [("ten", [1, 2, 3]), ("ints", [7, 7, 7])])
def test_whole_numbers_are_numbers(function: str, row: list[int]) -> None:
    found, _ = call(function)
    assert found.dtype == np.float64
    close(found, [row] * 20)


def test_rows_without_an_answer_are_nan() -> None:
    found, _ = call("missing")
    assert np.flatnonzero(np.isnan(found).all(axis=1)).tolist() == [1, 3]
    assert np.isfinite(np.delete(found, [1, 3], axis=0)).all()


def test_what_is_printed_is_noted_and_goes_nowhere(capfd: pytest.CaptureFixture[str]) -> None:
    found, notes = call("prints")
    assert np.array_equal(found, triangulate(RIG, *PIXELS))
    (note,) = notes
    assert note.startswith("printed ")
    assert note.endswith(", 4 lines")
    assert note.isprintable()
    assert capfd.readouterr() == ("", "")


def test_of_much_that_is_printed_the_first_line_is_noted() -> None:
    assert call("chatters")[1] == ["printed 'line 0', many lines"]


def test_notes_are_those_of_the_last_call() -> None:
    with IsolatedTriangulator("theirs:once", 0.5) as theirs:
        with pytest.raises(TriangulatorError, match="took longer"):
            theirs(RIG, *PIXELS)
        assert np.isnan(theirs.seconds)
        theirs(RIG, *PIXELS)
        assert theirs.notes == []
        assert theirs.seconds >= 0


@pytest.mark.parametrize(
    ("function", "reason", "message"),
    [
        ("transposed", "wrong-shape", r"returned shape \(3, 20\): must be \(20, 3\)"),
        ("few", "wrong-shape", r"returned shape \(5, 3\): must be \(20, 3\)"),
        ("nothing", "wrong-shape", r"returned shape \(\): must be \(20, 3\)"),
        ("ragged", "no-array", r"returned a list that is no array .*: must be \(20, 3\)"),
        ("words", "wrong-type", r"returned type <U1: must be real numbers"),
        ("holes", "wrong-type", r"returned type object: must be real numbers"),
        ("imaginary", "wrong-type", r"returned type complex128: must be real numbers"),
        ("raises", "raised", r"raised ValueError: no luck$"),
        ("leaves", "raised", r"raised SystemExit: enough$"),
        ("dies", "ended", r"ended its process with exit code 3: must return; its last words: the end$"),
        ("crashes", "ended", r"ended its process with signal 11 \(SIGSEGV\): must return$"),
        (
            "spins",
            "timed-out",
            r"took longer than 0.5 s: ended; make it faster, or allow more with --timeout$",
        ),
    ],
)
def test_a_bad_call_is_one_line_and_the_next_one_works(
    function: str, reason: str, message: str, folder: Path
) -> None:
    with IsolatedTriangulator(f"theirs:{function}", 0.5) as theirs:
        for _ in range(2):
            with pytest.raises(TriangulatorError, match=message) as caught:
                theirs(RIG, *PIXELS)
            assert caught.value.reason == reason
            assert caught.value.shape == {"transposed": (3, 20), "few": (5, 3)}.get(function, ())
            assert str(caught.value).isprintable()
            assert str(caught.value).startswith(f"triangulator 'theirs:{function}' ")


def test_one_that_hangs_is_ended_with_its_children(folder: Path) -> None:
    with pytest.raises(TriangulatorError, match="took longer than 2 s"):
        call("hangs", timeout_s=2.0)
    for pid in map(int, (folder / "pids").read_text().split()):
        wait_for_end(pid)


def test_the_function_is_loaded_once_and_again_after_a_death() -> None:
    with IsolatedTriangulator("theirs:whose", 30.0) as theirs:
        pids = [theirs(RIG, *PIXELS)[0, 0] for _ in range(2)]
        assert pids[0] == pids[1] != os.getpid()
        os.kill(int(pids[0]), signal.SIGKILL)
        with pytest.raises(TriangulatorError, match=r"signal 9 \(SIGKILL\)"):
            theirs(RIG, *PIXELS)
        assert theirs(RIG, *PIXELS)[0, 0] != pids[0]


@pytest.mark.parametrize(
    ("source", "name", "message"),
    [
        ("", "mine", "must be written package.module:function"),
        ("", ":f", "must be written package.module:function"),
        ("", "nowhere:f", r"cannot import nowhere \(ModuleNotFoundError"),
        ("", "mine:f", "has no attribute 'f'"),
        ("f = 3", "mine:f", "not a function"),
        ("1 / 0", "mine:f", r"cannot import mine \(ZeroDivisionError: division by zero\)"),
        ("def f(:", "mine:f", r"cannot import mine \(SyntaxError"),
        ("import sys; sys.exit(4)", "mine:f", r"cannot be imported \(SystemExit: 4\)"),
        ("import os; os._exit(4)", "mine:f", "ended its process with exit code 4"),
        ("while True: pass", "mine:f", "took longer than 1 s to import: ended"),
    ],
)
def test_a_function_that_cannot_be_loaded_is_refused_at_once(
    source: str, name: str, message: str, folder: Path
) -> None:
    (folder / "mine.py").write_text(source)
    theirs = IsolatedTriangulator(name, 30.0, start_timeout_s=1.0 if "True" in source else 30.0)
    with pytest.raises(TriangulatorError, match=message) as caught, theirs:
        pytest.fail("must not be entered")
    assert "\n" not in str(caught.value)
    with pytest.raises(TriangulatorError, match=message):
        theirs(RIG, *PIXELS)
    theirs.close()


def test_modules_beside_it_do_not_hide_those_of_python(folder: Path) -> None:
    for name in ("numpy", "signal", "rigsim", "random", "csv"):
        (folder / f"{name}.py").write_text("raise RuntimeError('the wrong one')")
    assert np.array_equal(call("optimal")[0], triangulate(RIG, *PIXELS))


def test_the_module_beside_the_user_is_what_is_meant(folder: Path) -> None:
    (folder / "test.py").write_text("def f(*a):\n    import late\n    return late.TEN\n")
    (folder / "late.py").write_text("TEN = [[1, 2, 3]] * 20\n")
    with IsolatedTriangulator("test:f", 30.0) as theirs:  # Python has a package of that name
        close(theirs(RIG, *PIXELS), [[1, 2, 3]] * 20)


def test_the_worker_loads_nothing_heavy(folder: Path) -> None:
    (folder / "light.py").write_text(
        "import sys\ndef f(rig, uv_left, uv_right):\n"
        "    print(*sys.modules, file=open('loaded', 'w'))\n"
        "    return [[0, 0, 1]] * 20\n"
    )
    with IsolatedTriangulator("light:f", 30.0) as light:
        light(RIG, *PIXELS)
    loaded = (folder / "loaded").read_text().split()
    assert "rigsim.study.triangulators.isolated" in loaded
    assert not {"mujoco", "pandas", "matplotlib", "scipy", "pydantic", "typer"} & set(loaded)


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGKILL])
def test_the_worker_does_not_outlive_who_asks(sent: signal.Signals, folder: Path) -> None:
    tests = Path(__file__).parent
    program = f"""
        import sys
        sys.path[:0] = [{str(tests)!r}, {str(tests.parents[1])!r}]
        from test_verify_worker import PIXELS, RIG
        from rigsim.study.triangulators.isolated import IsolatedTriangulator
        with IsolatedTriangulator("asleep:f", 2.0 if {sent == signal.SIGKILL} else 60.0) as asleep:
            asleep(RIG, *PIXELS)
        """
    (folder / "asleep.py").write_text(
        "import json, os\n"
        "def f(*a):\n"
        "    print(json.dumps([os.getpid(), os.getppid()]), file=open('pids.new', 'w'))\n"
        "    os.rename('pids.new', 'pids')\n"
        "    while True: pass\n"
    )
    with subprocess.Popen([sys.executable, "-c", textwrap.dedent(program)], stderr=subprocess.PIPE) as asks:
        while not (folder / "pids").exists():
            assert asks.poll() is None
            time.sleep(0.01)
        worker, parent = json.loads((folder / "pids").read_text())
        assert parent == asks.pid
        os.kill(asks.pid, sent)
        asks.communicate()
    assert asks.returncode == -sent
    wait_for_end(worker)  # an alarm is the last resort
