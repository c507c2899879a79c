"""A calibration of Luxonis' OAK cameras as DepthAI's JSON: the EEPROM's form, or a flat one of two cameras.

The extrinsics of a camera map its own frame to the one of ``toCameraSocket``, ``x_to = R x + t``, so that the
translation from left to right has a negative x; lengths are centimetres. Fourteen distortion terms in
OpenCV's order; a fisheye (``cameraType`` 1) uses the first four. Sockets: 0 is the colour camera (CAM_A), 1
left (CAM_B), 2 right (CAM_C).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found, alone
from rigsim.interop.formats.tables.json_text import json_table
from rigsim.interop.formats.tables.terms import opencv_lens
from rigsim.interop.formats.values import lens, matrix, member, number, numbers, pixels, rotation, shown
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig

_CM = 0.01
_FISHEYE, _TYPES = 1, ("perspective", "fisheye", "equirectangular", "radial division")
_SOCKETS = {
    "rgb": 0,
    "color": 0,
    "colour": 0,
    "cam_a": 0,
    "left": 1,
    "cam_b": 1,
    "right": 2,
    "cam_c": 2,
    "cam_d": 3,
}


def _open(group: tuple[File, ...], asked: Asked) -> Found:
    table = json_table(group[0].text)
    return _eeprom(table, asked) if "cameraData" in table else _flat(table, asked)


def _flat(table: Mapping[str, object], asked: Asked) -> Found:
    """Of ``left_intrinsics``, ``rotation_left_to_right`` and so on."""
    cameras = []
    for side in ("left", "right"):
        D = numbers(table.get(f"distortion_{side}", []), f"distortion_{side}")
        key = f"{side}_intrinsics"
        K = matrix(member(table, key), key, 3, 3)
        width, height = _size(table, asked, "the calibration")
        cameras.append(replace(lens(width, height, K, None, key), lens=opencv_lens(D, f"distortion_{side}")))
    R = matrix(member(table, "rotation_left_to_right"), "rotation_left_to_right", 3, 3)
    t = matrix(member(table, "translation_left_to_right"), "translation_left_to_right", 3, 1)[:, 0]
    pose = Pose(rotation(R, "rotation_left_to_right"), t * _CM)
    return Found(StereoRig(cameras[0], cameras[1], pose))


def _eeprom(table: Mapping[str, object], asked: Asked) -> Found:
    cameras = _cameras(table)
    left, right = _pair(table, cameras, asked)
    remarks: list[Remark] = []
    pose = _chain(cameras, left, right, remarks)
    return Found(
        StereoRig(_camera(cameras[left], left, asked), _camera(cameras[right], right, asked), pose),
        remarks=tuple(remarks),
    )


def _cameras(table: Mapping[str, object]) -> dict[int, Mapping[str, object]]:
    """The table of each camera, by its socket."""
    data = member(table, "cameraData")
    pairs = list(data.items()) if isinstance(data, Mapping) else data
    if not isinstance(pairs, list) or not all(
        isinstance(pair, list | tuple) and len(pair) == 2 for pair in pairs
    ):
        raise InvalidRig(f"cameraData {shown(data)}: must be a list of [socket, camera]")
    cameras = {}
    for socket, camera in pairs:
        if not isinstance(camera, Mapping):
            raise InvalidRig(f"camera {shown(socket)}: must be a table of names and values")
        cameras[int(number(socket, "socket of cameraData"))] = camera
    return cameras


def _pair(
    table: Mapping[str, object], cameras: Mapping[int, Mapping[str, object]], asked: Asked
) -> tuple[int, int]:
    """The sockets of left and right: those asked for, else those of the stereo pair, else the only two."""
    have = ", ".join(str(socket) for socket in cameras) or "none"
    if asked.cameras is not None:
        found = [_SOCKETS.get(name.lower(), int(name) if name.isdigit() else -1) for name in asked.cameras]
        for name, socket in zip(asked.cameras, found, strict=True):
            if socket not in cameras:
                raise InvalidRig(f"camera {shown(name)}: must be one of the sockets {have} (1 left, 2 right)")
        return found[0], found[1]
    stereo = table.get("stereoRectificationData", {})
    told = [
        stereo.get(f"{side}CameraSocket", -1) if isinstance(stereo, Mapping) else -1
        for side in ("left", "right")
    ]
    sockets = sorted(cameras)
    for pair in (told, [1, 2], sockets if len(sockets) == 2 else []):
        if len(pair) == 2 and pair[0] in cameras and pair[1] in cameras and pair[0] != pair[1]:
            return int(pair[0]), int(pair[1])
    raise InvalidRig(f"no stereo pair among the cameras at sockets {have}: choose two, as --rig-cameras 1,2")


def _chain(cameras: Mapping[int, Mapping[str, object]], left: int, right: int, remarks: list[Remark]) -> Pose:
    """Maps `left`'s frame to `right`'s, by whichever cameras lie between."""
    steps: dict[int, list[tuple[int, Pose]]] = {socket: [] for socket in cameras}
    for socket, camera in cameras.items():
        step = _step(socket, camera, remarks)
        if step is not None and step[0] in cameras:
            steps[socket].append(step)
            steps[step[0]].append((socket, step[1].inverse))
    reached, edge = {left: Pose()}, [left]
    while edge:
        here = edge.pop(0)
        for there, pose in steps[here]:
            if there not in reached:
                reached[there] = pose @ reached[here]
                edge.append(there)
    if right not in reached:
        raise InvalidRig(f"no extrinsics lead from camera {left} to camera {right}: calibrate the pair")
    return reached[right]


def _step(socket: int, camera: Mapping[str, object], remarks: list[Remark]) -> tuple[int, Pose] | None:
    """The socket that a camera's extrinsics lead to, and their pose; None where it has none."""
    name = f"extrinsics of camera {socket}"
    table = camera.get("extrinsics")
    if not isinstance(table, Mapping) or not table.get("rotationMatrix"):
        return None
    to = int(number(table.get("toCameraSocket", -1), f"toCameraSocket of camera {socket}"))
    if to < 0:
        return None
    t = _vector(member(table, "translation", name), name)
    if not t.any() and "specTranslation" in table:
        t = _vector(table["specTranslation"], name)
        remarks.append(
            Remark(
                "spec_translation",
                f"the translation of camera {socket} is 0: the drawing's was taken instead",
            )
        )
    return to, Pose(rotation(matrix(table["rotationMatrix"], name, 3, 3), name), t * _CM)


def _vector(value: object, name: str) -> Array:
    return np.array([number(member(value, axis, name), f"{axis} of {name}") for axis in ("x", "y", "z")])


def _camera(table: Mapping[str, object], socket: int, asked: Asked) -> Intrinsics:
    name = f"camera {socket}"
    kind = table.get("cameraType", 0)
    D = numbers(table.get("distortionCoeff", []), f"distortionCoeff of {name}")
    if kind not in (0, _FISHEYE):
        said = _TYPES[kind] if isinstance(kind, int) and 0 <= kind < len(_TYPES) else shown(kind)
        raise InvalidRig(f"cameraType of {name} is {said}: must be perspective (0) or fisheye (1)")
    key = f"intrinsicMatrix of {name}"
    K = matrix(member(table, "intrinsicMatrix", name), key, 3, 3)
    width, height = _size(table, asked, name)
    return replace(lens(width, height, K, None, key), lens=_lens(D, kind == _FISHEYE, name))


def _lens(D: Array, fisheye: bool, name: str) -> Lens | None:
    if not fisheye:
        return opencv_lens(D, f"distortionCoeff of {name}")
    if len(D) < 4 or D[4:].any():
        raise InvalidRig(f"distortionCoeff of {name}: a fisheye has k1 to k4, and zeros after them")
    return KannalaBrandt(*(float(value) for value in D[:4]))


def _size(table: Mapping[str, object], asked: Asked, name: str) -> tuple[int, int]:
    if table.get("width") and table.get("height"):
        return pixels(table["width"], f"width of {name}"), pixels(table["height"], f"height of {name}")
    if asked.size_px is None:
        raise InvalidRig(f"{name} has no image size: give it as --rig-size 1280x800")
    return asked.size_px


def _knows(text: str) -> bool:
    flat = ('"left_intrinsics"', '"right_intrinsics"', '"rotation_left_to_right"')
    return text.lstrip().startswith("{") and ('"cameraData"' in text or all(key in text for key in flat))


FORMAT = Format(
    "oak",
    "DepthAI's JSON of a Luxonis OAK camera",
    (".json",),
    "calib.json",
    groups=alone(_knows),
    open=_open,
    fixes_unit="cm",
)
