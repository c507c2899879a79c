"""VINS-Fusion's settings, with the two files of CamOdoCal's cameras that they name.

``body_T_cam0`` and ``body_T_cam1`` map each camera's frame to the body's, metres. A camera's file says its
``model_type``: PINHOLE (fx, fy, cx, cy; k1, k2, p1, p2), MEI (xi; k1, k2, p1, p2; gamma1, gamma2, u0, v0) or
KANNALA_BRANDT (mu, mv, u0, v0; k2 to k5 of the angle's third to ninth power).
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import PurePosixPath

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found
from rigsim.interop.formats.kit.cameras import two_of
from rigsim.interop.formats.kit.poses import rigid
from rigsim.interop.formats.values import member, number, opencv_distortion, pixels, shown
from rigsim.interop.formats.yaml_text import yaml_table
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.mei import Mei
from rigsim.rig.stereo import StereoRig

_NAMED = re.compile(r"^cam(\d)_calib\s*:\s*[\"']?([^\"'#\n]+?)[\"']?\s*(?:#.*)?$", re.MULTILINE)
_POSED = re.compile(r"^body_T_cam\d\s*:", re.MULTILINE)
_CAMERA = re.compile(r"^model_type\s*:", re.MULTILINE)
_PROJECTION = re.compile(r"^projection_parameters\s*:", re.MULTILINE)
_MODELS = "PINHOLE, PINHOLE_FULL, MEI or KANNALA_BRANDT"
_RATIONAL = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")


def parse_vins(settings: str, cameras: Mapping[str, str], asked: Asked | None = None) -> Found:
    """The rig in the text of the settings and those of the cameras' files, by name.

    Raises:
        InvalidRig: no YAML, a camera or its file is missing, or values cannot be.
    """
    table = yaml_table(settings)
    files = {f"cam{number}": _base(name) for number, name in sorted(_NAMED.findall(settings))}
    first, second, remarks = two_of(list(files), asked or Asked())
    names = [list(files)[i] for i in (first, second)]
    left, right = (_camera(cameras, files[name]) for name in names)
    body_from = [rigid(member(table, f"body_T_{name}"), f"body_T_{name}") for name in names]
    return Found(StereoRig(left, right, body_from[1].inverse @ body_from[0]), "m", remarks)


def _base(name: str) -> str:
    return PurePosixPath(name.strip().replace("\\", "/")).name


def _camera(texts: Mapping[str, str], file: str) -> Intrinsics:
    if file not in texts:
        raise InvalidRig(f"names {file}, which is not beside it")
    try:
        table = yaml_table(texts[file])
        size = [pixels(member(table, key), key) for key in ("image_width", "image_height")]
        (fx, fy, cx, cy), lens = _lens(table)
        return Intrinsics(size[0], size[1], fx, fy, cx, cy, lens)
    except InvalidRig as error:
        raise InvalidRig(f"{file}: {error}") from None


def _lens(table: Mapping[str, object]) -> tuple[list[float], Lens | None]:
    """fx, fy, cx, cy, px, and the lens."""

    def terms(owner: str, *keys: str) -> list[float]:
        return [number(member(member(table, owner), key, owner), f"{key} of {owner}") for key in keys]

    kind = member(table, "model_type")
    word = str(kind).strip().upper()
    projection, distortion = "projection_parameters", "distortion_parameters"
    if word == "KANNALA_BRANDT":
        ends = terms(projection, "mu", "mv", "u0", "v0")
        return ends, KannalaBrandt(*terms(projection, "k2", "k3", "k4", "k5"))
    if word == "MEI":
        ends = terms(projection, "gamma1", "gamma2", "u0", "v0")
        return ends, Mei(*terms("mirror_parameters", "xi"), *terms(distortion, "k1", "k2", "p1", "p2"))
    if word not in ("PINHOLE", "PINHOLE_FULL"):
        raise InvalidRig(f"model_type {shown(kind)}: must be {_MODELS}")
    ends = terms(projection, "fx", "fy", "cx", "cy")
    given = table.get(distortion)
    keys = _RATIONAL if word == "PINHOLE_FULL" else _RATIONAL[:4]
    values = terms(distortion, *keys) if isinstance(given, Mapping) and given else []
    return ends, opencv_distortion(np.array(values), distortion)


def _is_camera(file: File) -> bool:
    return _CAMERA.search(file.text) is not None and _PROJECTION.search(file.text) is not None


def _is_settings(file: File) -> bool:
    return _NAMED.search(file.text) is not None and _POSED.search(file.text) is not None


def groups(files: Sequence[File]) -> list[tuple[File, ...]]:
    """The settings, each with the files of its cameras; none where one is missing."""
    cameras = {(file.path.parent, file.name): file for file in files if _is_camera(file)}
    by_name = {file.name: file for file in cameras.values()}
    made = []
    for file in files:
        if not _is_settings(file):
            continue
        names = dict.fromkeys(_base(name) for _, name in _NAMED.findall(file.text))
        found = [cameras.get((file.path.parent, name), by_name.get(name)) for name in names]
        beside = [one for one in found if one is not None]
        if len(beside) == len(names):
            made.append((file, *beside))
    return made


def lacks(file: File) -> str | None:
    """What settings lack whose cameras' files are not there, or a camera's file alone."""
    if _is_settings(file):
        names = dict.fromkeys(_base(name) for _, name in _NAMED.findall(file.text))
        return (
            f"is VINS-Fusion's settings, whose cameras are in {', '.join(names)}: put them into the same"
            " folder, or name them beside it with --rig"
        )
    if _is_camera(file):
        return (
            "is one camera of CamOdoCal's: name VINS-Fusion's settings (body_T_cam0, body_T_cam1, cam0_calib,"
            " cam1_calib) beside it"
        )
    return None


def _open(files: tuple[File, ...], asked: Asked) -> Found:
    settings, *cameras = files
    return parse_vins(settings.text, {file.name: file.text for file in cameras}, asked)


FORMAT = Format(
    "vins",
    "VINS-Fusion's settings with their cameras' files",
    (".yaml",),
    "vins.yaml",
    groups=groups,
    open=_open,
    lacks=lacks,
)
