"""Cameras of MuJoCo's MJCF: two of any scene, and a file of their own, ``rig.xml``, for MuJoCo 3.6 on.

In ours the body looks along its +X with +Z up and the left camera towards +Y; it sits in the middle of the
baseline. A camera looks along its own -Z. MuJoCo draws pinholes, so a lens with distortion is refused.
Whatever is not written as ours is compiled by MuJoCo: field of view, sensor, any words for an attitude,
nested bodies, defaults and includes.
"""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from rigsim.errors import InvalidRig, InvalidScene
from rigsim.interop.formats.format import Asked, File, Format, Found, alone
from rigsim.interop.formats.opencv.filestorage import xml_root
from rigsim.interop.formats.values import (
    clipped,
    number,
    pixels,
    quaternion_from_rotvec,
    real,
    rotation_from_quaternion,
    shown,
)
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose, rotvec_from_rotation
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig
from rigsim.sim.axes import CV_FROM_GL, REP103_FROM_RIG, principal_offset

FILE_NAME = "rig.xml"

_HEAD = """\
<!-- rigsim stereo rig, metres. The body looks along +X, +Z is up. principalpixel is the image's middle,
     (W-1)/2 and (H-1)/2, minus the principal point. Draw at the camera's resolution. -->
"""
_NEEDED = {"name", "resolution", "sensorsize", "focalpixel"}
_OTHERS = {"pos", "quat", "principalpixel"}
# what changes the meaning of a camera's words, or brings in other cameras
_CHANGES = ("compiler", "default", "include", "frame", "replicate", "attach", "keyframe")


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
    """The rig in the text of a rig.xml as `rig_xml` writes it: ``left`` and ``right``, in one body.

    Raises:
        InvalidRig: no XML, a camera is missing, or it is given in other words, as by a field of view.
    """
    pair = _plain_pair(xml_root(text))
    if pair is None:
        raise InvalidRig("cameras left and right in one body: missing; name them so")
    (left, body_from_left), (right, body_from_right) = (
        _camera(camera, f"camera {side}") for side, camera in zip(("left", "right"), pair, strict=True)
    )
    return StereoRig(left, right, body_from_right.inverse @ body_from_left)


def _open(group: tuple[File, ...], asked: Asked) -> Found:
    (file,) = group
    pair = _plain_pair(xml_root(file.text))
    if pair is not None and asked.cameras is None and asked.size_px is None:
        return Found(parse_rig_xml(file.text))
    return _compiled(file, asked)


def _plain_pair(root: ElementTree.Element) -> tuple[ElementTree.Element, ElementTree.Element] | None:
    """The cameras left and right of one body, as `rig_xml` writes them; None where they are written in other
    words, or something else in the file can change what these mean."""
    if any(next(root.iter(tag), None) is not None for tag in _CHANGES):
        return None
    for parent in root.iter():
        own = {str(camera.get("name")): camera for camera in parent.findall("camera")}
        if {"left", "right"} <= set(own):
            pair = own["left"], own["right"]
            return pair if all(_is_plain(camera) for camera in pair) else None
    return None


def _is_plain(camera: ElementTree.Element) -> bool:
    return _NEEDED <= set(camera.attrib) <= _NEEDED | _OTHERS


def _compiled(file: File, asked: Asked) -> Found:
    """The rig of two cameras of any scene, compiled by MuJoCo."""
    from rigsim.sim.scenes.cameras import SceneCamera, read_scene_cameras

    with _on_disk(file) as path:
        try:
            scene = read_scene_cameras(path)
        except InvalidScene as error:
            raise InvalidRig(str(error).removeprefix(f"{path}: ")) from None
    names = [camera.name for camera in scene.cameras]
    left, right = (scene.cameras[i] for i in _two(names, asked))
    remarks: list[Remark] = []

    def lens(camera: SceneCamera) -> Intrinsics:
        size = camera.size_px or asked.size_px or scene.offscreen_px
        if camera.size_px is None and asked.size_px is None and not remarks:
            text = (
                f"camera {camera.name} has no resolution: {size[0]}x{size[1]} assumed, as its scene is drawn"
                " off screen; give the true one as --rig-size WxH"
            )
            remarks.append(Remark("no_size", text))
        return camera.intrinsics(*size)

    rig = StereoRig(lens(left), lens(right), right.world_from_camera.inverse @ left.world_from_camera)
    if left.body != right.body:
        text = (
            f"cameras {left.name} and {right.name} sit on bodies that move against each other: taken where"
            " they are at the scene's first keyframe, or its reference pose"
        )
        remarks.append(Remark("moves", text))
    return Found(rig, remarks=tuple(remarks))


@contextlib.contextmanager
def _on_disk(file: File) -> Iterator[Path]:
    """The file where MuJoCo can read it, its neighbours beside it."""
    if file.path.is_file():
        yield file.path
        return
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, FILE_NAME)
        path.write_text(file.text, encoding="utf-8")
        yield path


def _two(names: Sequence[str], asked: Asked) -> tuple[int, int]:
    """Which of the cameras are left and right: as asked for, as called, or the only two."""
    have = clipped(", ".join(name or f"number {i}" for i, name in enumerate(names)) or "none")
    way = "choose two, as --rig-cameras left,right"
    if asked.cameras is not None:
        for name in asked.cameras:
            if name not in names:
                raise InvalidRig(f"camera {shown(name)}: must be one of {have}")
        return names.index(asked.cameras[0]), names.index(asked.cameras[1])
    sides = [[i for i, name in enumerate(names) if side in name.lower()] for side in ("left", "right")]
    if {"left", "right"} <= set(names):
        return names.index("left"), names.index("right")
    if len(sides[0]) == len(sides[1]) == 1 and sides[0] != sides[1]:
        return sides[0][0], sides[1][0]
    if len(names) == 2 and not sides[0] and not sides[1]:
        return 0, 1
    raise InvalidRig(f"{len(names)} camera(s), {have}: {way if len(names) > 1 else 'a rig needs two'}")


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
    "MuJoCo's scene file with two cameras",
    (".xml",),
    FILE_NAME,
    groups=alone(lambda text: "<mujoco" in text),
    open=_open,
    write=lambda rig: {FILE_NAME: rig_xml(rig)},
)
