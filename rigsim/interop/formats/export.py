"""A rig as the calibration files of other programs."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.interop.formats import colmap, kalibr, mjcf, nerfstudio, opencv_yaml, ros
from rigsim.interop.formats.middlebury import calib_text
from rigsim.rig.stereo import StereoRig


def _ros(rig: StereoRig) -> dict[str, str]:
    return dict(zip(ros.FILE_NAMES, ros.camera_info_yaml(rig), strict=True))


RIG_FORMATS: Mapping[str, Callable[[StereoRig], Mapping[str, str]]] = {
    "opencv": lambda rig: {opencv_yaml.FILE_NAME: opencv_yaml.opencv_yaml(rig)},
    "ros": _ros,
    "kalibr": lambda rig: {kalibr.FILE_NAME: kalibr.camchain_yaml(rig)},
    "middlebury": lambda rig: {"calib.txt": calib_text(rig)},
    "colmap": colmap.colmap_files,
    "mjcf": lambda rig: {mjcf.FILE_NAME: mjcf.rig_xml(rig)},
    "nerfstudio": lambda rig: {nerfstudio.FILE_NAME: nerfstudio.transforms_json(rig)},
}
"""The formats by name; each turns a rig into texts by file name, or raises `InvalidRig`."""


def rig_files(rig: StereoRig, format: str) -> dict[str, bytes]:
    """The calibration files of `rig` in a format of `RIG_FORMATS`, by name.

    Raises:
        InvalidRange: there is no such format.
        InvalidRig: the format cannot hold the rig; the message names those that can.
    """
    if format not in RIG_FORMATS:
        raise InvalidRange(f"format {format!r}: must be one of {', '.join(RIG_FORMATS)}")
    try:
        texts = RIG_FORMATS[format](rig)
    except InvalidRig as error:
        able = ", ".join(name for name in RIG_FORMATS if _holds(name, rig))
        raise InvalidRig(f"format {format}: {error}; formats that hold this rig: {able}") from None
    return {name: text.encode() for name, text in texts.items()}


def _holds(format: str, rig: StereoRig) -> bool:
    try:
        RIG_FORMATS[format](rig)
    except InvalidRig:
        return False
    return True
