"""The one gate between scene files and MuJoCo: whatever it raises or warns of leaves here as one line."""

from __future__ import annotations

import contextlib
import re
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from rigsim import programs
from rigsim.errors import InvalidScene
from rigsim.sim.scenes.library import models_dir
from rigsim.sim.scenes.outline import outline

LONGEST_S = 9.0
"""Processor time that a scene may take to compile where that cannot be told beforehand."""
MOST_GB = 2.0
"""Memory that it may take meanwhile."""
LARGEST_M = 1e9
"""Lengths and distances beyond this, twice the way to the Moon, are a slip of the pen."""

_heard: list[str] = []
if mujoco.get_mju_user_warning() is None:
    # otherwise MuJoCo prints them, and writes MUJOCO_LOG.TXT where the user is
    mujoco.set_mju_user_warning(_heard.append)

_OURS = re.compile(r"rigsim_(left|right)")
_LONGEST_WORDS = 300
_NO_REASON = "Caught an unknown exception"
_TRY = """
import resource, sys
import mujoco
byte, second = int(float(sys.argv[2]) * 1e9), int(float(sys.argv[3]))
with open("/proc/self/statm") if sys.platform == "linux" else open("/dev/null") as file:
    byte += int((file.read().split() or ["0"])[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (byte, byte))
resource.setrlimit(resource.RLIMIT_CPU, (second, second))
resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
mujoco.set_mju_user_warning(lambda text: None)
try:
    model = mujoco.MjSpec.from_file(sys.argv[1]).compile()
    mujoco.mj_fwdPosition(model, mujoco.MjData(model))
except MemoryError:
    sys.exit(3)
except Exception as error:
    sys.exit(3 if "unknown exception" in str(error) or "allocate memory" in str(error) else 0)
"""


def check(path: Path) -> None:
    """Refuse a scene file that asks for too much, hangs MuJoCo or kills it; bundled ones pass unread.

    Raises:
        InvalidScene: it does.
    """
    if path.is_relative_to(models_dir()):
        return
    if path.suffix.lower() not in {".xml", ".mjcf", ".urdf"}:
        raise InvalidScene(f"{path}: an MJCF file ends in .xml")
    if not outline(path).plain:
        _try_apart(path)


@contextlib.contextmanager
def passing(path: Path) -> Iterator[list[str]]:
    """Turn what MuJoCo raises in the block into `InvalidScene`; yields what it warns of, as it comes.

    Raises:
        InvalidScene: MuJoCo raised something, or a part of rigsim refuses the scene.
    """
    heard: list[str] = []
    before = mujoco.get_mju_user_warning()
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        mujoco.set_mju_user_warning(heard.append)
        try:
            yield heard
        except InvalidScene as error:
            begin = "" if str(error).startswith((str(path), "mount ")) else f"{path}: "
            raise InvalidScene(f"{begin}{clipped(str(error))}") from None
        except UnicodeError:
            raise InvalidScene(f"{path}: a name or text in it is not UTF-8: save it as UTF-8") from None
        except MemoryError:
            raise InvalidScene(f"{path}: does not fit into memory: take fewer or smaller elements") from None
        except RecursionError:
            raise InvalidScene(f"{path}: its elements are nested too deep: fix the file") from None
        except (ValueError, RuntimeError, TypeError, KeyError, OverflowError, mujoco.FatalError) as error:
            raise InvalidScene(f"{path}: {in_words(str(error))}: fix the file") from None
        finally:
            mujoco.set_mju_user_warning(before)
            heard += [str(each.message) for each in warned]


def heard() -> tuple[str, ...]:
    """What MuJoCo has warned of since the last time, other than of a file."""
    said = tuple(_heard)
    _heard.clear()
    return said


def in_words(said: str) -> str:
    """What MuJoCo said, without its machinery."""
    text = " ".join(said.split())
    if not text or _NO_REASON in text:
        return (
            "MuJoCo cannot compile it and gives no reason; a size or count is too large, or a file is broken"
        )
    if "allocate memory" in text:
        return "does not fit into memory, with fewer or smaller elements it may"
    text = re.sub(r"XML parse error \d+:", "XML:", text)
    text = re.sub(
        r"Error=XML_(?:ERROR_)?([A-Z_]+)", lambda match: match[1].lower().replace("_", " ") + ",", text
    )
    text = re.sub(r"ErrorID=\d+ \(0x[0-9a-f]+\)\s*", "", text)
    text = re.sub(r"^(?:XML Error|Error|engine error):\s*(?:(?:Error|engine error):\s*)*", "", text)
    text = text.replace("Line number=", "line ").replace(" Element name '',", "")
    return clipped(text).rstrip(".: ")


def check_names(spec: Any) -> None:
    """Refuse cameras that are called as rigsim's own.

    Raises:
        InvalidScene: there is one.
    """
    for camera in spec.cameras:
        if _OURS.fullmatch(camera.name):
            raise InvalidScene(f"camera {camera.name}: the name is rigsim's own: rename it")


def check_numbers(model: Any, data: Any, path: Path) -> None:
    """Refuse places and sizes that are no numbers, or farther than anything.

    Raises:
        InvalidScene: there are some.
    """
    for kind, count, what, values in (
        ("geom", model.ngeom, "size", model.geom_size),
        ("geom", model.ngeom, "place", data.geom_xpos),
        ("geom", model.ngeom, "attitude", data.geom_xmat),
        ("camera", model.ncam, "place", data.cam_xpos),
        ("camera", model.ncam, "attitude", data.cam_xmat),
        ("site", model.nsite, "place", data.site_xpos),
        ("body", model.nbody, "place", data.xpos),
    ):
        table = np.asarray(values).reshape(count, values.size // max(1, count))
        # written so that it is wrong for NaN
        wrong = np.flatnonzero(~(np.abs(table) <= LARGEST_M).all(axis=1))
        if len(wrong):
            index = int(wrong[0])
            name = getattr(model, kind)(index).name or f"number {index + 1}"
            worst = table[index][~(np.abs(table[index]) <= LARGEST_M)][0]
            raise InvalidScene(
                f"{path}: {kind} {clipped(name)}: {worst:g} in its {what}, "
                f"must be from {-LARGEST_M:g} to {LARGEST_M:g} m"
            )


def _try_apart(path: Path) -> None:
    """Compile the file in a process of its own, with limits.

    Raises:
        InvalidScene: it takes too long or too much memory, or ends the process.
    """
    words = [sys.executable, "-c", _TRY, str(path.resolve()), f"{MOST_GB:g}", f"{LONGEST_S:g}"]
    with tempfile.TemporaryFile() as said:
        try:
            # the user's folder must not stand before the libraries
            process = programs.start(words, said, {"MUJOCO_GL": "disable", "PYTHONSAFEPATH": "1"})
        except OSError as error:
            raise InvalidScene(f"{path}: cannot be tried: {error.strerror or error}") from None
        try:
            code = programs.wait(process, 3 * LONGEST_S)
        except subprocess.TimeoutExpired:
            code = -24
    if code in (-24, -9):  # SIGXCPU, or SIGKILL right after
        raise InvalidScene(
            f"{path}: MuJoCo takes more than {LONGEST_S:g} s to compile it: take fewer elements"
        )
    if code == 3:
        raise InvalidScene(
            f"{path}: takes more than {MOST_GB:g} GB of memory: take fewer or smaller elements"
        )
    if code < 0:
        ended = programs.how_it_ended(code)
        raise InvalidScene(
            f"{path}: MuJoCo dies of it with {ended}: fix the file (a model that attaches itself?)"
        )


def clipped(text: str) -> str:
    """The first 300 characters of a text, fit for any console."""
    plain = programs.plain(" ".join(text.split()), _LONGEST_WORDS + 1)
    return plain if len(plain) <= _LONGEST_WORDS else plain[: _LONGEST_WORDS - 3] + "..."
