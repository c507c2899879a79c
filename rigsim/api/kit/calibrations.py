"""Calibrations as people name them: a covariance.json, or what else of `rigsim calibrate` holds one."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from rigsim.api.rigs import RigLike, read_rig
from rigsim.rig import given
from rigsim.rig.stereo import StereoRig

if TYPE_CHECKING:
    from rigsim.study.tolerance.joint.cause import CalibrationTolerance


def names_calibration(word: str | os.PathLike[str]) -> bool:
    """Whether a word is the path of a file, and no class's name."""
    return isinstance(word, os.PathLike) or word.endswith(".json") or os.path.isfile(word)


def read_calibration_tolerance(path: str | os.PathLike[str]) -> CalibrationTolerance:
    """What the calibration in a file leaves.

    Raises:
        OutputError, InvalidRange, InvalidRig: as `rigsim.interop.files.covariance.read_covariance`.
    """
    from rigsim.interop.files.covariance import read_sourced
    from rigsim.study.tolerance.joint.cause import CalibrationTolerance

    file = given.path(path, "calibration")
    found = read_sourced(file)
    what = "planned pictures" if found.of == "plan" else "pictures"
    return CalibrationTolerance(Path(file).name, f"{found.pictures} {what}", found.covariance)


def rig_of_calibration(rig: RigLike | None, calibration: CalibrationTolerance) -> StereoRig:
    """The calibrated rig; where a rig was named too, it must be that one.

    Raises:
        InvalidRig: it is another.
        OutputError, InvalidRange: as `read_rig`.
    """
    from rigsim.study.tolerance.joint.cause import check_rig

    if rig is not None:
        check_rig(calibration.covariance.rig, read_rig(rig), calibration.name)
    return calibration.covariance.rig
