"""A process of one's own to talk to: it ends with this one, and how it ended can be told."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

from rigsim import guard, interrupts

_SERIAL = pickle.HIGHEST_PROTOCOL
_STARTING = threading.Lock()
_LAST_BREATH_S = 5.0
_LESS_URGENT = 10
_ONE_THREAD = "OPENBLAS_NUM_THREADS"  # threads that multiply small matrices only wait for those that draw


class Child:
    """A child process that runs ``main(connection)``; one thread may receive while others send."""

    def __init__(self, main: Callable[[Connection], None]) -> None:
        """Start it.

        Args:
            main: a function of a module; it begins with `begin`.
        """
        # forking after GL or threads have started hangs the child
        context = multiprocessing.get_context("spawn")
        self._connection, theirs = context.Pipe()
        self._process = context.Process(target=main, args=(theirs,), daemon=True)
        self._sending = threading.Lock()
        with _STARTING, interrupts.held_back():  # what is still starting has no answer to Ctrl-C
            before = os.environ.get(_ONE_THREAD)
            os.environ.setdefault(_ONE_THREAD, "1")
            try:
                self._process.start()
            finally:
                if before is None:
                    del os.environ[_ONE_THREAD]
                theirs.close()
        self.pid: int = self._process.pid or 0
        """Its process id."""

    def send(self, message: object) -> None:
        """Send it something.

        Raises:
            OSError: it has ended.
        """
        with self._sending:
            send(self._connection, message)

    def receive(self, timeout_s: float | None = None) -> Any:
        """What it sends next.

        Raises:
            EOFError, OSError: it has ended.
            TimeoutError: it sent nothing in that time.
        """
        if timeout_s is not None and not self._connection.poll(timeout_s):
            raise TimeoutError(f"no answer within {timeout_s:g} s")
        return receive(self._connection)

    def end(self) -> int:
        """Kill it, if it still runs; its exit code, minus the signal's number where one ended it."""
        self._process.kill()
        self._process.join()
        code = self._process.exitcode
        return 0 if code is None else code

    def close(self) -> None:
        """`end` it, and close the connection."""
        self.end()
        with contextlib.suppress(OSError):
            self._connection.close()

    def how_it_ended(self) -> str:
        """Why it stopped by itself, in words, as ``killed by signal 9``."""
        self._process.join(_LAST_BREATH_S)
        code = self.end()
        return f"killed by signal {-code}" if code < 0 else f"exit code {code}"


def begin() -> None:
    """In a child: Ctrl-C is for the parent to handle, what has no parent ends, and the page comes first."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with contextlib.suppress(OSError):
        os.nice(_LESS_URGENT)
    guard.end_with_parent()


def send(connection: Connection, message: object) -> None:
    """Send a message; its arrays go as they are, without a copy.

    Raises:
        OSError: there is nobody at the other end.
    """
    buffers: list[pickle.PickleBuffer] = []
    connection.send_bytes(pickle.dumps(message, _SERIAL, buffer_callback=buffers.append))
    connection.send_bytes(len(buffers).to_bytes(4, "little"))
    for buffer in buffers:
        connection.send_bytes(buffer.raw())


def receive(connection: Connection) -> Any:
    """Receive what `send` sent; its arrays are read-only.

    Raises:
        EOFError, OSError: there is nobody at the other end.
    """
    body = connection.recv_bytes()
    count = int.from_bytes(connection.recv_bytes(), "little")
    return pickle.loads(body, buffers=[connection.recv_bytes() for _ in range(count)])
