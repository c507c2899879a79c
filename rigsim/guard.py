"""What must end with this process, even if it is killed: programs it started, and temporary folders.

A guardian process (`rigsim.guardian`) is started with the first of them and ends by itself.
"""

from __future__ import annotations

import contextlib
import json
import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path

from rigsim import guardian

_guardians: dict[int, int] = {}
"""The descriptor at which each listens, by the process they guard: one that was forked needs its own."""


def be_ready() -> None:
    """Have the guardian run before something is made that it must know of: its start takes a while."""
    own = os.getpid()
    if own not in _guardians:
        with contextlib.suppress(OSError, subprocess.SubprocessError):
            _guardians[own] = _start()


def keep(kind: str, what: str) -> None:
    """Have `what` ended with this process: a ``family`` by its mark, or a ``path``."""
    _tell("keep", kind, what)


def let_go(kind: str, what: str) -> None:
    """It has ended, or may stay."""
    if os.getpid() in _guardians:
        _tell("let go", kind, what)


@contextlib.contextmanager
def temporary_folder(prefix: str) -> Iterator[Path]:
    """A temporary folder that is removed at the end of the block, and when this process is killed.

    Raises:
        OSError: it cannot be made.
    """
    be_ready()
    folder = tempfile.mkdtemp(prefix=prefix)
    keep("path", folder)
    try:
        yield Path(folder)
    finally:
        guardian.remove(folder)
        let_go("path", folder)


def end_with_parent() -> None:
    """In a process of `multiprocessing`: be killed as soon as its parent has ended, killed or not."""
    threading.Thread(target=_wait_for_parent, daemon=True).start()


def _wait_for_parent() -> None:
    """A parent that has ended wants no answer any more."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os.kill(os.getpid(), signal.SIGKILL)


def _tell(*message: str) -> None:
    """A guardian that has gone, or cannot be had, is no reason to fail."""
    be_ready()
    own = _guardians.get(os.getpid())
    if own is not None:
        with contextlib.suppress(OSError):
            os.write(own, json.dumps(message).encode() + b"\n")


def _start() -> int:
    theirs, ours = os.pipe()
    try:
        # a session of its own: Ctrl-C and a killed process group are not for it
        subprocess.run(
            [sys.executable, "-I", "-S", guardian.__file__],
            stdin=theirs,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            cwd="/",
            check=True,
        )
    except BaseException:
        os.close(ours)
        raise
    finally:
        os.close(theirs)
    return ours
