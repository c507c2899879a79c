"""Other people's stereo matchers: called, imported or run, and kept from doing harm.

A command gets ``{left}`` and ``{right}``, the paths of two PNG files, and ``{out}``, the path it writes:
a PFM file, or the NPY of `numpy.save` (``{out}`` ends in .pfm, ``{out_npy}`` in .npy; what counts
is the content). No shell reads it: write ``sh -c '...'`` for one.
"""

from __future__ import annotations

import pickle
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from rigsim import foreign, guard, programs, strangers
from rigsim.errors import InvalidImage, MeasurementFailed, OutputError
from rigsim.pixels.dense.pfm import parse_pfm
from rigsim.pixels.opencv import load_cv2
from rigsim.rig.arrays import AnyImage
from rigsim.rig.stereo import StereoRig

_CODE = (
    "import sys; task, answer, *sys.path[:] = sys.argv[1:]; sys.argv[1:] = [];"
    " from rigsim.pixels.dense.matcher import serve; serve(task, answer)"
)

MatcherFunction: TypeAlias = Callable[[AnyImage, AnyImage, StereoRig], npt.ArrayLike]
"""Left and right picture and their rig in, disparity (H, W) px out, not finite where unknown."""

Matcher: TypeAlias = str | MatcherFunction
"""``"sgbm"``, a function, its name ``package.module:function``, or a command."""


def run_function(function: MatcherFunction, left: AnyImage, right: AnyImage, rig: StereoRig) -> Any:
    """What `function` returns for copies of the pictures.

    Raises:
        MeasurementFailed: it raises; the message names what.
    """
    try:
        return function(left.copy(), right.copy(), rig)
    except Exception as error:
        name = getattr(function, "__name__", repr(function))
        raise MeasurementFailed(f"matcher {name} raised {_one_line(error)}") from error


def run_named(spec: str, left: AnyImage, right: AnyImage, rig: StereoRig, timeout_s: float) -> Any:
    """What the function ``package.module:function`` returns, run in a process that can be killed.

    Raises:
        MeasurementFailed: it cannot be imported, raises, dies or takes longer than `timeout_s`.
    """
    with guard.temporary_folder("rigsim-matcher-") as folder:
        task, answer = Path(folder, "task"), Path(folder, "answer")
        task.write_bytes(pickle.dumps((spec, left, right, rig)))
        # the same modules as here, whatever -c adds to the path
        words = [sys.executable, "-P", "-c", _CODE, str(task), str(answer), *sys.path]
        _run(words, f"matcher {spec}", timeout_s, {})
        if not answer.is_file():
            raise MeasurementFailed(f"matcher {spec} ended its process: must return")
        return _load_answer(answer.read_bytes(), spec)


def run_command(command: str, left: AnyImage, right: AnyImage, timeout_s: float) -> Any:
    """The disparity that `command` writes.

    Raises:
        MeasurementFailed: a placeholder is missing, or the command cannot be started, fails, takes longer
            than `timeout_s`, or writes no PFM or NPY file.
    """
    if not ("{left}" in command and "{right}" in command and ("{out}" in command or "{out_npy}" in command)):
        raise MeasurementFailed(f"matcher command {command!r}: must hold {{left}}, {{right}} and {{out}}")
    try:
        words = shlex.split(command)
    except ValueError as error:
        raise MeasurementFailed(f"matcher command {command!r}: {error}") from None
    with guard.temporary_folder("rigsim-matcher-") as folder:
        paths = {
            "{left}": Path(folder, "left.png"),
            "{right}": Path(folder, "right.png"),
            "{out}": Path(folder, "disparity.pfm"),
            "{out_npy}": Path(folder, "disparity.npy"),
        }
        _write_png(paths["{left}"], left)
        _write_png(paths["{right}"], right)
        for placeholder, path in paths.items():
            words = [word.replace(placeholder, str(path)) for word in words]
        _run(words, f"matcher {words[0]}", timeout_s, {})
        written = [path for path in (paths["{out}"], paths["{out_npy}"]) if path.exists()]
        if not written:
            raise MeasurementFailed(f"matcher {words[0]} ended well, but wrote no {{out}} file")
        return _load_disparity(written[0], words[0])


def _run(words: Sequence[str], name: str, timeout_s: float, environment: Mapping[str, str]) -> None:
    with tempfile.TemporaryFile() as said:
        try:
            code = programs.wait(programs.start(words, said, environment), timeout_s)
        except OSError as error:
            raise MeasurementFailed(f"{name} cannot be started: {error.strerror or error}") from None
        except subprocess.TimeoutExpired:
            raise MeasurementFailed(f"{name} took longer than {timeout_s:g} s: killed") from None
        if code != 0:
            why = f"{programs.how_it_ended(code)}: {programs.last_words(said)}".removesuffix(": ")
            raise MeasurementFailed(f"{name} failed with {why}")


def _load_answer(content: bytes, spec: str) -> Any:
    kind, value = pickle.loads(content)
    if kind == "error":
        raise MeasurementFailed(f"matcher {spec} {value}")
    return value


def _load_disparity(path: Path, name: str) -> Any:
    try:
        content = foreign.read_bytes(path, "a PFM or NPY file", follow=False)
    except OutputError as error:
        why = str(error).partition(": ")[2]
        raise MeasurementFailed(f"matcher {name}: what it left at {{out}} {why}") from None
    try:
        if content.startswith(b"\x93NUMPY"):
            return foreign.parse_npy(content, "{out}")
        return parse_pfm(content)
    except (InvalidImage, ValueError, EOFError, OverflowError, MemoryError):
        raise MeasurementFailed(f"matcher {name} wrote a file that is neither PFM nor NPY") from None


def _write_png(path: Path, image: AnyImage) -> None:
    cv2 = load_cv2()
    if image.dtype.kind == "f":
        image = np.clip(np.round(image), 0, 255).astype(np.uint8)
    if image.ndim == 3:
        image = image[..., 0] if image.shape[2] == 1 else image[..., 2::-1]
    done, content = cv2.imencode(".png", np.ascontiguousarray(image))
    if not done:
        raise MeasurementFailed(f"{path.name} could not be written as PNG")
    path.write_bytes(content.tobytes())


def _one_line(error: BaseException) -> str:
    lines = str(error).strip().splitlines()
    return f"{type(error).__name__}: {lines[0][:200]}" if lines else type(error).__name__


def _answer(task: bytes) -> tuple[str, Any]:
    """Import and call the function of a task; what goes wrong is an answer too."""
    spec, left, right, rig = pickle.loads(task)
    try:
        function: Any = strangers.find(spec)
    except (Exception, SystemExit) as error:
        return "error", f"cannot be imported: {_one_line(error)}"
    try:
        answer = np.asarray(function(left, right, rig))
    except (Exception, SystemExit) as error:
        return "error", f"raised {_one_line(error)}"
    if answer.dtype.kind not in "biuf":
        return "error", f"returned {answer.dtype}: must be real numbers (H, W), px"
    return "found", answer


def serve(task: str, answer: str) -> None:
    """Be the process of `run_named`."""
    Path(answer).write_bytes(pickle.dumps(_answer(Path(task).read_bytes())))
