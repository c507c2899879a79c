"""Every calibration format. A new one is a file here and a line below; what reads and writes follows."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from rigsim.errors import InvalidRange, InvalidRig
from rigsim.interop.formats import (
    colmap,
    kalibr,
    kitti,
    middlebury,
    mjcf,
    nerfstudio,
    opencv_yaml,
    rig_toml,
    ros,
)
from rigsim.interop.formats.format import Format
from rigsim.rig.stereo import StereoRig

ALL: tuple[Format, ...] = (
    rig_toml.FORMAT,
    opencv_yaml.FORMAT,
    ros.FORMAT,
    kalibr.FORMAT,
    middlebury.FORMAT,
    kitti.FORMAT,
    colmap.FORMAT,
    mjcf.FORMAT,
    nerfstudio.FORMAT,
)
"""All that are read."""

RIG_FORMATS: Mapping[str, Callable[[StereoRig], Mapping[str, str]]] = MappingProxyType(
    {format.name: format.write for format in ALL if format.write is not None}
)
"""Those that are written, by name; each turns a rig into texts by file name, or raises `InvalidRig`."""

OURS_ALONE = "none but rig.toml (rigsim.write_rig)"
"""Which formats hold a rig, where none that is written does."""


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
        able = ", ".join(name for name in RIG_FORMATS if _holds(name, rig)) or OURS_ALONE
        raise InvalidRig(f"format {format}: {error}; formats that hold this rig: {able}") from None
    return {name: text.encode() for name, text in texts.items()}


def of_text(text: str) -> Format:
    """The format of one file's text."""
    return next(format for format in _in_turn(ALL) if format.parse is not None and format.knows(text))


def of_file(suffix: str, name: str, text: Callable[[], str]) -> Format:
    """The format of a file, by its ending and name, and by its text where these do not tell."""
    able = [format for format in ALL if suffix in format.suffixes]
    named = [format for format in able if name in format.names]
    if len(able) < 2 or named:
        return (named or able or [rig_toml.FORMAT])[0]
    said = text()
    known = (format for format in _in_turn(able) if format.knows(said))
    return next(known, next(format for format in able if suffix in format.otherwise))


def _in_turn(formats: tuple[Format, ...] | list[Format]) -> list[Format]:
    # of those that are asked last, rig.toml takes all that is left
    return sorted(formats, key=lambda format: (format.late, format is rig_toml.FORMAT))


def _holds(format: str, rig: StereoRig) -> bool:
    try:
        RIG_FORMATS[format](rig)
    except InvalidRig:
        return False
    return True
