"""The cameras of SVO Pro and of aslam's and maplab's programs: a list ``cameras`` in one YAML file.

Each has a ``camera`` with its lens, and ``T_B_C``, which maps the camera's frame to the body's, or its
inverse ``T_C_B``, metres; the first camera is left. ``fisheye`` is the field-of-view lens of one number here,
not the one of OpenCV's module of that name; ``unified-projection`` has xi before the focal lengths.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found, alone
from rigsim.interop.formats.kit.cameras import two_of
from rigsim.interop.formats.kit.poses import rigid
from rigsim.interop.formats.robotics.lens_words import camera_of
from rigsim.interop.formats.values import member, pixels, shown
from rigsim.interop.formats.yaml_text import yaml_table
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

_LIST = re.compile(r"^cameras\s*:", re.MULTILINE)
_CAMERA = re.compile(r"^[ \t]*(?:-[ \t]*)?camera\s*:", re.MULTILINE)
_POSED = re.compile(r"^[ \t]*(?:-[ \t]*)?T_(?:B_C|C_B)\s*:", re.MULTILINE)
_WORDS = {"fisheye": "fov", "unified-projection": "omni"}
"""Words that mean another lens, or none, elsewhere."""


def parse_ncamera(text: str, asked: Asked | None = None) -> Found:
    """The rig in the text: its first two cameras, or those that are asked for by label or number.

    Raises:
        InvalidRig: no YAML, a camera is missing, no lens is of its type, or values cannot be.
    """
    cameras = member(yaml_table(text), "cameras")
    if not isinstance(cameras, list):
        raise InvalidRig(f"cameras {shown(cameras)}: must be a list of cameras")
    names = _names(cameras)
    first, second, remarks = two_of(names, asked or Asked())
    left, body_from_left = _camera(cameras[first], names[first])
    right, body_from_right = _camera(cameras[second], names[second])
    return Found(StereoRig(left, right, body_from_right.inverse @ body_from_left), "m", remarks)


def _names(cameras: list[object]) -> list[str]:
    """What the cameras are called: their labels, where each has its own."""
    tables = [own.get("camera") if isinstance(own, Mapping) else None for own in cameras]
    labels = [str(table.get("label", "")) if isinstance(table, Mapping) else "" for table in tables]
    own = all(labels) and len(set(labels)) == len(labels)
    return labels if own else [f"cam{i}" for i in range(len(cameras))]


def _camera(table: object, name: str) -> tuple[Intrinsics, Pose]:
    """A camera, and the body's frame from its own."""
    camera = member(table, "camera", name)
    distortion = member(camera, "distortion", name)
    kind = member(distortion, "type", f"distortion of {name}")
    assert isinstance(distortion, Mapping)
    width, height = (
        pixels(member(camera, key, name), f"{key} of {name}") for key in ("image_width", "image_height")
    )
    made = camera_of(
        (width, height),
        (_word(member(camera, "type", name)), _word(kind)),
        (
            _data(member(camera, "intrinsics", name), f"intrinsics of {name}"),
            _data(distortion.get("parameters"), f"distortion parameters of {name}"),
        ),
        f" of {name}",
    )
    assert isinstance(table, Mapping)
    if "T_B_C" not in table and "T_C_B" in table:
        return made, rigid(table["T_C_B"], f"T_C_B of {name}").inverse
    return made, rigid(member(table, "T_B_C", name), f"T_B_C of {name}")


def _word(kind: object) -> str:
    word = str(kind).strip().lower()
    return _WORDS.get(word, word)


def _data(value: object, owner: str) -> object:
    return member(value, "data", owner) if isinstance(value, Mapping) else value


def knows(text: str) -> bool:
    """Whether a text is such a list of cameras."""
    return all(pattern.search(text) is not None for pattern in (_LIST, _CAMERA, _POSED))


def _open(files: tuple[File, ...], asked: Asked) -> Found:
    return parse_ncamera(files[0].text, asked)


FORMAT = Format(
    "ncamera",
    "the cameras of SVO Pro, aslam and maplab",
    (".yaml",),
    "ncamera.yaml",
    groups=alone(knows),
    open=_open,
)
