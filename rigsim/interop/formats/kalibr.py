"""A calibration as Kalibr writes it: ``camchain.yaml`` (https://github.com/ethz-asl/kalibr/wiki/yaml-formats).

``cam0`` is the left camera, ``cam1`` the right one; ``T_cn_cnm1`` of ``cam1`` maps the left camera's frame to
the right one's, metres. Its ``radtan`` lens has k1, k2, p1, p2 and nothing else.
"""

from __future__ import annotations

import re

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Format
from rigsim.interop.formats.opencv_yaml import coefficients
from rigsim.interop.formats.values import (
    matrix,
    member,
    numbers,
    opencv_distortion,
    pixels,
    reals,
    rotation,
    shown,
)
from rigsim.interop.formats.yaml_text import yaml_table
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

FILE_NAME = "camchain.yaml"

_HEAD = """\
# rigsim stereo rig: cam0 left, cam1 right; x_cam1 = T_cn_cnm1 x_cam0, metres; integer pixel = pixel centre.
"""


def camchain_yaml(rig: StereoRig) -> str:
    """The text of a camchain.yaml of `rig`, every digit kept.

    Raises:
        InvalidRig: a lens has k3, which ``radtan`` lacks.
    """
    for side, camera in (("left", rig.left), ("right", rig.right)):
        k3 = coefficients(camera)[4]
        if k3:
            raise InvalidRig(f"{side} k3 {k3:g}: must be 0, Kalibr's radtan lens has no k3")
    pose = rig.right_from_left
    rows = [[*pose.R[i], pose.t[i]] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]
    transform = "\n".join(f"  - [{reals(row)}]" for row in rows)
    return (
        f"{_HEAD}cam0:\n{_camera_text(rig.left, 'left', 1)}\ncam1:\n{_camera_text(rig.right, 'right', 0)}\n"
        f"  T_cn_cnm1:\n{transform}\n"
    )


def parse_camchain(text: str) -> StereoRig:
    """The rig in the text of a camchain.yaml: its ``cam0`` and ``cam1``.

    Raises:
        InvalidRig: no YAML, a camera is missing, another model of camera or lens, or values cannot be.
    """
    table = yaml_table(text)
    left, right = (_camera(member(table, name), name) for name in ("cam0", "cam1"))
    name = "T_cn_cnm1 of cam1"
    T = matrix(member(table["cam1"], "T_cn_cnm1", "cam1"), name, 4, 4)
    if T[3].tolist() != [0, 0, 0, 1]:
        raise InvalidRig(f"{name}: its last row is {reals(T[3])}, must be 0, 0, 0, 1")
    return StereoRig(left, right, Pose(rotation(T[:3, :3], name), T[:3, 3]))


def _camera_text(camera: Intrinsics, side: str, overlaps: int) -> str:
    return (
        f"  cam_overlaps: [{overlaps}]\n"
        "  camera_model: pinhole\n"
        f"  intrinsics: [{reals((camera.fx, camera.fy, camera.cx, camera.cy))}]\n"
        "  distortion_model: radtan\n"
        f"  distortion_coeffs: [{reals(coefficients(camera)[:4])}]\n"
        f"  resolution: [{camera.width}, {camera.height}]\n"
        f"  rostopic: /{side}/image_raw"
    )


def _camera(table: object, name: str) -> Intrinsics:
    model = member(table, "camera_model", name)
    if model != "pinhole":
        raise InvalidRig(
            f"camera_model of {name} {shown(model)}: must be pinhole; calibrate with pinhole-radtan"
        )
    fx, fy, cx, cy = numbers(member(table, "intrinsics", name), f"intrinsics of {name}", 4)
    size = member(table, "resolution", name)
    width, height = numbers(size, f"resolution of {name}", 2)
    lens = member(table, "distortion_model", name)
    if lens not in ("radtan", "none"):
        raise InvalidRig(
            f"distortion_model of {name} {shown(lens)}: must be radtan or none; calibrate with pinhole-radtan"
        )
    distortion = None
    if lens == "radtan":
        key = f"distortion_coeffs of {name}"
        distortion = opencv_distortion(numbers(member(table, "distortion_coeffs", name), key, 4), key)
    return Intrinsics(
        pixels(float(width), f"width of {name}"),
        pixels(float(height), f"height of {name}"),
        float(fx),
        float(fy),
        float(cx),
        float(cy),
        distortion,
    )


_KNOWN = re.compile(r"^cam[01]\s*:", re.MULTILINE)

FORMAT = Format(
    "kalibr",
    "Kalibr's camera chain",
    (".yml", ".yaml"),
    FILE_NAME,
    knows=lambda text: _KNOWN.search(text) is not None,
    parse=parse_camchain,
    write=lambda rig: {FILE_NAME: camchain_yaml(rig)},
)
