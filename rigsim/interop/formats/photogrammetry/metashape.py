"""Agisoft Metashape's exported cameras (XML): two cameras that keep still against each other.

Its pixels are counted from the corner of the first one, ``cx`` and ``cy`` from the picture's middle; ``p1``
and ``p2`` are exchanged against OpenCV's, ``b1`` is the focal length along the rows minus the other one,
``b2`` skew (user manual, "Camera models"). A ``transform`` maps the camera's frame, axes as OpenCV's, to the
chunk's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from xml.etree import ElementTree

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found
from rigsim.interop.formats.opencv.filestorage import xml_root
from rigsim.interop.formats.photogrammetry.together import Taken, pose_together
from rigsim.interop.formats.tables.terms import opencv_lens
from rigsim.interop.formats.values import clipped, number, numbers, pixels, rotation, shown
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

_HALF = 0.5
_FISHEYES = ("fisheye", "equidistant_fisheye")
_TERMS = ("cx", "cy", "k1", "k2", "k3", "k4", "p1", "p2", "b1", "b2")


def _is_cameras(file: File) -> bool:
    return "<sensors" in file.text and "<cameras" in file.text and "<calibration" in file.text


def _groups(files: Sequence[File]) -> list[tuple[File, ...]]:
    return [(file,) for file in files if _is_cameras(file)]


def _lacks(file: File) -> str | None:
    if not file.text.lstrip("\ufeff \n").startswith("<?xml") or "<calibration>" not in file.text:
        return None
    return (
        "is Metashape's calibration of one camera, without a pose: export the cameras of both (File, Export,"
        " Export Cameras)"
    )


def _open(group: tuple[File, ...], asked: Asked) -> Found:
    root = xml_root(group[0].text)
    sensors = {str(sensor.get("id")): sensor for sensor in root.iter("sensor")}
    left, right = _two(sensors, asked)
    taken, scale = _taken(root)
    pose = pose_together(taken, left, right, "export the cameras of a rig")
    cameras = [_camera(sensors[name], f"sensor {name}") for name in (left, right)]
    if scale is not None:
        pose = Pose(pose.R, pose.t * scale)
    return Found(StereoRig(cameras[0], cameras[1], pose), unit=None if scale is None else "m")


def _two(sensors: Mapping[str, ElementTree.Element], asked: Asked) -> tuple[str, str]:
    """Ids of the left and the right sensor: as asked for by id or label, as labelled, or the only two."""
    labels = {name: str(sensor.get("label", "")) for name, sensor in sensors.items()}
    have = clipped(", ".join(f"{name} ({label})" for name, label in labels.items()) or "none")
    if asked.cameras is not None:
        found = [[name for name, label in labels.items() if word in (name, label)] for word in asked.cameras]
        for word, names in zip(asked.cameras, found, strict=True):
            if not names:
                raise InvalidRig(f"sensor {shown(word)}: must be one of {have}")
        return found[0][0], found[1][0]
    if len(sensors) < 2:
        raise InvalidRig(f"{len(sensors)} sensor: poses of one camera that moves are no rig")
    sides = [[name for name, label in labels.items() if side in label.lower()] for side in ("left", "right")]
    if len(sides[0]) == len(sides[1]) == 1 and sides[0] != sides[1]:
        return sides[0][0], sides[1][0]
    if len(sensors) > 2:
        raise InvalidRig(f"sensors {have}: choose two, as --rig-cameras 0,1")
    first, second = sensors
    return first, second


def _taken(root: ElementTree.Element) -> tuple[list[Taken], float | None]:
    """The pictures with their poses, and the metres of the chunk's unit where it says them."""
    taken = []
    for camera in root.iter("camera"):
        text = camera.findtext("transform")
        if text is None:
            continue
        name = str(camera.get("label", camera.get("id")))
        T = numbers(text.split(), f"transform of {clipped(name)}", 16).reshape(4, 4)
        chunk_from_camera = Pose(rotation(T[:3, :3], f"transform of {clipped(name)}"), T[:3, 3])
        taken.append(Taken(str(camera.get("sensor_id")), name, chunk_from_camera.inverse))
    if not taken:
        raise InvalidRig("no camera has a transform: align the pictures before the cameras are exported")
    scale = next((found.text for found in root.iter("scale") if found.text), None)
    return taken, None if scale is None else number(scale.strip(), "scale")


def _camera(sensor: ElementTree.Element, name: str) -> Intrinsics:
    made = sensor.findall("calibration")
    table = next((one for one in made if one.get("class") == "adjusted"), made[0] if made else None)
    if table is None:
        raise InvalidRig(f"{name} has no calibration: align the pictures before the cameras are exported")
    size = table.find("resolution")
    if size is None:
        size = sensor.find("resolution")
    if size is None:
        raise InvalidRig(f"{name} has no resolution")
    width, height = (pixels(size.get(key), f"{key} of {name}") for key in ("width", "height"))
    f = number(table.findtext("f"), f"f of {name}")
    values = {key: number(table.findtext(key, "0"), f"{key} of {name}") for key in _TERMS}
    if values["b2"] != 0:
        raise InvalidRig(
            f"b2 of {name} {values['b2']:g}: must be 0, rigsim's cameras have no skew; fix b2, align anew"
        )
    lens = _lens(str(table.get("type", sensor.get("type", "frame"))), values, name)
    cx, cy = width / 2 + values["cx"] - _HALF, height / 2 + values["cy"] - _HALF
    return Intrinsics(width, height, f + values["b1"], f, cx, cy, lens)


def _lens(kind: str, values: Mapping[str, float], name: str) -> Lens | None:
    if kind in _FISHEYES:
        if values["p1"] or values["p2"]:
            raise InvalidRig(
                f"p1, p2 of {name}: must be 0 of a fisheye, rigsim's has k1 to k4 alone; fix p1, p2"
            )
        return KannalaBrandt(values["k1"], values["k2"], values["k3"], values["k4"])
    if kind != "frame":
        raise InvalidRig(f"type of {name} {shown(kind)}: must be frame or equidistant_fisheye")
    if values["k4"] != 0:
        raise InvalidRig(
            f"k4 of {name} {values['k4']:g}: must be 0, no lens of rigsim has a term of r^8; fix k4"
        )
    terms = np.array([values["k1"], values["k2"], values["p2"], values["p1"], values["k3"]])
    return opencv_lens(terms, name)


FORMAT = Format(
    "metashape",
    "the cameras that Agisoft Metashape exports as XML",
    (".xml",),
    "cameras.xml",
    groups=_groups,
    open=_open,
    lacks=_lacks,
)
