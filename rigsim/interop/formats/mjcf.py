"""A calibration as MuJoCo's MJCF: ``rig.xml``, one body with the two cameras, for MuJoCo 3.6 on.

The body looks along its +X with +Z up and the left camera towards +Y; it sits in the middle of the baseline.
A camera looks along its own -Z. MuJoCo draws pinholes, so a lens with distortion is refused.
"""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Format
from rigsim.interop.formats.values import (
    clipped,
    number,
    pixels,
    quaternion_from_rotvec,
    real,
    rotation_from_quaternion,
)
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose, rotvec_from_rotation
from rigsim.rig.stereo import StereoRig
from rigsim.sim.axes import CV_FROM_GL, REP103_FROM_RIG, principal_offset

FILE_NAME = "rig.xml"

_HEAD = """\
<!-- rigsim stereo rig, metres. The body looks along +X, +Z is up. principalpixel is the image's middle,
     (W-1)/2 and (H-1)/2, minus the principal point. Draw at the camera's resolution. -->
"""
_TURNS = ("axisangle", "euler", "xyaxes", "zaxis")


def rig_xml(rig: StereoRig) -> str:
    """The text of a rig.xml of `rig`, every digit kept; a scene takes it in by ``<include>`` or as its body.

    Raises:
        InvalidRig: a lens distorts.
    """
    for side, camera in (("left", rig.left), ("right", rig.right)):
        if camera.lens is not None:
            raise InvalidRig(f"{side} lens distorts: MuJoCo draws pinholes")
    body_from_left = Pose(REP103_FROM_RIG) @ rig.rig_from_left
    cameras = "\n".join(
        (
            _camera_text(rig.left, "left", body_from_left),
            _camera_text(rig.right, "right", body_from_left @ rig.right_from_left.inverse),
        )
    )
    return (
        f'{_HEAD}<mujoco model="rigsim rig">\n  <worldbody>\n    <body name="rig">\n{cameras}\n    </body>\n'
        "  </worldbody>\n</mujoco>\n"
    )


def parse_rig_xml(text: str) -> StereoRig:
    """The rig in an MJCF text: the cameras called ``left`` and ``right``, in one body.

    Raises:
        InvalidRig: no XML, a camera is missing, or it is given in words other than ``pos``, ``quat``,
            ``resolution``, ``sensorsize``, ``focalpixel`` and ``principalpixel``.
    """
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise InvalidRig(f"is not XML: {clipped(str(error))}") from None
    owners = [
        {str(camera.get("name")): camera for camera in parent.findall("camera")} for parent in root.iter()
    ]
    pair = next((owner for owner in owners if {"left", "right"} <= set(owner)), None)
    if pair is None:
        found = ", ".join(name for owner in owners for name in owner) or "none"
        raise InvalidRig(
            f"cameras left and right in one body: missing (found {clipped(found)}); name them so"
        )
    (left, body_from_left), (right, body_from_right) = (
        _camera(pair[side], f"camera {side}") for side in ("left", "right")
    )
    return StereoRig(left, right, body_from_right.inverse @ body_from_left)


def _camera_text(camera: Intrinsics, name: str, body_from_camera: Pose) -> str:
    quaternion = quaternion_from_rotvec(rotvec_from_rotation(body_from_camera.R @ CV_FROM_GL))
    size = f"{camera.width} {camera.height}"
    return (
        f'      <camera name="{name}" pos="{_words(*body_from_camera.t)}" quat="{_words(*quaternion)}"\n'
        f'              resolution="{size}" sensorsize="{size}" focalpixel="{_words(camera.fx, camera.fy)}"\n'
        f'              principalpixel="{_words(*principal_offset(camera))}"/>'
    )


def _words(*values: float) -> str:
    return " ".join(real(float(value)) for value in values)


def _camera(element: ElementTree.Element, name: str) -> tuple[Intrinsics, Pose]:
    """The camera, and its pose in its body, OpenCV axes."""
    for turn in _TURNS:
        if turn in element.attrib:
            raise InvalidRig(f"{name}: {turn} is not read, write quat")

    def values(key: str, count: int, default: str | None = None) -> Array:
        text = element.get(key, default)
        if text is None:
            raise InvalidRig(f"{name}: {key} is missing: give {count} numbers")
        words = text.split()
        if len(words) != count:
            raise InvalidRig(f"{name}: {key} {clipped(text)}: must be {count} numbers")
        return np.array([number(word, f"{name}: {key}") for word in words])

    size = values("resolution", 2)
    width, height = (pixels(float(side), f"{name}: resolution") for side in size)
    focal = values("focalpixel", 2)
    offset = values("principalpixel", 2, "0 0")
    values("sensorsize", 2)  # only with it is a focalpixel used
    R = rotation_from_quaternion(values("quat", 4, "1 0 0 0"), f"{name}: quat") @ CV_FROM_GL
    camera = Intrinsics(
        width,
        height,
        float(focal[0]),
        float(focal[1]),
        (width - 1) / 2 - float(offset[0]),
        (height - 1) / 2 - float(offset[1]),
    )
    return camera, Pose(R, values("pos", 3, "0 0 0"))


FORMAT = Format(
    "mjcf",
    "MuJoCo's scene file with two cameras in one body",
    (".xml",),
    FILE_NAME,
    knows=lambda text: text.lstrip().startswith("<"),
    parse=parse_rig_xml,
    write=lambda rig: {FILE_NAME: rig_xml(rig)},
    drawn_up=True,
)
