"""Other people's programs: started with their words on a file, and ended with all their children."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import time
from collections.abc import Mapping, Sequence
from typing import IO

_LOOK_BYTES = 65536
_LOOK_S = 0.005


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
    return subprocess.Popen(
        words,
        stdin=subprocess.DEVNULL,
        stdout=said,
        stderr=complained or said,
        env={**os.environ, **(environment or {})},
        pass_fds=pass_fds,
        start_new_session=True,
    )


def wait(process: subprocess.Popen[bytes], timeout_s: float) -> int:
    """The exit code of a process from `start`; it is killed with its children when it takes too long.

    Raises:
        subprocess.TimeoutExpired: it took longer than `timeout_s`.
    """
    try:
        return process.wait(timeout_s)
    except BaseException:
        kill(process)
        raise


def kill(process: subprocess.Popen[bytes]) -> int:
    """End a process from `start` that has not been waited for, and its children; its exit code."""
    # the session it was given is its own, and its number is not free before the wait: this ends nothing else
    if process.returncode is None:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    return process.wait()


def ends_within(process: subprocess.Popen[bytes], timeout_s: float) -> bool:
    """Whether a process from `start` ends within a time; it can still be given to `kill`."""
    end = time.monotonic() + timeout_s
    while os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT | os.WNOHANG) is None:
        if time.monotonic() >= end:
            return False
        time.sleep(_LOOK_S)
    return True


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
