"""A triangulator in any language: a program that gets a folder and leaves a file (docs/reference/exec.md)."""

from __future__ import annotations

import contextlib
import itertools
import math
import os
import shlex
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from rigsim import guard, programs
from rigsim.errors import OutputError, TriangulatorError, TriangulatorTimeout
from rigsim.interop.exec.files import POINTS, parse_points, task_files
from rigsim.rig.arrays import Array
from rigsim.rig.stereo import StereoRig

_ROW_BYTES = 1000  # more than four numbers take, however they are written


class ExecTriangulator:
    """Runs a command once a call, with the folder of its task as the last word; no shell reads it.

    Args:
        command: program and options, quoted as for a shell.
        timeout_s: a program that takes longer is ended with its children.
        keep: a folder for the folders of the calls, to look into; each is deleted otherwise.

    Raises:
        TriangulatorError: the command cannot be read, or its program is missing or not executable.
    """

    def __init__(self, command: str, timeout_s: float, keep: Path | None = None) -> None:
        self.name = command
        """The command."""
        self.timeout_s = timeout_s
        """A call that takes longer is ended."""
        self.keep = keep
        """Where the folders of the calls are kept."""
        self.notes: list[str] = []
        """What was odd about the last call without being wrong: that it complained, and its first line."""
        self.seconds = math.nan
        """How long the program took at the last call; NaN when it did not end well."""
        self.folder: Path | None = None
        """The folder of the last call, when it is kept."""
        self._words = _words(command)

    def __call__(self, rig: StereoRig, uv_left: Array, uv_right: Array) -> Array:
        """Points (N, 3) m in the left camera's frame of pixels (N, 2).

        Raises:
            TriangulatorError: the program fails, takes longer than `timeout_s`, or leaves no points.csv as
                asked for.
            OutputError: the folder cannot be made or filled.
        """
        self.notes.clear()
        self.seconds = math.nan
        with self._new_folder() as folder:
            for name, text in task_files(rig, uv_left, uv_right).items():
                _write(folder / name, text)
            try:
                self._run(folder)
                return parse_points(_read(folder / POINTS, len(uv_left)), len(uv_left))
            except TriangulatorError as error:
                where = f" (kept in {self.folder})" if self.folder else ""
                said = f"program {self.name!r}: {error}{where}"
                raise type(error)(said, error.reason, error.shape) from None

    @contextlib.contextmanager
    def _new_folder(self) -> Iterator[Path]:
        if self.keep is not None:
            self.folder = _numbered(self.keep.absolute())
            yield self.folder
            return
        stack = contextlib.ExitStack()
        try:
            made = stack.enter_context(guard.temporary_folder("rigsim-exec-"))
        except OSError as error:
            raise OutputError(f"temporary folder: {error.strerror or error}; free some space") from None
        with stack:
            yield made

    def _run(self, folder: Path) -> None:
        with tempfile.TemporaryFile() as said, tempfile.TemporaryFile() as complained:
            begin = time.perf_counter()
            try:
                process = programs.start([*self._words, str(folder)], said, complained=complained)
                code = programs.wait(process, self.timeout_s)
            except OSError as error:
                reason = error.strerror or error
                raise TriangulatorError(
                    f"cannot be started ({reason}); name its interpreter first", "unloadable"
                ) from None
            except subprocess.TimeoutExpired:
                raise TriangulatorTimeout(
                    f"took longer than {self.timeout_s:g} s: ended; make it faster, or allow more with"
                    " --timeout"
                ) from None
            seconds = time.perf_counter() - begin
            if code != 0:
                words = programs.last_words(complained) or programs.last_words(said)
                raise TriangulatorError(
                    f"failed with {programs.how_it_ended(code)}" + (f": {words}" if words else ""), "ended"
                )
            remark = programs.remark(complained)
        self.seconds = seconds
        if remark:
            self.notes.append(f"on stderr, {remark}")


def _words(command: str) -> list[str]:
    try:
        words = shlex.split(command)
    except ValueError as error:
        raise TriangulatorError(f"program {command!r}: {error}; quote it as for a shell", "unknown") from None
    if not words:
        raise TriangulatorError(
            f"program {command!r}: must name a program, as in './triangulate --fast'", "unknown"
        )
    if shutil.which(words[0]) is None:
        if os.path.exists(words[0]):
            raise TriangulatorError(
                f"program {command!r}: {words[0]} is not executable; name its interpreter first", "unloadable"
            )
        way_out = "check its path" if "/" in words[0] else f"install it, or give its path, as ./{words[0]}"
        raise TriangulatorError(f"program {command!r}: {words[0]} is not there; {way_out}", "unknown")
    return words


def _numbered(keep: Path) -> Path:
    """A new folder in `keep`, never one with an older answer in it."""
    try:
        keep.mkdir(parents=True, exist_ok=True)
        for number in itertools.count(1):
            folder = keep / f"call-{number:03d}"
            with contextlib.suppress(FileExistsError):
                folder.mkdir()
                break
    except OSError as error:
        raise OutputError(f"folder {keep}: {error.strerror or error}; choose another one") from None
    return folder


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise OutputError(f"{path}: {error.strerror or error}; free some space") from None


def _read(path: Path, count: int) -> bytes:
    if path.is_symlink() or not path.is_file():  # a link may lead to what is not the program's
        raise TriangulatorError(
            f"ended well, but left no {POINTS} in the folder that is its last argument", "wrong-file"
        )
    bound = _ROW_BYTES * (count + 2)
    try:
        with path.open("rb") as file:
            content = file.read(bound + 1)
    except OSError as error:
        raise TriangulatorError(
            f"{POINTS} cannot be read ({error.strerror or error})", "wrong-file"
        ) from None
    if len(content) > bound:
        raise TriangulatorError(
            f"{POINTS} is larger than {bound} bytes: must hold {count} rows", "wrong-file"
        )
    return content
