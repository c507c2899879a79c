"""A calibration as ROS keeps it: one ``camera_info`` YAML a camera, ``left.yaml`` and ``right.yaml``.

``R`` turns each camera until rows correspond, ``P`` projects after that; the baseline stands in the right
one's ``P[0,3] = -fx b`` (px m) and nowhere else, so that a rig that cannot be rectified cannot be held
(sensor_msgs/CameraInfo; wiki.ros.org/image_pipeline/CameraInfo).
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from rigsim.errors import InvalidRig, MeasurementFailed
from rigsim.interop.formats.format import Format
from rigsim.interop.formats.opencv_yaml import coefficients
from rigsim.interop.formats.values import (
    lens,
    matrix,
    member,
    numbers,
    opencv_distortion,
    pixels,
    read_text,
    reals,
    rotation,
    shown,
)
from rigsim.interop.formats.yaml_text import yaml_table
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

FILE_NAMES = ("left.yaml", "right.yaml")

_MODELS = ("plumb_bob", "rational_polynomial")
_ROUNDED = 1e-6


def camera_info_yaml(rig: StereoRig) -> tuple[str, str]:
    """The texts of left.yaml and right.yaml of `rig`, every digit kept.

    Raises:
        InvalidRig: no rows can be made to correspond, as one camera lies ahead of the other.
    """
    R1, R2, K1, K2 = _rectified(rig)
    P1, P2 = np.hstack([K1, np.zeros((3, 1))]), np.hstack([K2, np.zeros((3, 1))])
    P2[0, 3] = -K2[0, 0] * rig.baseline_m
    return _camera_text(rig.left, "left", R1, P1), _camera_text(rig.right, "right", R2, P2)


def parse_camera_info(left: str, right: str) -> StereoRig:
    """The rig in the texts of left.yaml and right.yaml.

    Raises:
        InvalidRig: no YAML, a value is missing or cannot be, the left P has a baseline or the right one none.
    """
    lens_left, R1, P1 = _camera(left, FILE_NAMES[0])
    lens_right, R2, P2 = _camera(right, FILE_NAMES[1])
    key = "projection_matrix"
    if P1[0, 3] != 0:
        raise InvalidRig(
            f"left.yaml: {key}[0,3] {P1[0, 3]:g}: must be 0, the baseline stands in the right one's; are the"
            " two files swapped?"
        )
    if not P2[0, 3] < 0:
        raise InvalidRig(f"right.yaml: {_why_no_baseline(P2)}")
    if P2[1, 3] != 0 or P2[2, 3] != 0:
        raise InvalidRig(
            f"right.yaml: {key}[1,3] {P2[1, 3]:g} and [2,3] {P2[2, 3]:g}: must be 0, as rows correspond once"
            " rectified"
        )
    if not (P1[0, 0] > 0 and abs(P1[0, 0] - P2[0, 0]) <= _ROUNDED * P1[0, 0]):
        raise InvalidRig(f"{key}[0,0] {P1[0, 0]:g} left, {P2[0, 0]:g} right: must be > 0 and equal")
    # x_left and x_right turned are parallel, a baseline apart
    baseline = np.array([P2[0, 3] / P2[0, 0], 0.0, 0.0])
    return StereoRig(lens_left, lens_right, Pose(R2.T @ R1, R2.T @ baseline))


def _why_no_baseline(P: Array) -> str:
    """What a right projection (3, 4) without a baseline to the right means."""
    key = "projection_matrix"
    if P[0, 3] > 0:
        return (
            f"{key}[0,3] {P[0, 3]:g}: must be -fx b, below 0: this camera lies to the left of the other;"
            " exchange the two files, and the pictures with them"
        )
    if P[1, 3] != 0:
        return (
            f"{key}[1,3] {P[1, 3]:g}, and [0,3] 0: a pair one above the other; camera_info is read of cameras"
            " side by side alone: give its K, D, R, T as stereo.yml"
        )
    return f"{key}[0,3] 0: must be -fx b, below 0; is it a monocular calibration?"


def _rectified(rig: StereoRig) -> tuple[Array, Array, Array, Array]:
    """What turns each camera, (3, 3), and the camera matrix that it is seen with afterwards, (3, 3)."""
    if rig.is_rectified:
        return np.eye(3), np.eye(3), rig.left.K, rig.right.K
    from rigsim.pixels.dense.rectify import row_rotations  # scipy, and not always needed

    try:
        R1, R2 = row_rotations(rig)
    except MeasurementFailed as error:
        raise InvalidRig(f"{error}, and camera_info holds the baseline along the rows alone") from None
    K = np.eye(3)
    K[0, 0] = K[1, 1] = (rig.left.fx + rig.left.fy + rig.right.fx + rig.right.fy) / 4
    # each optical axis keeps its place in the image, as far as one principal point for both allows: with two,
    # infinity would have a disparity, which not every reader of P minds
    K[:2, 2] = np.mean(
        [
            np.array([camera.cx, camera.cy]) - K[0, 0] * R[:2, 2] / R[2, 2]
            for camera, R in ((rig.left, R1), (rig.right, R2))
        ],
        axis=0,
    )
    return R1, R2, K, K


def _camera_text(camera: Intrinsics, name: str, R: Array, P: Array) -> str:
    return (
        f"# rigsim stereo rig, {name} camera. The right P[0,3] is -fx b, b in metres; integer pixel = pixel"
        " centre.\n"
        f"image_width: {camera.width}\n"
        f"image_height: {camera.height}\n"
        f"camera_name: {name}\n"
        + _matrix_text("camera_matrix", camera.K)
        + "distortion_model: plumb_bob\n"
        + _matrix_text("distortion_coefficients", coefficients(camera)[None])
        + _matrix_text("rectification_matrix", R)
        + _matrix_text("projection_matrix", P)
    )


def _matrix_text(name: str, M: Array) -> str:
    data = ",\n         ".join(reals(row) for row in M)
    return f"{name}:\n  rows: {M.shape[0]}\n  cols: {M.shape[1]}\n  data: [{data}]\n"


def _camera(text: str, file: str) -> tuple[Intrinsics, Array, Array]:
    """One camera, its rectification (3, 3) and its projection (3, 4)."""
    try:
        table = yaml_table(text)
        model = member(table, "distortion_model")
        if model not in _MODELS:
            raise InvalidRig(f"distortion_model {shown(model)}: must be {' or '.join(_MODELS)}")
        width = pixels(member(table, "image_width"), "image_width")
        height = pixels(member(table, "image_height"), "image_height")

        def data(name: str) -> object:
            return member(member(table, name), "data", name)

        D = numbers(data("distortion_coefficients"), "distortion_coefficients")
        camera = lens(
            width,
            height,
            matrix(data("camera_matrix"), "camera_matrix", 3, 3),
            opencv_distortion(D, "distortion_coefficients"),
            "camera_matrix",
        )
        key = "rectification_matrix"
        R = rotation(matrix(data(key), key, 3, 3), key)
        return camera, R, matrix(data("projection_matrix"), "projection_matrix", 3, 4)
    except InvalidRig as error:
        raise InvalidRig(f"{file}: {error}") from None


_KNOWN = re.compile(r"^(camera_matrix|projection_matrix|distortion_model)\s*:", re.MULTILINE)


def _read(path: Path) -> StereoRig:
    if path.name not in FILE_NAMES:
        raise InvalidRig(
            f"{path}: camera_info of one camera; name both {' and '.join(FILE_NAMES)}, side by side"
        )
    left, right = (read_text(path.parent / name) for name in FILE_NAMES)
    try:
        return parse_camera_info(left, right)
    except InvalidRig as error:
        raise InvalidRig(f"{path.parent}: {error}") from None


FORMAT = Format(
    "ros",
    "ROS's camera_info, a file a camera",
    (".yml", ".yaml"),
    FILE_NAMES[0],
    knows=lambda text: _KNOWN.search(text) is not None,
    read=_read,
    names=FILE_NAMES,
    write=lambda rig: dict(zip(FILE_NAMES, camera_info_yaml(rig), strict=True)),
)
