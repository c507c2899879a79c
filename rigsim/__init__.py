"""rigsim: a simulation-verified stereo rig designer.

Everything in `__all__` can be imported from here; a name's module is loaded when the name is first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from rigsim._version import __version__

if TYPE_CHECKING:
    from rigsim.errors import RigsimError
    from rigsim.interop.formats.calibration import read_rig
    from rigsim.interop.formats.rig_toml import write_rig
    from rigsim.rig.intrinsics import Intrinsics
    from rigsim.rig.lens.distortion import BrownConrady
    from rigsim.rig.noise import PixelNoise
    from rigsim.rig.observations import Observations
    from rigsim.rig.perturbation import Perturbation
    from rigsim.rig.pose import Pose
    from rigsim.rig.presets import PRESETS, preset
    from rigsim.rig.stereo import StereoRig
    from rigsim.sim.simulator import Simulator
    from rigsim.study.scene.plan import Plan, RigGrid
    from rigsim.study.sweep.result import SweepResult
    from rigsim.study.sweep.run import sweep
    from rigsim.theory.sensitivity import depth_sensitivity
    from rigsim.theory.triangulation import triangulate
    from rigsim.theory.uncertainty import (
        depth_bounds,
        depth_in_sigmas,
        parallax_px,
        predict_covariance,
        predict_depth_bias,
        predict_depth_rmse,
        predict_depth_std,
    )

_MODULES = {
    "rigsim.errors": ("RigsimError",),
    "rigsim.interop.formats.calibration": ("read_rig",),
    "rigsim.interop.formats.rig_toml": ("write_rig",),
    "rigsim.rig.lens.distortion": ("BrownConrady",),
    "rigsim.rig.intrinsics": ("Intrinsics",),
    "rigsim.rig.noise": ("PixelNoise",),
    "rigsim.rig.observations": ("Observations",),
    "rigsim.rig.perturbation": ("Perturbation",),
    "rigsim.rig.pose": ("Pose",),
    "rigsim.rig.presets": ("PRESETS", "preset"),
    "rigsim.rig.stereo": ("StereoRig",),
    "rigsim.sim.simulator": ("Simulator",),
    "rigsim.study.scene.plan": ("Plan", "RigGrid"),
    "rigsim.study.sweep.result": ("SweepResult",),
    "rigsim.study.sweep.run": ("sweep",),
    "rigsim.theory.sensitivity": ("depth_sensitivity",),
    "rigsim.theory.triangulation": ("triangulate",),
    "rigsim.theory.uncertainty": (
        "depth_bounds",
        "depth_in_sigmas",
        "parallax_px",
        "predict_covariance",
        "predict_depth_bias",
        "predict_depth_rmse",
        "predict_depth_std",
    ),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}

__all__ = [
    "PRESETS",
    "BrownConrady",
    "Intrinsics",
    "Observations",
    "Perturbation",
    "PixelNoise",
    "Plan",
    "Pose",
    "RigGrid",
    "RigsimError",
    "Simulator",
    "StereoRig",
    "SweepResult",
    "__version__",
    "depth_bounds",
    "depth_in_sigmas",
    "depth_sensitivity",
    "parallax_px",
    "predict_covariance",
    "predict_depth_bias",
    "predict_depth_rmse",
    "predict_depth_std",
    "preset",
    "read_rig",
    "sweep",
    "triangulate",
    "write_rig",
]


def __getattr__(name: str) -> object:
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'rigsim' has no attribute {name!r}")
    value = getattr(import_module(_MODULE_OF[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
