"""A calibration of Stereolabs' ZED cameras: ``SN<serial>.conf``, INI with a section a camera and mode.

``Baseline``, ``TY`` and ``TZ`` are millimetres, the way from the left camera to the right one as Stereolabs'
own reader takes them: ``x_right = R x_left - (Baseline, TY, TZ)``, with R of the rotation vector (RX, CV,
RZ), rad. Distortion is OpenCV's; a wide camera's k1 to k4 without p1 and p2 are a fisheye's.
"""

from __future__ import annotations

import configparser
import re
from collections.abc import Mapping

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found, alone
from rigsim.interop.formats.tables.terms import opencv_lens
from rigsim.interop.formats.values import clipped, number, shown
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig

_MM = 1e-3
# in the order in which one is chosen where none was asked for
_SIZES = {
    "hd": (1280, 720),
    "fhd1200": (1920, 1200),
    "fhd": (1920, 1080),
    "svga": (960, 600),
    "2k": (2208, 1242),
    "4k": (3840, 2160),
    "vga": (672, 376),
}
_TERMS = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4")
_Sections = Mapping[str, Mapping[str, str]]


def _open(group: tuple[File, ...], asked: Asked) -> Found:
    sections = _sections(group[0].text)
    mode, remarks = _mode(sections, asked)
    left, right = (_camera(sections, side, mode, asked) for side in ("left", "right"))
    stereo = sections.get("stereo", {})

    def value(key: str, default: float | None = 0.0) -> float:
        for name in (f"{key}_{mode}", key):
            if name in stereo:
                return number(stereo[name], f"{name.upper()} of STEREO")
        if default is None:
            raise InvalidRig(f"{key} of STEREO is missing: add it, mm")
        return default

    way_mm = np.array([value("baseline", None), value("ty"), value("tz")])
    if abs(way_mm[0]) < 1:
        text = f"Baseline {way_mm[0]:g}: a ZED's file has mm, and was read so; write it in mm if it is metres"
        remarks = (*remarks, Remark("unit", text))
    pose = Pose.from_rotvec([value("rx"), value("cv"), value("rz")], -way_mm * _MM)
    return Found(StereoRig(left, right, pose), remarks=remarks)


def _sections(text: str) -> _Sections:
    parser = configparser.ConfigParser(interpolation=None, delimiters=("=",))
    try:
        parser.read_string(text)
    except configparser.Error as error:
        raise InvalidRig(f"is not INI: {clipped(str(error))}") from None
    return {name.lower(): dict(parser[name]) for name in parser.sections()}


def _mode(sections: _Sections, asked: Asked) -> tuple[str, tuple[Remark, ...]]:
    """The mode that was asked for, else the first of `_SIZES`, in small letters."""
    have = [name.removeprefix("left_cam_") for name in sections if name.startswith("left_cam_")]
    said = ", ".join(mode.upper() for mode in have) or "none"
    if asked.mode is not None:
        if asked.mode.lower() not in have:
            raise InvalidRig(f"mode {shown(asked.mode)}: must be one of {clipped(said)}")
        return asked.mode.lower(), ()
    if asked.size_px is not None:
        fitting = [mode for mode in have if _SIZES.get(mode) == asked.size_px]
        if fitting:
            return fitting[0], ()
    known = [mode for mode in _SIZES if mode in have] or have
    if not known:
        raise InvalidRig("section LEFT_CAM_HD is missing, and so is that of every other mode")
    taken, other = known[0].upper(), known[-1].upper()
    text = f"the file has the modes {said}: {taken} was taken; choose as --rig-mode {other}"
    return known[0], (Remark("mode", text),) if len(have) > 1 else ()


def _camera(sections: _Sections, side: str, mode: str, asked: Asked) -> Intrinsics:
    name = f"{side}_cam_{mode}"
    if name not in sections:
        raise InvalidRig(f"section {name.upper()} is missing: add it, or choose another --rig-mode")
    values = {**sections.get(f"{side}_disto", {}), **sections[name]}

    def value(key: str) -> float:
        if key not in values:
            raise InvalidRig(f"{key} of {name.upper()} is missing: add it")
        return number(values[key], f"{key} of {name.upper()}")

    size = _SIZES.get(mode) or asked.size_px
    if size is None:
        raise InvalidRig(f"mode {mode.upper()}: has no known image size: give it as --rig-size 1280x720")
    given = {key: value(key) for key in _TERMS if key in values}
    return Intrinsics(*size, value("fx"), value("fy"), value("cx"), value("cy"), _lens(given, name.upper()))


def _lens(given: Mapping[str, float], name: str) -> Lens | None:
    if set(given) == {"k1", "k2", "k3", "k4"}:
        return KannalaBrandt(*(given[f"k{i}"] for i in range(1, 5)))
    return opencv_lens(np.array([given.get(key, 0.0) for key in _TERMS]), name)


_KNOWN = re.compile(r"^\s*\[LEFT_CAM_\w+\]", re.MULTILINE | re.IGNORECASE)

FORMAT = Format(
    "zed",
    "the SNxxxx.conf of a Stereolabs ZED",
    (".conf",),
    "zed.conf",
    groups=alone(lambda text: _KNOWN.search(text) is not None),
    open=_open,
    has_modes=True,
    fixes_unit="mm",
)
