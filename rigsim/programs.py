"""Other people's programs: started with their words on a file, and ended with all their children.

Whatever such a program starts ends with it, in a session of its own or not, and so does the program when this
process is killed.
"""

from __future__ import annotations

import contextlib
import os
import secrets
import signal
import subprocess
import time
from collections.abc import Mapping, Sequence
from typing import IO

from rigsim import guard
from rigsim.guardian import end_family

MOST_SAID = 1_000_000
"""Of what a program prints so many bytes are kept; what comes later replaces it."""

_LOOK_BYTES = 65536
_SHORTEST_S, _LONGEST_S = 0.0005, 0.01  # between two looks at a program
_TRIM_S = 0.05
_MARK = "RIGSIM_PROGRAM"

_marks: dict[int, str] = {}
"""What the environment of a program and its children holds, by its process id."""
_said: dict[int, tuple[IO[bytes], ...]] = {}
"""Where a program prints."""


def start(
    words: Sequence[str],
    said: IO[bytes],
    environment: Mapping[str, str] | None = None,
    pass_fds: Sequence[int] = (),
    complained: IO[bytes] | None = None,
) -> subprocess.Popen[bytes]:
    """Start `words` in a session of its own; what it prints goes to the file `said`, and it reads nothing.

    What it prints on stderr goes to `complained` where that is given.

    A file, not a pipe: a grandchild that survives must not keep this process waiting.

    Raises:
        OSError: it cannot be started.
    """
    own = f"{os.getpid()}-{secrets.token_hex(8)}"
    mark = f"{_MARK}={own}"
    guard.keep("family", mark)
    try:
        process = subprocess.Popen(
            words,
            stdin=subprocess.DEVNULL,
            stdout=said,
            stderr=complained or said,
            env={**os.environ, **(environment or {}), _MARK: own},
            pass_fds=pass_fds,
            start_new_session=True,
        )
    except BaseException:
        guard.let_go("family", mark)
        raise
    _marks[process.pid] = mark
    _said[process.pid] = (said,) if complained is None else (said, complained)
    return process


def wait(process: subprocess.Popen[bytes], timeout_s: float) -> int:
    """The exit code of a process from `start`, whose children end with it; one that takes too long is killed.

    Raises:
        subprocess.TimeoutExpired: it took longer than `timeout_s`.
    """
    said = _said.get(process.pid, ())
    try:
        end = time.monotonic() + timeout_s
        while not ends_within(process, min(_TRIM_S, max(0.0, end - time.monotonic()))):
            trim(process)
            if time.monotonic() >= end:
                raise subprocess.TimeoutExpired(process.args, timeout_s)
        process.wait()
    finally:
        code = kill(process)
        _trim(said)  # only what has ended prints no more
    return code


def kill(process: subprocess.Popen[bytes]) -> int:
    """End a process from `start`, and its children; its exit code."""
    # the session it was given is its own, and its number is not free before the wait: this ends nothing else
    if process.returncode is None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    code = process.wait()
    mark = _marks.pop(process.pid, "")
    _said.pop(process.pid, None)
    if mark:
        end_family(mark)
        guard.let_go("family", mark)
    return code


def ends_within(process: subprocess.Popen[bytes], timeout_s: float) -> bool:
    """Whether a process from `start` ends within a time; it can still be given to `kill`."""
    end, pause_s = time.monotonic() + timeout_s, _SHORTEST_S
    while os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT | os.WNOHANG) is None:
        if time.monotonic() >= end:
            return False
        time.sleep(pause_s)
        pause_s = min(2 * pause_s, _LONGEST_S)
    return True


def trim(process: subprocess.Popen[bytes]) -> None:
    """Throw away what a process has printed beyond `MOST_SAID`: a loop that prints must not fill the disk."""
    _trim(_said.get(process.pid, ()))


def _trim(said: Sequence[IO[bytes]]) -> None:
    for file in said:
        descriptor = file.fileno()
        if os.fstat(descriptor).st_size > MOST_SAID:
            # its place in the file is the process's too
            os.ftruncate(descriptor, 0)
            os.lseek(descriptor, 0, os.SEEK_SET)


def how_it_ended(code: int) -> str:
    """An exit code as people say it: ``exit code 3``, ``signal 11 (SIGSEGV)``."""
    if code >= 0:
        return f"exit code {code}"
    try:
        return f"signal {-code} ({signal.Signals(-code).name})"
    except ValueError:
        return f"signal {-code}"


def last_words(said: IO[bytes], begin: int = 0) -> str:
    """The last line with something on it in the file of `start`, from byte `begin`; empty without one."""
    size = os.fstat(said.fileno()).st_size
    lines = _lines(said, max(begin, size - _LOOK_BYTES), size)
    return lines[-1] if lines else ""


def remark(said: IO[bytes], begin: int = 0) -> str:
    """What was printed from byte `begin` on, as ``printed 'hello', 4 lines``; empty if nothing was."""
    size = os.fstat(said.fileno()).st_size
    lines = _lines(said, begin, min(size, begin + _LOOK_BYTES))
    if not lines:
        return ""
    much = "many lines" if size > begin + _LOOK_BYTES else f"{len(lines)} lines"
    return f"printed {lines[0]!r}" + (f", {much}" if lines[1:] else "")


def _lines(said: IO[bytes], begin: int, end: int) -> list[str]:
    # the process writes on where it was: its place in the file is this one's too
    text = os.pread(said.fileno(), end - begin, begin).decode(errors="replace")
    return [plain(line) for line in text.splitlines() if line.strip()]


def plain(line: str, length: int = 200) -> str:
    """The first `length` characters of a line, fit for any console or file."""
    return "".join(letter if letter.isprintable() else "?" for letter in line.strip()[:length])
