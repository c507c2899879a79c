"""How a run ends before it is done: Ctrl-C, a signal, or a fault that nobody foresaw."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import tempfile
import time
import traceback
from types import FrameType

INTERRUPTED = 130
"""Exit code after Ctrl-C; 128 and the signal's number after another one."""

NO_NET = "RIGSIM_NO_NET"
"""Environment variable that lets unforeseen faults through as they are; tests set it."""

_ended_by: list[int] = []


def listen() -> None:
    """Let SIGTERM and SIGHUP end a run as Ctrl-C does: what is open is closed, what was started is ended."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, _interrupt)


def is_ending() -> bool:
    """Whether a signal ends this run; extension modules that are being loaded make another error of it."""
    return bool(_ended_by)


def exit_code() -> int:
    """What an interrupted run exits with."""
    return 128 + _ended_by[0] if _ended_by else INTERRUPTED


def leave(code: int) -> None:
    """End the process at once after an interrupt: a second Ctrl-C must find nothing to interrupt."""
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError, AttributeError):
            stream.flush()
    os._exit(code)


def unforeseen(error: BaseException, words: list[str]) -> str:
    """One line about a fault that is rigsim's own; the traceback goes to a file, which the line names."""
    doing = " ".join(["rigsim", *words])
    doing = doing if len(doing) <= 200 else doing[:197] + "..."
    text = "".join(traceback.format_exception(error))
    lines = str(error).strip().splitlines()
    says = f"{type(error).__name__}: {lines[0][:200]}" if lines else type(error).__name__
    try:
        prefix = f"rigsim-fault-{time.strftime('%Y%m%d-%H%M%S')}-"
        descriptor, path = tempfile.mkstemp(prefix=prefix, suffix=".txt")
        with open(descriptor, "w", encoding="utf-8", errors="backslashreplace") as file:
            file.write(f"{doing}\n\n{text}")
        where = f"the details are in {path}; please report them"
    except OSError as problem:
        where = f"the details could not be written ({problem.strerror or problem})"
    return f"an internal error of rigsim in `{doing}` ({says}): {where}"


def _interrupt(number: int, _frame: FrameType | None) -> None:
    _ended_by.append(number)
    raise KeyboardInterrupt
