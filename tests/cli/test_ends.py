"""However rigsim ends, what it started and what it had not finished ends with it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from rigsim import guard, interrupts, programs
from rigsim.cli import app
from rigsim.errors import OutputError
from rigsim.interop.files import claims, folder
from tests.helpers.processes import is_alive

PATIENCE_S = 30.0  # of the test, on a busy machine

HOLDER = """
import os, sys, tempfile, time
from pathlib import Path
from rigsim import guard, programs
from rigsim.interop.files.folder import folder_in_progress
tempfile.tempdir = sys.argv[1]
def begin():
    said = tempfile.TemporaryFile()
    family = "sleep 600 & setsid sleep 600 & echo $! >setsid.pid; echo $$ >own.pid; wait"
    return said, programs.start(["sh", "-c", family], said)
with guard.temporary_folder("rigsim-exec-") as kept, folder_in_progress(Path("out")) as unfinished:
    (unfinished / "half").write_text("half")
    said, process = begin()
    while not Path("own.pid").exists() or not Path("own.pid").read_text().strip():
        time.sleep(0.01)
    print("ready", flush=True)
    time.sleep(600)
"""


def until(true: Callable[[], bool]) -> bool:
    end = time.monotonic() + PATIENCE_S
    while not true():
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True


def pid_in(path: Path) -> int:
    return int(path.read_text())


def test_nothing_outlives_a_kill(tmp_path: Path) -> None:
    temporary = tmp_path / "tmp"
    temporary.mkdir()
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(temporary)], cwd=tmp_path, stdout=subprocess.PIPE, text=True
    )
    assert holder.stdout is not None
    assert holder.stdout.readline() == "ready\n"
    pids = [pid_in(tmp_path / "own.pid"), pid_in(tmp_path / "setsid.pid")]
    assert all(is_alive(pid) for pid in pids)
    holder.send_signal(signal.SIGKILL)
    holder.wait()
    holder.stdout.close()
    assert until(lambda: not any(is_alive(pid) for pid in pids))
    assert until(lambda: not list(temporary.iterdir()))
    assert until(lambda: sorted(path.name for path in tmp_path.iterdir()) == ["own.pid", "setsid.pid", "tmp"])


def test_a_program_s_background_children_end_with_it(tmp_path: Path) -> None:
    """Also one in a session of its own, that outlives the program's process group."""
    with (tmp_path / "said").open("w+b") as said:
        script = f"setsid sleep 600 & echo $! >{tmp_path}/pid; exit 0"
        process = programs.start(["sh", "-c", script], said)
        assert programs.wait(process, 30.0) == 0
    assert until(lambda: not is_alive(pid_in(tmp_path / "pid")))


def test_endless_printing_fills_no_disk(tmp_path: Path) -> None:
    with (tmp_path / "said").open("w+b") as said:
        process = programs.start(["yes"], said)
        with pytest.raises(subprocess.TimeoutExpired):
            programs.wait(process, 0.5)
        assert os.fstat(said.fileno()).st_size <= programs.MOST_SAID


@pytest.mark.parametrize(
    ("sent", "code"),
    [(signal.SIGTERM, 143), (signal.SIGINT, 130), (signal.SIGHUP, 129), (signal.SIGKILL, -9)],
)
def test_a_sweep_ends_with_its_workers(sent: signal.Signals, code: int, tmp_path: Path) -> None:
    words = ["sweep", "--renderer", "rays", "--baseline", "50:500/400", "--points", "200", "--trials", "20"]
    run = subprocess.Popen(
        [sys.executable, "-m", "rigsim", *words, "--jobs", "2", "--out", "out"],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert until(lambda: len(workers(run.pid)) >= 3)  # two, and the tracker of what they share
        begun = workers(run.pid)
        time.sleep(1.0)
        run.send_signal(sent)
        _, complained = run.communicate(timeout=PATIENCE_S)
    finally:
        run.kill()  # a test that fails must not leave a sweep of minutes behind
    assert run.returncode == code
    assert "Traceback" not in complained
    assert until(lambda: not any(is_alive(pid) for pid in begun))
    assert not [path.name for path in tmp_path.iterdir() if path.name.startswith(".rigsim")]


def workers(pid: int) -> set[int]:
    try:
        tasks = list(Path(f"/proc/{pid}/task").iterdir())
        return {int(child) for task in tasks for child in (task / "children").read_text().split()}
    except FileNotFoundError:
        return set()


def test_what_dead_runs_left_does_not_block_and_is_removed(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    dead = out / ".rigsim-4194303-1-0123abcd.tmp"  # no process has that number and that beginning
    dead.mkdir()
    (dead / "half").write_bytes(b"half")
    (out / ".rigsim-27fe729a.tmp").mkdir()  # of an older version
    live = claims.temporary_name(out)
    live.mkdir()
    folder.check_output(out)
    claims.release(out)
    assert [path.name for path in out.iterdir()] == [live.name]


def test_a_second_run_into_one_folder_is_told_at_once(tmp_path: Path) -> None:
    code = (
        "import sys, time\nfrom pathlib import Path\nfrom rigsim.interop.files.folder import check_output\n"
        "check_output(Path(sys.argv[1]))\nprint('ready', flush=True)\ntime.sleep(600)"
    )
    out = tmp_path / "out"
    first = subprocess.Popen([sys.executable, "-c", code, str(out)], stdout=subprocess.PIPE, text=True)
    assert first.stdout is not None
    assert first.stdout.readline() == "ready\n"
    with pytest.raises(OutputError, match=rf"another run \(process {first.pid}\) writes there"):
        folder.check_output(out)
    first.kill()
    first.wait()
    first.stdout.close()
    folder.check_output(out)
    claims.release(out)


def test_a_file_that_comes_while_the_run_works_is_kept(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    with pytest.raises(OutputError, match="another run has just filled it"):
        work_while_somebody_fills(out)
    assert (out / "report.html").read_bytes() == b"somebody's"
    assert [path.name for path in out.iterdir()] == ["report.html"]


def work_while_somebody_fills(out: Path) -> None:
    with folder.folder_in_progress(out) as made:
        (made / "report.html").write_bytes(b"new")
        (out / "report.html").write_bytes(b"somebody's")


def test_a_signal_while_an_extension_is_loaded_is_an_interrupt(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Its initialisation makes an ImportError of it."""
    told: list[int] = []
    monkeypatch.setattr(interrupts, "_ended_by", told)

    def load(_backend: str) -> None:
        told.append(signal.SIGTERM)
        raise ImportError("initialization failed")

    monkeypatch.setattr("rigsim.sim.backend.load_mujoco", load)
    assert app.run(["render", "--scene", "artifact", "--renderer", "rays", "--out", "nowhere"]) == 143
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    "make", [lambda: claims.claim(Path("out")), lambda: guard.temporary_folder("rigsim-exec-").__enter__()]
)
def test_an_interrupt_while_the_guardian_starts_leaves_nothing(
    make: Callable[[], object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted() -> int:
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(guard, "_guardians", {})
    monkeypatch.setattr(guard, "_start", interrupted)
    with pytest.raises(KeyboardInterrupt):
        make()
    assert list(tmp_path.iterdir()) == []


SWALLOWED = """
try:
    print("ready", flush=True)
    time.sleep(60)
except KeyboardInterrupt:
    pass  # as the loading of a module does
time.sleep(60)
print("went on")
"""
UNWINDING = """
try:
    print("ready", flush=True)
    time.sleep(60)
finally:
    time.sleep(1.0)
    print("cleaned")
"""
CAUGHT = """
try:
    print("ready", flush=True)
    time.sleep(60)
except KeyboardInterrupt:
    interrupts.caught()
time.sleep(1.0)
print("went on")
"""


@pytest.mark.parametrize(
    ("what", "said", "code"), [(SWALLOWED, "", -2), (UNWINDING, "cleaned\n", -2), (CAUGHT, "went on\n", 0)]
)
def test_an_interrupt_that_somebody_swallows_is_raised_again(what: str, said: str, code: int) -> None:
    """While it is handled, and after one that was caught, it is not."""
    script = f"import time\nfrom rigsim import interrupts\ninterrupts.listen()\n{what}"
    process = subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=PATIENCE_S)[0] == said
    assert process.returncode == code
