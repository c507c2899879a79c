"""A calibration as Basalt writes it: JSON with ``value0``, its cameras by number.

``T_imu_cam`` is each camera's place and turn in the inertial unit's frame, metres and a quaternion x, y, z,
w; ``intrinsics`` each camera's ``camera_type`` with its numbers by name; ``resolution`` width and height, px
(gitlab.com/VladyslavUsenko/basalt).
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found, alone
from rigsim.interop.formats.kit.cameras import two_of
from rigsim.interop.formats.opencv.filestorage import storage_table
from rigsim.interop.formats.values import (
    member,
    number,
    numbers,
    opencv_distortion,
    pixels,
    quaternion_from_rotvec,
    rotation_from_quaternion,
    shown,
)
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import BrownConrady
from rigsim.rig.lens.double_sphere import DoubleSphere
from rigsim.rig.lens.eucm import Eucm
from rigsim.rig.lens.fov import FieldOfView
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.lens.rational import Rational
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

FILE_NAME = "calibration.json"

_OWN: Mapping[str, type[Lens]] = MappingProxyType(
    {"ds": DoubleSphere, "eucm": Eucm, "kb4": KannalaBrandt, "fov": FieldOfView}
)
"""Camera types whose numbers have the names of a lens's coefficients."""
_RADTAN = re.compile(r"pinhole-radtan([458])")
_RADTAN_TERMS = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
_TYPES = ("pinhole", "pinhole-radtan8", *_OWN, "ucm")
_KNOWN = re.compile(r'"camera_type"\s*:')
_QUATERNION = ("qw", "qx", "qy", "qz")


def basalt_json(rig: StereoRig) -> str:
    """The text of a calibration.json of `rig`, the left camera in the place of the inertial unit.

    What Basalt wants of an inertial unit is zeros and its own usual rates: for stereo alone it is not used.

    Raises:
        InvalidRig: a lens is of no model that Basalt has.
    """
    left_from_right = rig.right_from_left.inverse
    cameras = []
    for side, camera in (("left", rig.left), ("right", rig.right)):
        try:
            cameras.append(_written(camera))
        except InvalidRig as error:
            raise InvalidRig(f"{side} {error}") from None
    table = {
        "T_imu_cam": [_place(Pose()), _place(left_from_right)],
        "intrinsics": cameras,
        "resolution": [[camera.width, camera.height] for camera in (rig.left, rig.right)],
        "vignette": [],
        "calib_accel_bias": [0.0] * 9,
        "calib_gyro_bias": [0.0] * 12,
        "imu_update_rate": 200.0,
        "accel_noise_std": [0.01] * 3,
        "gyro_noise_std": [0.001] * 3,
        "accel_bias_std": [0.001] * 3,
        "gyro_bias_std": [0.0001] * 3,
        "cam_time_offset_ns": 0,
    }
    return json.dumps({"value0": table}, indent=2, allow_nan=False) + "\n"


def parse_basalt(text: str, asked: Asked | None = None) -> Found:
    """The rig in the text of a calibration.json: its first two cameras, or those that are asked for.

    Raises:
        InvalidRig: no JSON, a camera is missing or of an unknown type, or values cannot be.
    """
    table = storage_table(text)
    table = _table(table.get("value0", table), "value0")
    cameras = _list(table, "intrinsics")
    first, second, remarks = two_of([f"cam{i}" for i in range(len(cameras))], asked or Asked())
    places, sizes = _list(table, "T_imu_cam"), _list(table, "resolution")
    for key, values in (("T_imu_cam", places), ("resolution", sizes)):
        if len(values) != len(cameras):
            raise InvalidRig(f"{key}: holds {len(values)} values, must be {len(cameras)}, as intrinsics")
    left, right = (_camera(cameras[i], sizes[i], f"cam{i}") for i in (first, second))
    unit_from_left, unit_from_right = (_pose(places[i], f"T_imu_cam of cam{i}") for i in (first, second))
    return Found(StereoRig(left, right, unit_from_right.inverse @ unit_from_left), "m", remarks)


def _written(camera: Intrinsics) -> dict[str, object]:
    lens = camera.lens
    values = {"fx": camera.fx, "fy": camera.fy, "cx": camera.cx, "cy": camera.cy}
    if lens is None:
        return {"camera_type": "pinhole", "intrinsics": values}
    own = next((name for name, model in _OWN.items() if type(lens) is model), None)
    terms = {name: float(getattr(lens, name)) for name in lens.names()}
    if own is not None:
        return {"camera_type": own, "intrinsics": values | terms}
    if not isinstance(lens, BrownConrady | Rational):
        raise InvalidRig(f"lens {lens.said}: Basalt has no such model")
    beyond = {name: value for name, value in terms.items() if value and name not in _RADTAN_TERMS}
    if beyond:
        raise InvalidRig(f"lens {lens.said}: Basalt's radtan8 has no {', '.join(beyond)}")
    radtan = {name: terms.get(name, 0.0) for name in ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")}
    return {"camera_type": "pinhole-radtan8", "intrinsics": {**values, **radtan, "rpmax": 0.0}}


def _place(pose: Pose) -> dict[str, float]:
    px, py, pz = (float(value) for value in pose.t)
    qw, qx, qy, qz = quaternion_from_rotvec(pose.rotvec_rad)
    return {"px": px, "py": py, "pz": pz, "qx": qx, "qy": qy, "qz": qz, "qw": qw}


def _pose(value: object, name: str) -> Pose:
    q = np.array([number(member(value, key, name), f"{key} of {name}") for key in _QUATERNION])
    t = [number(member(value, key, name), f"{key} of {name}") for key in ("px", "py", "pz")]
    return Pose(rotation_from_quaternion(q, name), np.array(t))


def _camera(value: object, size: object, name: str) -> Intrinsics:
    kind = member(value, "camera_type", name)
    table = _table(member(value, "intrinsics", name), f"intrinsics of {name}")
    width, height = numbers(size, f"resolution of {name}", 2)

    def term(key: str) -> float:
        return number(member(table, key, f"intrinsics of {name}"), f"{key} of {name}")

    fx, fy, cx, cy = (term(key) for key in ("fx", "fy", "cx", "cy"))
    try:
        return Intrinsics(
            pixels(float(width), f"width of {name}"),
            pixels(float(height), f"height of {name}"),
            *(fx, fy, cx, cy),
            _lens(kind, {key: term(key) for key in table}, name),
        )
    except InvalidRig as error:
        raise InvalidRig(f"{name}: {error}") from None


def _lens(kind: object, terms: Mapping[str, float], name: str) -> Lens | None:
    def term(key: str) -> float:
        return number(member(terms, key, f"intrinsics of {name}"), key)

    if kind == "pinhole":
        return None
    if kind == "ucm":  # the enhanced model's own case
        return Eucm(term("alpha"), 1.0)
    if isinstance(kind, str) and kind in _OWN:
        model = _OWN[kind]
        return model(*(term(key) for key in model.names()))
    radtan = _RADTAN.fullmatch(kind) if isinstance(kind, str) else None
    if radtan is None:
        raise InvalidRig(f"camera_type {shown(kind)}: must be one of {', '.join(_TYPES)}")
    coefficients = [term(key) for key in _RADTAN_TERMS[: int(radtan[1])]]
    return opencv_distortion(np.array(coefficients), "distortion")


def _table(value: object, name: str) -> Mapping[str, object]:
    if not isinstance(value, Mapping):
        raise InvalidRig(f"{name} {shown(value)}: must be a table of names and values")
    return value


def _list(table: Mapping[str, object], key: str) -> list[object]:
    value = member(table, key)
    if not isinstance(value, list):
        raise InvalidRig(f"{key} {shown(value)}: must be a list, one value a camera")
    return value


def knows(text: str) -> bool:
    """Whether a text is Basalt's."""
    return text.lstrip()[:1] == "{" and '"T_imu_cam"' in text and _KNOWN.search(text) is not None


def _open(files: tuple[File, ...], asked: Asked) -> Found:
    return parse_basalt(files[0].text, asked)


FORMAT = Format(
    "basalt",
    "Basalt's calibration",
    (".json",),
    FILE_NAME,
    groups=alone(knows),
    open=_open,
    write=lambda rig: {FILE_NAME: basalt_json(rig)},
)
