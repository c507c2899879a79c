"""Ctrl-C and the signals that mean the same: they end a run, even where other code swallows the interrupt."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from collections.abc import Iterator
from types import FrameType

INTERRUPTED = 130
"""Exit code after Ctrl-C; 128 and the signal's number after another one."""

_AGAIN_S = 0.25

_ended_by: list[int] = []


def listen() -> None:
    """Let SIGTERM and SIGHUP end a run as Ctrl-C does: what is open is closed, what was started is ended."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, _interrupt)
    signal.signal(signal.SIGALRM, _interrupt_again)


def caught() -> None:
    """Whoever catches a KeyboardInterrupt and goes on says so; it is not raised again."""
    signal.setitimer(signal.ITIMER_REAL, 0.0)


def is_ending() -> bool:
    """Whether a signal ends this run; extension modules that are being loaded make another error of it."""
    return bool(_ended_by)


def exit_code() -> int:
    """What an interrupted run exits with."""
    return 128 + _ended_by[0] if _ended_by else INTERRUPTED


@contextlib.contextmanager
def held_back() -> Iterator[None]:
    """Hold Ctrl-C back in this thread; processes that are started meanwhile never see it."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def leave(code: int) -> None:
    """End the process at once after an interrupt: a second Ctrl-C must find nothing to interrupt."""
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError, AttributeError):
            stream.flush()
    os._exit(code)


def _interrupt(number: int, _frame: FrameType | None) -> None:
    _ended_by.append(number)
    signal.setitimer(signal.ITIMER_REAL, _AGAIN_S, _AGAIN_S)
    raise KeyboardInterrupt


def _interrupt_again(_number: int, _frame: FrameType | None) -> None:
    """Modules that are being loaded and objects that are being freed swallow it; then nothing handles it."""
    handled = sys.exception()
    while handled is not None and not isinstance(handled, KeyboardInterrupt):
        handled = handled.__context__
    if handled is None:
        raise KeyboardInterrupt
