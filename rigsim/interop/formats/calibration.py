"""Any calibration file, or folder of them, as a rig: what `--rig` takes.

A file is known by its name's ending and by what it says, a folder by the names in it.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rigsim.errors import InvalidRig, OutputError
from rigsim.interop.formats.colmap import parse_colmap
from rigsim.interop.formats.kalibr import parse_camchain
from rigsim.interop.formats.kitti import parse_cam_to_cam
from rigsim.interop.formats.middlebury import parse_calib, read_calib
from rigsim.interop.formats.mjcf import parse_rig_xml
from rigsim.interop.formats.nerfstudio import parse_transforms
from rigsim.interop.formats.opencv_yaml import parse_opencv_yaml
from rigsim.interop.formats.rig_toml import parse_rig, read_perturbation, read_sensor
from rigsim.interop.formats.rig_toml import read_rig as read_rig_toml
from rigsim.interop.formats.ros import FILE_NAMES as ROS_NAMES
from rigsim.interop.formats.ros import parse_camera_info
from rigsim.interop.formats.values import read_text
from rigsim.rig import given
from rigsim.rig.perturbation import Perturbation
from rigsim.rig.stereo import StereoRig

if TYPE_CHECKING:
    from rigsim.rig.sensor import Sensor

_COLMAP_NAMES = ("cameras.txt", "rigs.txt", "images.txt")
# what a folder is known by, the first name of each
_IN_FOLDERS = (
    "rig.toml",
    "stereo.yml",
    "camchain.yaml",
    *ROS_NAMES[:1],
    "calib.txt",
    "calib_cam_to_cam.txt",
    "cameras.txt",
    "rig.xml",
    "transforms.json",
    # of a data set of `rigsim.interop.files.dataset`: that of its first frame, as all have the same
    "000000/calib.txt",
    "training/calib_cam_to_cam/000000.txt",
    "sparse/0/cameras.txt",
)
_KNOWN = "rig.toml, stereo.yml, camchain.yaml, left.yaml, calib.txt, cameras.txt, rig.xml or transforms.json"
_MIDDLEBURY = re.compile(r"^\s*cam0\s*=", re.MULTILINE)
_YAML = re.compile(r"^\s*\w+\s*:", re.MULTILINE)
_KITTI = re.compile(r"^\s*P_rect_0\d\s*:", re.MULTILINE)
_KALIBR = re.compile(r"^cam[01]\s*:", re.MULTILINE)
_ROS = re.compile(r"^(camera_matrix|projection_matrix|distortion_model)\s*:", re.MULTILINE)


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
    suffix = path.suffix.lower()
    if suffix not in _PARSERS:
        return read_rig_toml(path)
    rig = _PARSERS[suffix](path)
    if suffix != ".xml":
        _check_sides(rig, str(path))
    return rig


def parse_calibration(text: str) -> StereoRig:
    """The rig in the text of one calibration file; its format is known by what it says.

    Raises:
        InvalidRig: it holds no rig that can be, or has its sides exchanged.
    """
    parse, drawn_up = _parser(text)
    rig = parse(text)
    if not drawn_up:
        _check_sides(rig, "rig")
    return rig


def is_toml(text: str) -> bool:
    """Whether the text of a calibration file is a rig.toml's, which alone tells more than the rig."""
    return _parser(text)[0] is parse_rig


def in_folder(path: Path) -> list[str]:
    """The names in a folder that a calibration is known by."""
    return [name for name in _IN_FOLDERS if (path / name).is_file()]


def calibration_sensor(path: Path) -> Sensor | None:
    """The sensor in what `read_calibration` reads; only a rig.toml says something of one.

    Raises:
        OutputError, InvalidRig: as `rigsim.interop.formats.rig_toml.read_sensor`.
    """
    path = _found(path)
    return None if path.suffix.lower() in _PARSERS else read_sensor(path)


def calibration_perturbation(path: Path) -> Perturbation | None:
    """How the built rig differs from what `read_calibration` reads; only a rig.toml says something of it.

    Raises:
        OutputError, InvalidRig: as `rigsim.interop.formats.rig_toml.read_perturbation`.
    """
    path = _found(path)
    return None if path.suffix.lower() in _PARSERS else read_perturbation(path)


def disparity_range(path: Path) -> tuple[float, float] | None:
    """Least and largest disparity, px, in what `read_calibration` reads; only Middlebury's calib.txt has one.

    Raises:
        OutputError, InvalidRig: as `rigsim.interop.formats.middlebury.read_calib`.
    """
    path = _found(path)
    if path.suffix.lower() != ".txt" or path.name in _COLMAP_NAMES or _is_kitti(read_text(path)):
        return None
    return read_calib(path).disparity_range


def _parser(text: str) -> tuple[Callable[[str], StereoRig], bool]:
    """What reads a text, and whether that is a rig as somebody drew it up, not a calibration."""
    start = text.lstrip()[:1]
    if start == "<":
        return parse_rig_xml, True
    if start == "{":
        return parse_transforms, False
    if _MIDDLEBURY.search(text):
        return (lambda text: parse_calib(text).rig), False
    if _KITTI.search(text):
        return parse_cam_to_cam, False
    if _KALIBR.search(text):
        return parse_camchain, False
    if text.startswith("%YAML") or _YAML.search(text):
        return parse_opencv_yaml, False
    return parse_rig, True


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
        raise OutputError(f"{path}: holds no calibration; name a folder with {_KNOWN}")
    if len(found) > 1:
        raise OutputError(f"{path}: holds {', '.join(found)}; name one of them")
    return path / found[0]


def _parsed(path: Path, parse: Callable[[str], StereoRig]) -> StereoRig:
    """A format of one file, with its name in messages."""
    try:
        return parse(read_text(path))
    except InvalidRig as error:
        raise InvalidRig(f"{path}: {error}") from None


def _txt(path: Path) -> StereoRig:
    if path.name in _COLMAP_NAMES:
        return _colmap(path.parent)
    if _is_kitti(read_text(path)):
        return _parsed(path, parse_cam_to_cam)
    return read_calib(path).rig


def _yaml(path: Path) -> StereoRig:
    def parse(text: str) -> StereoRig:
        return parse_camchain(text) if _KALIBR.search(text) else parse_opencv_yaml(text)

    if path.name in ROS_NAMES:
        return _ros(path.parent)
    if os.path.isfile(path) and _ROS.search(read_text(path)):
        raise InvalidRig(
            f"{path}: camera_info of one camera; name both {' and '.join(ROS_NAMES)}, side by side"
        )
    return _parsed(path, parse)


def _ros(folder: Path) -> StereoRig:
    left, right = (read_text(folder / name) for name in ROS_NAMES)
    try:
        return parse_camera_info(left, right)
    except InvalidRig as error:
        raise InvalidRig(f"{folder}: {error}") from None


def _colmap(folder: Path) -> StereoRig:
    needed, *others = _COLMAP_NAMES
    names = [needed, *(name for name in others if (folder / name).exists())]
    try:
        return parse_colmap({name: read_text(folder / name) for name in names})
    except InvalidRig as error:
        raise InvalidRig(f"{folder}: {error}") from None


def _is_kitti(text: str) -> bool:
    return _KITTI.search(text) is not None and _MIDDLEBURY.search(text) is None


_PARSERS: dict[str, Callable[[Path], StereoRig]] = {
    ".txt": _txt,
    ".yml": _yaml,
    ".yaml": _yaml,
    ".xml": lambda path: _parsed(path, parse_rig_xml),
    ".json": lambda path: _parsed(path, parse_transforms),
}
"""What reads a file with this ending; the others are rig.toml's."""
