"""Rigs as people name them: a preset, a calibration file, its text, or a rig; and grids of them."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from rigsim.errors import InvalidRange, InvalidScene
from rigsim.rig import given
from rigsim.rig.stereo import StereoRig

if TYPE_CHECKING:
    from rigsim.rig.perturbation import Perturbation
    from rigsim.rig.sensor import Sensor

RigLike: TypeAlias = StereoRig | str | os.PathLike[str]
"""A rig, a preset's name, the path of a calibration, or a calibration file's text."""

Several: TypeAlias = float | Iterable[float]
"""One number or several."""

Sizes: TypeAlias = tuple[int, int] | Iterable[tuple[int, int]]
"""One (width, height), px, or several."""

DEFAULT_PRESET = "boards"


def read_rig(rig: RigLike) -> StereoRig:
    """The rig that a name, a path or a text says.

    Every calibration format that rigsim writes is read: rig.toml; OpenCV's stereo.yml; ROS's left.yaml with
    right.yaml beside it; Kalibr's camchain.yaml; Middlebury's calib.txt; KITTI's calib_cam_to_cam.txt;
    COLMAP's cameras.txt; MJCF's rig.xml; Nerfstudio's transforms.json; or a folder with one of them.

    A calibration with its right camera on the left side is refused; a rig.toml or rig.xml is taken as it was
    drawn up.

    Args:
        rig: A preset's name, as ``oak-d``; the path of a file or folder, which comes first where both exist;
            the text of a file, which has more than one line; or a rig, which comes back as it is.

    Raises:
        OutputError: a file cannot be read, or a folder holds no calibration or several.
        InvalidRig: it holds no rig that can be, or has its sides exchanged.
        InvalidRange: it is none of these.

    Example:
        >>> import rigsim
        >>> rig = rigsim.read_rig("oak-d")
        >>> print(f"{rig.baseline_m * 1e3:.0f} mm, {rig.left.width}x{rig.left.height} px")
        75 mm, 1280x800 px
        >>> rigsim.read_rig(rigsim.write_rig(rig)) == rig
        True
    """
    if isinstance(rig, StereoRig):
        return rig
    name = _preset_name(rig)
    if name is not None:
        from rigsim.rig.presets import preset

        return preset(name).rig
    from rigsim.interop.formats.calibration import parse_calibration, read_calibration

    if isinstance(rig, str) and "\n" in rig:
        return parse_calibration(rig)
    path = given.path(rig, "rig")
    if isinstance(rig, str) and not path.suffix and path.name == rig and not os.path.lexists(path):
        from rigsim.rig.presets import PRESETS

        raise InvalidRange(
            f"rig {given.shown(rig)}: no file here and no preset has that name; name a file, or one of "
            f"{', '.join(PRESETS)}"
        )
    return read_calibration(path)


@dataclass(frozen=True, slots=True)
class Told:
    """All that a file says besides its rig; nothing where no file was named."""

    sensor: Sensor | None = None
    """Its sensor."""
    perturbation: Perturbation | None = None
    """How the built rig differs from it."""
    disparities_px: tuple[float, float] | None = None
    """Disparities to search, px."""


def told_of(rig: RigLike | None) -> Told:
    """What the file or text behind `rig` says besides the rig.

    Raises:
        OutputError, InvalidRig: as `read_rig`.
    """
    if rig is None or isinstance(rig, StereoRig) or _preset_name(rig) is not None:
        return Told()
    from rigsim.interop.formats import calibration, rig_toml

    if isinstance(rig, str) and "\n" in rig:
        if not calibration.is_toml(rig):
            return Told()
        return Told(rig_toml.parse_sensor(rig), rig_toml.parse_perturbation(rig))
    path = given.path(rig, "rig")
    return Told(
        calibration.calibration_sensor(path),
        calibration.calibration_perturbation(path),
        calibration.disparity_range(path),
    )


def rig_for(rig: RigLike | None, scene: str = "") -> StereoRig:
    """The rig that is named, or the one that is made for a scene."""
    from rigsim.rig.presets import PRESETS, preset

    if rig is not None:
        return read_rig(rig)
    return preset(scene if scene in PRESETS else DEFAULT_PRESET).rig


def rig_file(rig: RigLike | None) -> str:
    """How messages call the file of `rig`."""
    return "rig" if rig is None or isinstance(rig, StereoRig) or "\n" in str(rig) else str(rig)


def _preset_name(rig: str | os.PathLike[str]) -> str | None:
    """The preset that a word names where no file and no folder with a calibration has that name."""
    if not isinstance(rig, str) or "\n" in rig:
        return None
    from rigsim.rig.presets import preset

    try:
        name = preset(rig).name
    except InvalidScene:
        return None
    if os.path.isfile(rig):
        return None
    if os.path.isdir(rig):
        from rigsim.interop.formats.calibration import in_folder

        return None if in_folder(Path(rig)) else name
    return name
