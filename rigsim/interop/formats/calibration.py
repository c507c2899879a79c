"""Any calibration file, or folder of them, as a rig: what `--rig` takes.

A file is known by its name's ending and by what it says, a folder by the names in it.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rigsim.errors import InvalidRig, OutputError
from rigsim.interop.formats import middlebury, registry, rig_toml
from rigsim.interop.formats.format import Format
from rigsim.interop.formats.values import read_text
from rigsim.rig import given
from rigsim.rig.perturbation import Perturbation
from rigsim.rig.stereo import StereoRig

if TYPE_CHECKING:
    from rigsim.rig.sensor import Sensor

# what a folder is known by
_IN_FOLDERS = (
    *(format.in_folder for format in registry.ALL),
    *(format.in_dataset for format in registry.ALL if format.in_dataset),
)


def read_calibration(path: str | Path) -> StereoRig:
    """The rig in a calibration file of any format that rigsim writes, or in a folder with one.

    rig.toml; OpenCV's stereo.yml; ROS's left.yaml with right.yaml beside it; Kalibr's camchain.yaml;
    Middlebury's calib.txt; KITTI's calib_cam_to_cam.txt; COLMAP's cameras.txt with its neighbours; MJCF's
    rig.xml; Nerfstudio's transforms.json.

    A calibration with its right camera on the left side is refused; a rig.toml or rig.xml is taken as it was
    drawn up.

    Raises:
        OutputError: it cannot be read, or is a folder with no calibration or with several.
        InvalidRig: it holds no rig that can be, or has its sides exchanged; the message names the file.
    """
    path = _found(given.path(path, "calibration file"))
    format = _format(path)
    rig = format.rig(path)
    if not format.drawn_up:
        _check_sides(rig, str(path))
    return rig


def parse_calibration(text: str) -> StereoRig:
    """The rig in the text of one calibration file; its format is known by what it says.

    Raises:
        InvalidRig: it holds no rig that can be, or has its sides exchanged.
    """
    format = registry.of_text(text)
    assert format.parse is not None, format.name
    rig = format.parse(text)
    if not format.drawn_up:
        _check_sides(rig, "rig")
    return rig


def is_toml(text: str) -> bool:
    """Whether the text of a calibration file is a rig.toml's, which alone tells more than the rig."""
    return registry.of_text(text) is rig_toml.FORMAT


def in_folder(path: Path) -> list[str]:
    """The names in a folder that a calibration is known by."""
    return [name for name in _IN_FOLDERS if (path / name).is_file()]


def calibration_sensor(path: Path) -> Sensor | None:
    """The sensor in what `read_calibration` reads; only a rig.toml says something of one.

    Raises:
        OutputError, InvalidRig: as `rigsim.interop.formats.rig_toml.read_sensor`.
    """
    path = _found(path)
    return rig_toml.read_sensor(path) if _format(path) is rig_toml.FORMAT else None


def calibration_perturbation(path: Path) -> Perturbation | None:
    """How the built rig differs from what `read_calibration` reads; only a rig.toml says something of it.

    Raises:
        OutputError, InvalidRig: as `rigsim.interop.formats.rig_toml.read_perturbation`.
    """
    path = _found(path)
    return rig_toml.read_perturbation(path) if _format(path) is rig_toml.FORMAT else None


def disparity_range(path: Path) -> tuple[float, float] | None:
    """Least and largest disparity, px, in what `read_calibration` reads; only Middlebury's calib.txt has one.

    Raises:
        OutputError, InvalidRig: as `rigsim.interop.formats.middlebury.read_calib`.
    """
    path = _found(path)
    if path.suffix.lower() not in middlebury.FORMAT.suffixes or _format(path) is not middlebury.FORMAT:
        return None
    return middlebury.read_calib(path).disparity_range


def _format(path: Path) -> Format:
    """The format of a file, which is looked into only where its name does not tell."""
    return registry.of_file(path.suffix.lower(), path.name, lambda: read_text(path))


def _check_sides(rig: StereoRig, name: str) -> None:
    if _sides_exchanged(rig):
        raise InvalidRig(
            f"{name}: the right camera lies {rig.baseline_m * 1e3:.4g} mm to the left of the left one: the"
            " cameras are exchanged, or the pose between them is inverted; exchange the cameras in the file"
        )


def _sides_exchanged(rig: StereoRig) -> bool:
    """Whether both cameras of a horizontal pair see the other one on the wrong side."""
    right_in_left, left_in_right = rig.right_from_left.inverse.t, rig.right_from_left.t
    sideways = all(abs(place[0]) == np.abs(place).max() for place in (right_in_left, left_in_right))
    return bool(sideways and right_in_left[0] < 0 < left_in_right[0])


def _found(path: Path) -> Path:
    """The file itself, or the one calibration in a folder."""
    if not os.path.isdir(path):  # unlike Path's, it takes names of any length
        return path
    found = in_folder(path)
    if not found:
        raise OutputError(f"{path}: holds no calibration; name a folder with {_known()}")
    if len(found) > 1:
        raise OutputError(f"{path}: holds {', '.join(found)}; name one of them")
    return path / found[0]


def _known() -> str:
    *others, last = (format.in_folder for format in registry.ALL)
    return f"{', '.join(others)} or {last}"
