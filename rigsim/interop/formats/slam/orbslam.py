"""Settings of ORB-SLAM2 and ORB-SLAM3 for two cameras.

ORB-SLAM2 has ``Camera.fx`` and ``Camera.bf``, the baseline times fx (px m), of the rectified pair, and beside
them ``LEFT.K, LEFT.D, LEFT.R, LEFT.P`` and ``RIGHT...`` as OpenCV rectifies where the pictures are not yet.
ORB-SLAM3 has ``Camera1.fx`` ... and ``Camera2.fx`` ..., and ``Stereo.T_c1_c2``, which maps the right camera's
frame to the left one's, metres; or of rectified pictures ``Camera1.fx`` ... and ``Stereo.b``.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found, alone, names_sides, swapped
from rigsim.interop.formats.kit.poses import rectified_pose, rigid
from rigsim.interop.formats.values import (
    lens,
    matrix,
    member,
    number,
    numbers,
    opencv_distortion,
    pixels,
    rotation,
    shown,
    size_or_guess,
)
from rigsim.interop.formats.yaml_text import yaml_table
from rigsim.rig.arrays import Array
from rigsim.rig.lens.kannala_brandt import KannalaBrandt
from rigsim.rig.lens.lens import Lens
from rigsim.rig.pose import Pose
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig

_KNOWN = re.compile(r"^[\"']?Camera1?\.fx[\"']?\s*:", re.MULTILINE)
_STEREO = re.compile(r"^(?:Camera\.bf|Stereo\.T_c1_c2|Stereo\.b|Tlr|LEFT\.K)\s*:", re.MULTILINE)
_POLYNOMIAL = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
_FISHEYE = ("k1", "k2", "k3", "k4")
_SAME = 0.01

Table = Mapping[str, object]


def parse_orbslam(text: str, asked: Asked | None = None) -> Found:
    """The rig in the text of the settings.

    Raises:
        InvalidRig: no YAML, values are missing or cannot be, or they are of one camera.
    """
    asked, table = asked or Asked(), yaml_table(text)
    if "DepthMapFactor" in table or "RGBD.DepthMapFactor" in table:
        raise InvalidRig("are settings of a depth camera (DepthMapFactor): a rig has two cameras")
    if "Stereo.T_c1_c2" in table or "Tlr" in table:
        return _two_cameras(table, asked)
    if "LEFT.K" in table:
        return _before_rectifying(table, asked)
    return _rectified(table, asked)


def _two_cameras(table: Table, asked: Asked) -> Found:
    """ORB-SLAM3's two cameras as they are."""
    first = "Camera1" if "Camera1.fx" in table else "Camera"
    K = [_camera_matrix(table, name) for name in (first, "Camera2")]
    size, remarks = _size(table, asked, K)
    key = "Stereo.T_c1_c2" if "Stereo.T_c1_c2" in table else "Tlr"
    left_from_right = rigid(table[key], key)
    fisheye = _is_fisheye(table)
    left, right = (
        lens(*size, one, _lens(table, name, fisheye), name)
        for one, name in zip(K, (first, "Camera2"), strict=True)
    )
    return Found(StereoRig(left, right, left_from_right.inverse), "m", remarks)


def _before_rectifying(table: Table, asked: Asked) -> Found:
    """ORB-SLAM2's two cameras before they are rectified."""
    sides = ("LEFT", "RIGHT")
    K, R, P = (
        [matrix(member(table, f"{side}.{key}"), f"{side}.{key}", *shape) for side in sides]
        for key, shape in (("K", (3, 3)), ("R", (3, 3)), ("P", (3, 4)))
    )
    D = [_row(member(table, f"{side}.D"), f"{side}.D") for side in sides]
    remarks: tuple[Remark, ...] = ()
    bf = _baseline(table)
    own = float(P[0][0, 3] - P[1][0, 3])
    if bf is not None and own == 0:
        P[1][0, 3] = -bf
    elif bf is not None and abs(own - bf) > _SAME * abs(bf):
        text = f"Camera.bf {bf:g} and RIGHT.P[0,3] {P[1][0, 3]:g} px m differ: RIGHT.P is taken"
        remarks = (Remark("baselines_differ", text),)
    turns = (rotation(R[0], "LEFT.R"), rotation(R[1], "RIGHT.R"))
    pose = rectified_pose(turns, (P[0], P[1]), "LEFT.P or RIGHT.P")
    size, guessed = _size(table, asked, K)
    cameras = []
    for i, side in enumerate(sides):
        own_size = _pair_of(table, f"{side}.width", f"{side}.height") or size
        cameras.append(lens(*own_size, K[i], opencv_distortion(D[i], f"{side}.D"), f"{side}.K"))
    return Found(StereoRig(cameras[0], cameras[1], pose), "m", (*guessed, *remarks))


def _rectified(table: Table, asked: Asked) -> Found:
    """A rectified pair."""
    first = "Camera1" if "Camera1.fx" in table else "Camera"
    K = _camera_matrix(table, first)
    if "Stereo.b" in table:
        b = number(table["Stereo.b"], "Stereo.b")
    else:
        bf = _baseline(table)
        if bf is None:
            raise InvalidRig(
                "neither Stereo.T_c1_c2, Stereo.b nor Camera.bf is there: settings of one camera? A rig"
                " has two"
            )
        b = bf / float(K[0, 0])
    size, remarks = _size(table, asked, [K])
    camera = lens(*size, K, _lens(table, first, fisheye=_is_fisheye(table)), first)
    return Found(StereoRig(camera, camera, Pose(t=np.array([-b, 0.0, 0.0]))), "m", remarks)


def _baseline(table: Table) -> float | None:
    return number(table["Camera.bf"], "Camera.bf") if "Camera.bf" in table else None


def _camera_matrix(table: Table, name: str) -> Array:
    fx, fy, cx, cy = (
        number(member(table, f"{name}.{key}"), f"{name}.{key}") for key in ("fx", "fy", "cx", "cy")
    )
    return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])


def _is_fisheye(table: Table) -> bool:
    kind = table.get("Camera.type", "PinHole")
    word = str(kind).strip().lower()
    if word not in ("pinhole", "kannalabrandt8", "rectified"):
        raise InvalidRig(f"Camera.type {shown(kind)}: must be PinHole, KannalaBrandt8 or Rectified")
    return word == "kannalabrandt8"


def _lens(table: Table, name: str, fisheye: bool) -> Lens | None:
    order = _FISHEYE if fisheye else _POLYNOMIAL
    found = [f"{name}.{key}" in table for key in order]
    if fisheye and not all(found):
        missing = order[found.index(False)]
        raise InvalidRig(f"{name}.{missing} is missing: KannalaBrandt8 has k1, k2, k3, k4")
    terms = [
        number(table[f"{name}.{key}"], f"{name}.{key}") if has else 0.0
        for key, has in zip(order, found, strict=True)
    ]
    return KannalaBrandt(*terms) if fisheye else opencv_distortion(np.array(terms), name)


def _row(value: object, name: str) -> Array:
    rows = value if isinstance(value, list) else [value]
    return numbers([item for row in rows for item in (row if isinstance(row, list) else [row])], name)


def _pair_of(table: Table, width: str, height: str) -> tuple[int, int] | None:
    if width not in table and height not in table:
        return None
    return pixels(member(table, width), width), pixels(member(table, height), height)


def _size(table: Table, asked: Asked, K: list[Array]) -> tuple[tuple[int, int], tuple[Remark, ...]]:
    """Width and height, px, and what is to be said where the file has none."""
    own = _pair_of(table, "Camera.width", "Camera.height") or _pair_of(table, "LEFT.width", "LEFT.height")
    if own is not None:
        return own, ()
    width, height, remark = size_or_guess(asked, [(float(one[0, 2]), float(one[1, 2])) for one in K])
    return (width, height), () if remark is None else (remark,)


def knows(text: str) -> bool:
    """Whether a text is settings of ORB-SLAM for two cameras."""
    return _KNOWN.search(text) is not None and _STEREO.search(text) is not None


def lacks(file: File) -> str | None:
    """What settings of one camera lack."""
    if _KNOWN.search(file.text) is None or knows(file.text):
        return None
    return (
        "is ORB-SLAM's settings of one camera: a rig needs Stereo.T_c1_c2 with Camera1 and Camera2, Stereo.b,"
        " or Camera.bf"
    )


def _open(files: tuple[File, ...], asked: Asked) -> Found:
    found = parse_orbslam(files[0].text, asked)
    return replace(found, rig=swapped(found.rig)) if names_sides(asked) else found


FORMAT = Format(
    "orbslam",
    "ORB-SLAM2's and ORB-SLAM3's stereo settings",
    (".yaml",),
    "EuRoC.yaml",
    groups=alone(knows),
    open=_open,
    lacks=lacks,
)
