"""What made the numbers: versions, renderer, scene."""

from __future__ import annotations

import platform
from importlib.metadata import version

from rigsim.sim.simulator import Simulator

_PACKAGES = ("rigsim", "mujoco", "numpy", "scipy", "pandas", "matplotlib")


def versions() -> dict[str, object]:
    """Versions of rigsim, of what it stands on, and of Python."""
    return {**{name: version(name) for name in _PACKAGES}, "python": platform.python_version()}


def simulator_provenance(simulator: Simulator) -> dict[str, object]:
    """Versions, renderer, scene and mount, as JSON values."""
    return {
        **versions(),
        "renderer": simulator.gl_renderer,
        "scene": simulator.scene.name,
        "mount": simulator.scene.mount,
    }
