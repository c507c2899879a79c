"""A calibration as OpenCV's FileStorage writes and reads it: ``stereo.yml``.

``K1, D1, K2, D2`` (left, right), ``R`` and ``T`` as `cv2.stereoCalibrate` returns them, mapping the left
camera's frame to the right one's, ``x_right = R x_left + T``; ``T`` in metres. A rectified rig also has
``R1, R2, P1, P2, Q`` as `cv2.stereoRectify` returns them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.files.folder import write_file
from rigsim.interop.formats.format import Format
from rigsim.interop.formats.values import (
    lens,
    matrix,
    member,
    numbers,
    opencv_distortion,
    pixels,
    reals,
    rotation,
)
from rigsim.interop.formats.yaml_text import yaml_table
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import brown_of
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

FILE_NAME = "stereo.yml"

_HEAD = """\
%YAML:1.0
---
# rigsim stereo rig. T and the baseline in metres; x_right = R x_left + T; integer pixel = pixel centre.
"""


def opencv_yaml(rig: StereoRig) -> str:
    """The text of a stereo.yml of `rig`, every digit kept."""
    left, right = rig.left, rig.right
    lines = [f"image_width: {left.width}", f"image_height: {left.height}"]
    if (right.width, right.height) != (left.width, left.height):
        lines += [f"image_width_right: {right.width}", f"image_height_right: {right.height}"]
    matrices: dict[str, Array] = {
        "K1": left.K,
        "D1": coefficients(left)[None],
        "K2": right.K,
        "D2": coefficients(right)[None],
        "R": rig.right_from_left.R,
        "T": rig.right_from_left.t[:, None],
    }
    if rig.is_rectified:
        matrices |= rectified_matrices(rig)
    return _HEAD + "\n".join([*lines, *(_matrix_text(name, M) for name, M in matrices.items())]) + "\n"


def write_opencv_yaml(path: Path, rig: StereoRig) -> None:
    """Write `rig` to the file `path`, whole or not at all.

    Raises:
        OutputError: it cannot be written.
    """
    write_file(path, opencv_yaml(rig).encode())


def parse_opencv_yaml(text: str) -> StereoRig:
    """The rig in the text of a stereo.yml; ``M1`` and ``M2`` may stand for ``K1`` and ``K2``.

    Raises:
        InvalidRig: no YAML, a matrix is missing, or values cannot be.
    """
    table = yaml_table(text)
    width = pixels(member(table, "image_width"), "image_width")
    height = pixels(member(table, "image_height"), "image_height")
    width_right = pixels(table.get("image_width_right", width), "image_width_right")
    height_right = pixels(table.get("image_height_right", height), "image_height_right")
    R = rotation(matrix(member(table, "R"), "R", 3, 3), "R")
    T = numbers(_flat(member(table, "T")), "T", 3)
    if not T.any():
        raise InvalidRig("T 0, 0, 0: must be the way from one camera to the other, m")
    return StereoRig(
        _camera(table, "1", width, height), _camera(table, "2", width_right, height_right), Pose(R, T)
    )


def coefficients(camera: Intrinsics) -> Array:
    """A camera's distortion in OpenCV's order, (5,): k1, k2, p1, p2, k3.

    Raises:
        InvalidRig: its lens is another model.
    """
    return np.array(brown_of(camera.lens, "the file").coefficients)


def rectified_matrices(rig: StereoRig) -> dict[str, Array]:
    """``R1, R2, P1, P2, Q`` of a rectified rig; ``Q`` maps (u, v, disparity, 1) to the left frame."""
    left, right, b = rig.left, rig.right, rig.baseline_m
    zero = np.zeros((3, 1))
    P1, P2 = np.hstack([left.K, zero]), np.hstack([right.K, zero])
    P2[0, 3] = -right.fx * b
    aspect = left.fx / left.fy  # 1 in cv2's own, whose pixels are square once rectified
    Q = np.array(
        [
            [1.0, 0.0, 0.0, -left.cx],
            [0.0, aspect, 0.0, -left.cy * aspect],
            [0.0, 0.0, 0.0, left.fx],
            [0.0, 0.0, 1 / b, rig.doffs_px / b],
        ]
    )
    return {"R1": np.eye(3), "R2": np.eye(3), "P1": P1, "P2": P2, "Q": Q}


def _camera(table: Mapping[str, object], side: str, width: int, height: int) -> Intrinsics:
    key = f"M{side}" if f"M{side}" in table and f"K{side}" not in table else f"K{side}"
    K = matrix(member(table, key), key, 3, 3)
    name = f"D{side}"
    distortion = opencv_distortion(numbers(_flat(table.get(name, [])), name), name)
    return lens(width, height, K, distortion, key)


def _flat(value: object) -> object:
    """The numbers of a row or a column."""
    if isinstance(value, list):
        return [item for row in value for item in (row if isinstance(row, list) else [row])]
    return value


def _matrix_text(name: str, M: Array) -> str:
    rows = ",\n      ".join(reals(row) for row in M)
    return (
        f"{name}: !!opencv-matrix\n   rows: {M.shape[0]}\n   cols: {M.shape[1]}\n   dt: d\n"
        f"   data: [ {rows} ]"
    )


_A_KEY = re.compile(r"^\s*\w+\s*:", re.MULTILINE)

FORMAT = Format(
    "opencv",
    "OpenCV's FileStorage, as its calibration and rectification samples write it",
    (".yml", ".yaml"),
    FILE_NAME,
    knows=lambda text: text.startswith("%YAML") or _A_KEY.search(text) is not None,
    parse=parse_opencv_yaml,
    write=lambda rig: {FILE_NAME: opencv_yaml(rig)},
    late=True,
    otherwise=(".yml", ".yaml"),
)
