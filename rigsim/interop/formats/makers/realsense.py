"""A calibration of Intel's RealSense cameras as ``rs-enumerate-devices -c`` prints it.

An extrinsic maps points from the first stream to the second, ``x_to = R x_from + t``, metres; its rotation
is printed row by row (librealsense holds it by columns). Integer pixel = pixel centre. The pair is Infrared 1
and 2, or a T265's Fisheye 1 and 2. ``Brown Conrady`` is OpenCV's; ``Modified`` and ``Inverse`` ones differ
from it unless they are 0.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found, alone
from rigsim.interop.formats.tables.terms import opencv_lens
from rigsim.interop.formats.values import clipped, matrix, number, numbers, rotation, shown
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig

_INTRINSIC = re.compile(r'^\s*Intrinsic of "([^"]+)"\s*/?\s*(\d{1,5})x(\d{1,5})\b[\s/]*(.*)$')
_EXTRINSIC = re.compile(r'^\s*Extrinsic from\s+"([^"]+)"\s+To\s+"([^"]+)"')
_VALUE = re.compile(r"^\s*([A-Za-z][\w ]*?)\s*(?:\(deg\))?\s*:\s*(.*)$")
_PAIRS = (("Infrared 1", "Infrared 2"), ("Fisheye 1", "Fisheye 2"))
_RAW = {"Y16", "Y12I"}  # formats of pictures before the camera rectifies them


@dataclass(frozen=True, slots=True)
class _Stream:
    """One stream's intrinsics in one resolution."""

    width: int
    height: int
    raw: bool
    values: dict[str, str]


def _open(group: tuple[File, ...], asked: Asked) -> Found:
    text = _one_device(group[0].text)
    streams, poses = _sections(text)
    names = _pair(streams, asked)
    size, remarks = _size(streams, names, asked)
    left, right = (_camera(streams[name], name, size) for name in names)
    if names in poses:
        pose = poses[names]
    elif names[::-1] in poses:
        pose = poses[names[::-1]].inverse
    else:
        raise InvalidRig(
            f'no extrinsic from "{names[0]}" to "{names[1]}": print it with rs-enumerate-devices -c'
        )
    return Found(StereoRig(left, right, pose), remarks=remarks)


def _one_device(text: str) -> str:
    """The text of the one device that is described."""
    devices = [
        part for part in re.split(r"^Device info", text, flags=re.MULTILINE) if 'Intrinsic of "' in part
    ]
    if len(devices) != 1:
        raise InvalidRig(f"describes {len(devices)} devices: keep the text of one")
    return devices[0]


def _sections(text: str) -> tuple[dict[str, list[_Stream]], dict[tuple[str, str], Pose]]:
    """The intrinsics of every stream, by its name, and the poses between streams."""
    streams: dict[str, list[_Stream]] = {}
    poses: dict[tuple[str, str], Pose] = {}
    lines = text.splitlines()
    for i, line in enumerate(lines):
        if found := _INTRINSIC.match(line):
            name, width, height, formats = found.groups()
            told = (_VALUE.match(row) for row in _until_blank(lines, i + 1))
            values = {said[1]: said[2] for said in told if said is not None}
            if values:
                raw = set(formats.strip(" {}").split("/")) <= _RAW
                streams.setdefault(name, []).append(_Stream(int(width), int(height), raw, values))
        elif found := _EXTRINSIC.match(line):
            pose = _pose(lines[i + 1 : i + 7], f'extrinsic from "{found[1]}" to "{found[2]}"')
            if pose is not None:
                poses[found[1], found[2]] = pose
    return streams, poses


def _until_blank(lines: list[str], start: int) -> list[str]:
    rows = []
    for line in lines[start : start + 12]:
        if not line.strip() or _INTRINSIC.match(line):
            break
        rows.append(line)
    return rows


def _pose(lines: list[str], name: str) -> Pose | None:
    """The pose in the lines after an extrinsic's head; None where none is printed."""
    if not lines or "Rotation" not in lines[0]:
        return None
    R = matrix([line.split() for line in lines[1:4]], f"rotation of the {name}", 3, 3)
    told = next((line.partition(":")[2] for line in lines[4:] if "Translation" in line), "")
    return Pose(
        rotation(R, f"rotation of the {name}"), numbers(told.split(), f"translation of the {name}", 3)
    )


def _pair(streams: dict[str, list[_Stream]], asked: Asked) -> tuple[str, str]:
    have = ", ".join(streams)
    if asked.cameras is not None:
        for name in asked.cameras:
            if name not in streams:
                raise InvalidRig(f"stream {shown(name)}: must be one of {clipped(have)}")
        return asked.cameras
    found = next((pair for pair in _PAIRS if pair[0] in streams and pair[1] in streams), None)
    if found is None:
        raise InvalidRig(
            f"no Infrared 1 and 2, nor Fisheye 1 and 2 (found {clipped(have) or 'no stream'}): choose two"
            ' as --rig-cameras "Infrared 1,Color"'
        )
    return found


def _size(
    streams: dict[str, list[_Stream]], names: tuple[str, str], asked: Asked
) -> tuple[tuple[int, int], tuple[Remark, ...]]:
    """The resolution that was asked for, else the largest that both streams have."""
    left, right = (
        {(s.width, s.height): s.raw for s in sorted(streams[name], key=lambda s: not s.raw)} for name in names
    )
    both = sorted(set(left) & set(right), key=lambda size: (left[size], -size[0] * size[1]))
    said = ", ".join(f"{width}x{height}" for width, height in both)
    if not both:
        raise InvalidRig(f"{names[0]} and {names[1]} have no resolution in common")
    if asked.mode is not None:
        wanted = re.fullmatch(r"(\d{1,5})x(\d{1,5})", asked.mode.strip().lower())
        size = (int(wanted[1]), int(wanted[2])) if wanted else None
        if size not in both:
            raise InvalidRig(f"mode {shown(asked.mode)}: must be one of {said}")
        return size, ()
    if asked.size_px in both:
        return asked.size_px, ()
    text = (
        f"the camera has {len(both)} resolutions ({said}): {both[0][0]}x{both[0][1]} was taken; choose"
        f" another as --rig-mode {both[-1][0]}x{both[-1][1]}"
    )
    return both[0], (Remark("mode", text),) if len(both) > 1 else ()


def _camera(streams: list[_Stream], name: str, size: tuple[int, int]) -> Intrinsics:
    stream = min((s for s in streams if (s.width, s.height) == size), key=lambda s: s.raw)

    def value(key: str) -> float:
        if key not in stream.values:
            raise InvalidRig(f"{key} of {name} is missing")
        return number(stream.values[key].strip(), f"{key} of {name}")

    D = numbers(stream.values.get("Coeffs", "").split(), f"Coeffs of {name}")
    lens = _lens(stream.values.get("Distortion", "None").strip(), D, name)
    return Intrinsics(*size, value("Fx"), value("Fy"), value("PPX"), value("PPY"), lens)


def _lens(model: str, D: Array, name: str) -> Lens | None:
    D = np.pad(D[:5], (0, max(0, 5 - len(D))))
    kind = model.lower().replace("-", "").replace(" ", "").replace("_", "")
    if kind == "kannalabrandt4":
        return KannalaBrandt(*(float(value) for value in D[:4]))
    if kind == "ftheta":
        return FieldOfView(float(D[0]))
    straight = not D.any()
    if kind == "brownconrady" or (kind == "modifiedbrownconrady" and not D[2:4].any()):
        return opencv_lens(D, f"Coeffs of {name}")
    if kind in ("", "none", "modifiedbrownconrady", "inversebrownconrady"):
        if straight or kind in ("", "none"):
            return None
        raise InvalidRig(
            f"{name} has {model} with terms that are not 0: its formula maps pixels to rays, unlike OpenCV's;"
            " choose a rectified stream, or calibrate"
        )
    raise InvalidRig(
        f"distortion of {name} {shown(model)}: must be Brown Conrady, Kannala Brandt4, Ftheta or None"
    )


FORMAT = Format(
    "realsense",
    "what rs-enumerate-devices -c prints of an Intel RealSense",
    (".txt",),
    "realsense.txt",
    groups=alone(lambda text: 'Intrinsic of "' in text and 'Extrinsic from "' in text),
    open=_open,
    has_modes=True,
)
