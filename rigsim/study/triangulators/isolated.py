"""A triangulator of somebody else in a process of its own, so that nothing it does harms the rest.

The process imports the function once and answers over a socket. What it prints goes to a file, and one
that hangs or dies is replaced for the next call.
"""

from __future__ import annotations

import contextlib
import ctypes
import math
import os
import signal
import subprocess
import sys
import tempfile
import time
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from types import TracebackType
from typing import IO, Any

import numpy as np

from rigsim import programs
from rigsim.errors import TriangulatorError, TriangulatorTimeout
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig
from rigsim.theory.custom import first_line, load

_START_S = 60.0  # importing what the function needs may take long, and is done once
_GRACE_S = 1.0  # from the end of the conversation to the end of the process
_LOOK_S = 0.05  # a child of the worker's may keep the socket open after it
_LONGEST_S = 1e8  # of an alarm
_LENGTH = 500  # of a message

_CALL = "took longer than {:g} s: ended; make it faster, or allow more with --timeout"
_IMPORT = "took longer than {:g} s to import: ended; make its import faster"

# the same modules as here, whatever -c adds to the path
_CODE = (
    "import sys; sys.path[:] = sys.argv[2:]; from rigsim.study.triangulators.isolated import serve; serve()"
)


class IsolatedTriangulator:
    """Calls the function ``package.module:function`` in a worker process; a context manager.

    What it returns is held to the contract of `rigsim.theory.custom.CheckedTriangulator`. The worker is
    started by the first call, or on entering the context, which refuses a name that cannot be loaded.
    """

    def __init__(self, name: str, timeout_s: float, start_timeout_s: float = _START_S) -> None:
        self.name = name
        """``package.module:function``."""
        self.timeout_s = timeout_s
        """A call that takes longer is ended."""
        self.start_timeout_s = start_timeout_s
        """An import that takes longer is ended."""
        self.notes: list[str] = []
        """What was odd about the last call without being wrong: that it printed, and its first line."""
        self.seconds = math.nan
        """How long the function itself took at the last call; NaN when it did not return."""
        self._said: IO[bytes] | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._connection: Connection[Any, Any] | None = None

    def __enter__(self) -> IsolatedTriangulator:
        """Start the worker.

        Raises:
            TriangulatorError: the function cannot be loaded.
        """
        try:
            self._ready()
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __call__(self, rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        """Points (N, 3) m in the left camera's frame of pixels (N, 2).

        Raises:
            TriangulatorError: the function cannot be loaded, raises, ends its process, takes longer than
                `timeout_s`, or returns anything but real (N, 3).
        """
        self.notes.clear()
        self.seconds = math.nan
        begin = self._size_said()
        try:
            self._ready()
            self.seconds, points = self._ask((rig, uv_left, uv_right), self.timeout_s, _CALL, begin)
        finally:
            if self._said is not None and (remark := programs.remark(self._said, begin)):
                self.notes.append(remark)
        return np.asarray(points)

    def close(self) -> None:
        """End the worker."""
        try:
            self._end(_GRACE_S)
        finally:
            if self._said is not None:
                self._said.close()
                self._said = None

    def _ready(self) -> None:
        """Have a worker that has loaded the function."""
        if self._process is not None:
            return
        if self._said is None:
            self._said = tempfile.TemporaryFile()  # noqa: SIM115  # close() does
        self._connection, theirs = Pipe()
        with theirs:
            words = [sys.executable, "-P", "-c", _CODE, str(theirs.fileno()), *sys.path]
            self._process = programs.start(words, self._said, pass_fds=[theirs.fileno()])
        try:
            self._ask((self.name, self.timeout_s), self.start_timeout_s, _IMPORT, 0)
        except TriangulatorError:
            self._end(_GRACE_S)
            raise

    def _ask(self, question: object, timeout_s: float, late: str, begin: int) -> Any:
        """The worker's answer; a worker without one is ended, so that it never answers late."""
        try:
            answer = self._answer(question, timeout_s)
        except TimeoutError:
            self._end()
            raise TriangulatorTimeout(f"triangulator {self.name!r} {late.format(timeout_s)}") from None
        except (EOFError, OSError):
            how = self._end(_GRACE_S)
            said = "" if self._said is None else programs.last_words(self._said, begin)
            raise TriangulatorError(
                f"triangulator {self.name!r} ended its process with {how}: must return"
                + (f"; its last words: {said}" if said else ""),
                "ended",
            ) from None
        except BaseException:
            self._end()
            raise
        if isinstance(answer, TriangulatorError):
            raise answer
        return answer

    def _answer(self, question: object, timeout_s: float) -> Any:
        assert self._connection is not None
        assert self._process is not None
        self._connection.send(question)
        end = time.monotonic() + timeout_s
        while not self._connection.poll(max(0.0, min(_LOOK_S, end - time.monotonic()))):
            programs.trim(self._process)
            if programs.ends_within(self._process, 0.0) and not self._connection.poll():
                raise EOFError
            if time.monotonic() >= end:
                raise TimeoutError
        return self._connection.recv()

    def _end(self, grace_s: float = 0.0) -> str:
        """End the worker, if there is one, and its children; says how it ended."""
        if self._connection is not None:
            self._connection.close()
        if self._process is None:
            return ""
        try:
            programs.ends_within(self._process, grace_s)
        finally:
            code = programs.kill(self._process)
            self._process = self._connection = None
        return programs.how_it_ended(code)

    def _size_said(self) -> int:
        return 0 if self._said is None else os.fstat(self._said.fileno()).st_size


def serve() -> None:
    """Be the worker: load what the first message names, then answer until nobody asks any more."""
    descriptor = int(sys.argv[1])
    os.set_inheritable(descriptor, False)
    connection: Connection[Any, Any] = Connection(descriptor)
    name, timeout_s = connection.recv()
    sys.argv[1:] = []
    try:
        function = load(name)
    except TriangulatorError as error:
        connection.send(_shortened(error))
        return
    except BaseException as error:  # as SystemExit
        why = programs.plain(first_line(error))
        connection.send(TriangulatorError(f"triangulator {name!r}: cannot be imported ({why})", "unloadable"))
        return
    connection.send((0.0, None))
    while True:
        try:
            rig, uv_left, uv_right = connection.recv()
        except (EOFError, ConnectionResetError):
            return
        # should whoever asks be killed, the system ends even a loop in C
        signal.alarm(math.ceil(min(timeout_s, _LONGEST_S)) + 2)
        begin = time.perf_counter()
        answer: object
        try:
            points = function(rig, uv_left, uv_right)
            answer = time.perf_counter() - begin, points
        except TriangulatorError as error:
            answer = _shortened(error)
        except BaseException as error:
            why = programs.plain(first_line(error))
            answer = TriangulatorError(f"triangulator {name!r} raised {why}", "raised")
        signal.alarm(0)
        _flush()
        connection.send(answer)


def _shortened(error: TriangulatorError) -> TriangulatorError:
    """The error with a message that fits a line."""
    return TriangulatorError(programs.plain(str(error), _LENGTH), error.reason, error.shape)


def _flush() -> None:
    """Let what was printed arrive before the answer, what C has printed too."""
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(Exception):
            stream.flush()
    ctypes.CDLL(None).fflush(None)
