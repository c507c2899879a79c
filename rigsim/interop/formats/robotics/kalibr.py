"""A calibration as Kalibr writes it: ``camchain.yaml`` (https://github.com/ethz-asl/kalibr/wiki/yaml-formats).

``cam0`` is the left camera, ``cam1`` the right one; ``T_cn_cnm1`` of ``cam1`` maps the frame of the camera
before it to its own, metres. With an inertial unit there is ``T_cam_imu``, camera from unit, and OpenVINS has
its inverse ``T_imu_cam`` alone.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found, alone
from rigsim.interop.formats.kit.cameras import two_of
from rigsim.interop.formats.kit.poses import rigid
from rigsim.interop.formats.robotics.lens_words import camera_of, words_of
from rigsim.interop.formats.values import member, numbers, pixels, reals
from rigsim.interop.formats.yaml_text import yaml_table
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig

FILE_NAME = "camchain.yaml"

_HEAD = """\
# rigsim stereo rig: cam0 left, cam1 right; x_cam1 = T_cn_cnm1 x_cam0, metres; integer pixel = pixel centre.
"""
_CAMERA = re.compile(r"cam(\d+)")
_KNOWN = re.compile(r"^[\"']?cam\d+[\"']?\s*:", re.MULTILINE)
_WORDS = re.compile(r"\b(camera_model|distortion_coeffs|distortion_model|T_cn_cnm1|T_cam_imu|T_imu_cam)\b")
_SAME_TURN_RAD, _SAME_WAY = 0.02, 0.02
"""By how much two ways from camera to camera may differ, rad and share of the baseline: files are rounded."""


def camchain_yaml(rig: StereoRig) -> str:
    """The text of a camchain.yaml of `rig`, every digit kept.

    Raises:
        InvalidRig: a lens is of no model that Kalibr has, as one with k3, which ``radtan`` lacks.
    """
    pose = rig.right_from_left
    rows = [[*pose.R[i], pose.t[i]] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]
    transform = "\n".join(f"  - [{reals(row)}]" for row in rows)
    return (
        f"{_HEAD}cam0:\n{_camera_text(rig.left, 'left', 1)}\ncam1:\n{_camera_text(rig.right, 'right', 0)}\n"
        f"  T_cn_cnm1:\n{transform}\n"
    )


def parse_camchain(text: str, asked: Asked | None = None) -> Found:
    """The rig in the text of a camchain.yaml: its first two cameras, or those that are asked for.

    Raises:
        InvalidRig: no YAML, a camera is missing, no lens is of its models, or values cannot be.
    """
    table = yaml_table(text)
    numbered = [(int(found[1]), name) for name in table if (found := _CAMERA.fullmatch(name))]
    names = [name for _, name in sorted(numbered)]
    first, second, remarks = two_of(names, asked or Asked())
    left, right = (_camera(table[names[i]], names[i]) for i in (first, second))
    pose, more = _pose(table, names, first, second)
    return Found(
        StereoRig(left, right, pose),
        "m",
        (*remarks, *_of_models(table, [names[i] for i in (first, second)]), *more),
    )


def _camera_text(camera: Intrinsics, side: str, overlaps: int) -> str:
    try:
        camera_model, distortion, intrinsics, coefficients = words_of(camera, "Kalibr")
    except InvalidRig as error:
        raise InvalidRig(f"{side} {error}") from None
    return (
        f"  cam_overlaps: [{overlaps}]\n"
        f"  camera_model: {camera_model}\n"
        f"  intrinsics: [{reals(intrinsics)}]\n"
        f"  distortion_model: {distortion}\n"
        f"  distortion_coeffs: [{reals(coefficients)}]\n"
        f"  resolution: [{camera.width}, {camera.height}]\n"
        f"  rostopic: /{side}/image_raw"
    )


def _of_models(table: Mapping[str, object], names: Sequence[str]) -> tuple[Remark, ...]:
    """What is to be said where cameras have no camera model."""
    cameras = [(name, table[name]) for name in names]
    without = [name for name, own in cameras if isinstance(own, Mapping) and own.get("camera_model") is None]
    if not without:
        return ()
    text = f"{' and '.join(without)} without camera_model: pinhole assumed; add camera_model if it is another"
    return (Remark("camera_model", text),)


def _camera(table: object, name: str) -> Intrinsics:
    of = f" of {name}"
    width, height = numbers(member(table, "resolution", name), f"resolution{of}", 2)
    assert isinstance(table, Mapping)
    model = table.get("camera_model")
    model = "pinhole" if model is None else model
    return camera_of(
        (pixels(float(width), f"width{of}"), pixels(float(height), f"height{of}")),
        (model, table.get("distortion_model")),
        (member(table, "intrinsics", name), table.get("distortion_coeffs")),
        of,
    )


def _pose(
    table: Mapping[str, object], names: Sequence[str], first: int, second: int
) -> tuple[Pose, tuple[Remark, ...]]:
    """The second camera's frame from the first one's, and what is to be said of it."""
    chain = _along_chain(table, names, first, second)
    if chain is None:
        return _through_unit(table, names[first], names[second]), ()
    try:
        through = _through_unit(table, names[first], names[second])
    except InvalidRig:
        return chain, ()
    apart = chain @ through.inverse
    turn, way = np.linalg.norm(apart.rotvec_rad), np.linalg.norm(chain.t - through.t)
    if turn <= _SAME_TURN_RAD and way <= _SAME_WAY * np.linalg.norm(chain.t):
        return chain, ()
    text = (
        f"T_cn_cnm1 and the T_cam_imu of both cameras differ by {way * 1e3:.3g} mm and"
        f" {np.degrees(turn):.3g} deg: T_cn_cnm1 is taken; calibrate again if the file was put together by"
        " hand"
    )
    return chain, (Remark("poses_differ", text),)


def _along_chain(table: Mapping[str, object], names: Sequence[str], first: int, second: int) -> Pose | None:
    """The same through every camera between; None where a link is missing."""
    pose = Pose()
    for i in range(min(first, second) + 1, max(first, second) + 1):
        own = table[names[i]]
        if not isinstance(own, Mapping) or own.get("T_cn_cnm1") is None:
            return None
        pose = rigid(own["T_cn_cnm1"], f"T_cn_cnm1 of {names[i]}") @ pose
    return pose if first < second else pose.inverse


def _through_unit(table: Mapping[str, object], first: str, second: str) -> Pose:
    """The same through the inertial unit."""
    ways = [_from_unit(table[name], name) for name in (first, second)]
    if ways[0] is None or ways[1] is None:
        raise InvalidRig(
            f"T_cn_cnm1 of {second} is missing, and so is T_cam_imu or T_imu_cam of {first} and of {second}:"
            " one of them is needed for the pose between the two"
        )
    return ways[1] @ ways[0].inverse


def _from_unit(camera: object, name: str) -> Pose | None:
    """The camera's frame from the inertial unit's; None where the file has none."""
    if not isinstance(camera, Mapping):
        return None
    if camera.get("T_cam_imu") is not None:
        return rigid(camera["T_cam_imu"], f"T_cam_imu of {name}")
    if camera.get("T_imu_cam") is not None:
        return rigid(camera["T_imu_cam"], f"T_imu_cam of {name}").inverse
    return None


def knows(text: str) -> bool:
    """Whether a text is a chain of cameras."""
    return _KNOWN.search(text) is not None and _WORDS.search(text) is not None


def _open(files: tuple[File, ...], asked: Asked) -> Found:
    return parse_camchain(files[0].text, asked)


FORMAT = Format(
    "kalibr",
    "Kalibr's camera chain, OpenVINS's included",
    (".yml", ".yaml"),
    FILE_NAME,
    groups=alone(knows),
    open=_open,
    write=lambda rig: {FILE_NAME: camchain_yaml(rig)},
)
