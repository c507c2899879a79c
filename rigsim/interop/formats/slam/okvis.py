"""OKVIS's settings: a list ``cameras``, each with ``T_SC`` and its lens, in one YAML file.

``T_SC`` maps a camera's frame to the sensor's (the inertial unit's), metres; the first camera is left.
``radialtangential`` is k1, k2, p1, p2, ``radialtangential8`` goes on with k3 to k6, ``equidistant`` is k1 to
k4 of the angle.
"""

from __future__ import annotations

import re

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found, alone
from rigsim.interop.formats.kit.cameras import two_of
from rigsim.interop.formats.kit.poses import rigid
from rigsim.interop.formats.values import member, numbers, opencv_distortion, pixels, shown
from rigsim.interop.formats.yaml_text import yaml_table
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

_LIST = re.compile(r"^cameras\s*:", re.MULTILINE)
_POSED = re.compile(r"\bT_SC\s*:")
_TERMS = {"radialtangential": 4, "radialtangential8": 8, "equidistant": 4}


def parse_okvis(text: str, asked: Asked | None = None) -> Found:
    """The rig in the text of the settings: its first two cameras, or those that are asked for by number.

    Raises:
        InvalidRig: no YAML, a camera is missing, no lens is of its type, or values cannot be.
    """
    cameras = member(yaml_table(text), "cameras")
    if not isinstance(cameras, list):
        raise InvalidRig(f"cameras {shown(cameras)}: must be a list of cameras")
    names = [f"cam{i}" for i in range(len(cameras))]
    first, second, remarks = two_of(names, asked or Asked())
    left, sensor_from_left = _camera(cameras[first], names[first])
    right, sensor_from_right = _camera(cameras[second], names[second])
    return Found(StereoRig(left, right, sensor_from_right.inverse @ sensor_from_left), "m", remarks)


def _camera(table: object, name: str) -> tuple[Intrinsics, Pose]:
    """A camera, and the sensor's frame from its own."""

    def two(key: str) -> tuple[float, float]:
        first, second = numbers(member(table, key, name), f"{key} of {name}", 2)
        return float(first), float(second)

    width, height = (pixels(side, f"image_dimension of {name}") for side in two("image_dimension"))
    lens, pose = _lens(table, name), rigid(member(table, "T_SC", name), f"T_SC of {name}")
    try:
        return Intrinsics(width, height, *two("focal_length"), *two("principal_point"), lens), pose
    except InvalidRig as error:
        raise InvalidRig(f"{name}: {error}") from None


def _lens(table: object, name: str) -> Lens | None:
    kind = member(table, "distortion_type", name)
    word = str(kind).strip().lower()
    if word not in _TERMS:
        raise InvalidRig(f"distortion_type of {name} {shown(kind)}: must be one of {', '.join(_TERMS)}")
    key = "distortion_coefficients"
    terms = numbers(member(table, key, name), f"{key} of {name}", _TERMS[word])
    if word == "equidistant":
        return KannalaBrandt(*(float(term) for term in terms))
    return opencv_distortion(terms, f"{key} of {name}")


def knows(text: str) -> bool:
    """Whether a text is such settings."""
    return _LIST.search(text) is not None and _POSED.search(text) is not None


def _open(files: tuple[File, ...], asked: Asked) -> Found:
    return parse_okvis(files[0].text, asked)


FORMAT = Format(
    "okvis",
    "OKVIS's settings",
    (".yaml",),
    "okvis.yaml",
    groups=alone(knows),
    open=_open,
)
