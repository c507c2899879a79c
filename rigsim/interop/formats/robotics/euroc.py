"""The cameras of a data set in ASL's layout, as EuRoC's: ``cam0/sensor.yaml`` and ``cam1/sensor.yaml``.

``T_BS`` maps the sensor's frame to the body's, metres; left from it is the first camera, ``cam0``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found
from rigsim.interop.formats.kit.cameras import two_of
from rigsim.interop.formats.kit.poses import rigid
from rigsim.interop.formats.robotics.lens_words import camera_of
from rigsim.interop.formats.values import member, numbers, pixels
from rigsim.interop.formats.yaml_text import yaml_table
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

_KNOWN = re.compile(r"^T_BS\s*:", re.MULTILINE)
_CAMERA = re.compile(r"^(?:camera_model|intrinsics)\s*:", re.MULTILINE)
_MOST = 8


def parse_sensors(left: str, right: str) -> Found:
    """The rig in the texts of the left and the right camera's sensor.yaml.

    Raises:
        InvalidRig: no YAML, no lens is of the models named, or values cannot be.
    """
    return _pair((("left", left), ("right", right)))


def _pair(named: Sequence[tuple[str, str]]) -> Found:
    cameras, poses = [], []
    for name, text in named:
        try:
            camera, body_from_camera = _sensor(yaml_table(text))
        except InvalidRig as error:
            raise InvalidRig(f"{name}: {error}") from None
        cameras.append(camera)
        poses.append(body_from_camera)
    return Found(StereoRig(cameras[0], cameras[1], poses[1].inverse @ poses[0]), "m")


def _sensor(table: Mapping[str, object]) -> tuple[Intrinsics, Pose]:
    """A camera, and the body's frame from its own."""
    width, height = numbers(member(table, "resolution"), "resolution", 2)
    values = table.get("distortion_coefficients", table.get("distortion_coeffs"))
    camera = camera_of(
        (pixels(float(width), "width"), pixels(float(height), "height")),
        (member(table, "camera_model"), table.get("distortion_model")),
        (member(table, "intrinsics"), member(values, "data") if isinstance(values, Mapping) else values),
        "",
    )
    return camera, rigid(member(table, "T_BS"), "T_BS")


def knows(text: str) -> bool:
    """Whether a text is of a camera of such a data set."""
    return _KNOWN.search(text) is not None and _CAMERA.search(text) is not None


def _called(file: File) -> str:
    """The sensor's name: its folder's, or where several files lie in one its own."""
    return file.path.absolute().parent.name if file.path.stem == "sensor" else file.path.stem


def groups(files: Sequence[File]) -> list[tuple[File, ...]]:
    """All cameras of the data set, sorted by name, where there are two or more."""
    known = sorted((file for file in files if knows(file.text)), key=lambda file: (_called(file), file.path))
    return [tuple(known[:_MOST])] if len(known) > 1 else []


def lacks(file: File) -> str | None:
    """What a file of one camera lacks."""
    if not knows(file.text):
        return None
    return (
        "is the sensor.yaml of one camera: name the other's beside it, as --rig cam0/sensor.yaml --rig"
        " cam1/sensor.yaml"
    )


def _open(files: tuple[File, ...], asked: Asked) -> Found:
    names = [_called(file) for file in files]
    first, second, remarks = two_of(names, asked)
    found = _pair([(f"{names[i]}/{files[i].name}", files[i].text) for i in (first, second)])
    return replace(found, remarks=remarks)


FORMAT = Format(
    "euroc",
    "a data set in ASL's layout, as EuRoC's: a sensor.yaml a camera",
    (".yaml",),
    "cam0/sensor.yaml",
    groups=groups,
    open=_open,
    lacks=lacks,
)
