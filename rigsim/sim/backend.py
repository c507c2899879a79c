"""Which renderer works here: EGL, OSMesa, or rays alone.

A missing GL library can kill the interpreter that asks for it, so each one is tried in a subprocess
that renders a few pixels. A success is remembered; a failure is tried again the next time.
"""

from __future__ import annotations

import ctypes
import hashlib
import importlib
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from rigsim.errors import RenderUnavailable

RENDERERS: tuple[str, ...] = ("auto", "egl", "osmesa", "rays")
"""What may be asked for."""

_LIBRARIES = {"egl": "libEGL.so.1", "osmesa": "libOSMesa.so.8"}
_INSTALL = {
    "egl": "apt-get install --no-install-recommends libegl1 libopengl0 libgl1-mesa-dri",
    "osmesa": "apt-get install --no-install-recommends libosmesa6",
}
_PROBE_TIMEOUT_S = 60
_PROBE = """
import sys, mujoco
model = mujoco.MjModel.from_xml_string("<mujoco><worldbody><light pos='0 0 3'/>"
    "<geom type='plane' size='1 1 1' rgba='1 1 1 1'/></worldbody></mujoco>")
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
with mujoco.Renderer(model, 8, 8) as renderer:
    renderer.update_scene(data)
    sys.exit(0 if renderer.render().any() else "rendered nothing")
"""


@dataclass(frozen=True, slots=True)
class Probe:
    """What came of trying one renderer."""

    name: str
    """egl, osmesa or rays."""
    works: bool
    """Whether it rendered."""
    detail: str
    """Why not, or how, one line."""
    install: str
    """The one line that installs what is missing; empty when nothing is."""


def choose(renderer: str = "auto") -> str:
    """The renderer to use: the one asked for, or with "auto" the best that works.

    Raises:
        RenderUnavailable: the one asked for does not work here; the message says what installs it.
    """
    if renderer not in RENDERERS:
        raise RenderUnavailable(f"unknown renderer {renderer!r}: choose one of {', '.join(RENDERERS)}")
    if renderer == "rays":
        return renderer
    if renderer != "auto":
        result = probe(renderer)
        if not result.works:
            raise RenderUnavailable(
                f"renderer {renderer} does not work here ({result.detail}): "
                f"install it with `{_INSTALL[renderer]}`, or use --renderer rays"
            )
        return renderer
    return next((name for name in _order() if probe(name).works), "rays")


def probe(name: str) -> Probe:
    """Try one renderer, in a subprocess unless it is known to work."""
    if name == "rays":
        return Probe(name, True, "needs no GL", "")
    if not _loads(_LIBRARIES[name]):
        return Probe(name, False, f"{_LIBRARIES[name]} is missing", _INSTALL[name])
    stamp = _stamp(name)
    if stamp.exists():
        return Probe(name, True, "worked before", "")
    environment = {**os.environ, "MUJOCO_GL": name, "PYOPENGL_PLATFORM": name}
    try:
        done = subprocess.run(
            [sys.executable, "-c", _PROBE],
            env=environment,
            capture_output=True,
            text=True,
            timeout=_PROBE_TIMEOUT_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return Probe(name, False, f"no answer within {_PROBE_TIMEOUT_S} s", _INSTALL[name])
    if done.returncode != 0:
        reason = (done.stderr.strip().splitlines() or ["no message"])[-1][:160]
        return Probe(name, False, reason, _INSTALL[name])
    _remember(stamp)
    return Probe(name, True, "rendered a test picture", "")


def load_mujoco(backend: str) -> ModuleType:
    """Import mujoco so that it does not reach for a GL library that is not there."""
    os.environ["MUJOCO_GL"] = "disable" if backend == "rays" else backend
    return importlib.import_module("mujoco")


def make_gl_context(backend: str, width: int, height: int) -> Any:
    """A current off-screen GL context of the backend.

    Raises:
        RenderUnavailable: it cannot be made, though it worked before.
    """
    try:
        context = importlib.import_module(f"mujoco.{backend}").GLContext(width, height)
        context.make_current()
    except Exception as error:  # PyOpenGL raises whatever the driver provokes
        _stamp(backend).unlink(missing_ok=True)
        reason = " ".join(str(error).split())[:120] or repr(error)
        raise RenderUnavailable(
            f"renderer {backend} failed to start ({reason}): "
            f"install it with `{_INSTALL[backend]}`, or use --renderer rays"
        ) from None
    return context


def _order() -> tuple[str, ...]:
    """EGL first, then OSMesa, unless the environment already names one."""
    preset = os.environ.get("MUJOCO_GL", "").lower()
    return ("osmesa", "egl") if preset == "osmesa" else ("egl", "osmesa")


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def _stamp(name: str) -> Path:
    """Where a success is remembered: one empty file for each renderer, interpreter and MuJoCo."""
    from importlib.metadata import version

    key = hashlib.sha256(f"{sys.prefix}|{version('mujoco')}|{name}".encode()).hexdigest()[:16]
    cache = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return Path(cache) / "rigsim" / f"renderer-{name}-{key}"


def _remember(stamp: Path) -> None:
    try:
        stamp.parent.mkdir(parents=True, exist_ok=True)
        stamp.touch()
    except OSError:
        return  # a read-only home only costs the next probe
