"""A pair of ROS's ``camera_info`` files as a rig, and a rig as such a pair."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from rigsim.errors import InvalidRig, MeasurementFailed
from rigsim.interop.formats.format import Asked, File, Format, Found, names_sides, swapped
from rigsim.interop.formats.kit.poses import rectified_pose
from rigsim.interop.formats.robotics.camera_info import CameraInfo, camera_info, model_of
from rigsim.interop.formats.values import reals
from rigsim.rig.arrays import Array
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.remark import Remark
from rigsim.rig.stereo import StereoRig

FILE_NAMES = ("left.yaml", "right.yaml")

_ROUNDED = 1e-3
_MOST = 20
_FILE = re.compile(r"^(?:projection_matrix|rectification_matrix)\s*:", re.MULTILINE)
_MESSAGE = re.compile(r"^[pP]\s*:", re.MULTILINE)
_OF_FILE = re.compile(r"^camera_matrix\s*:", re.MULTILINE)
_OF_MESSAGE = re.compile(r"^(?:distortion_model|[dD])\s*:", re.MULTILINE)
_SIDE = re.compile(r"left|right|(?<![a-z])[lr](?![a-z])", re.IGNORECASE)
_NUMBER = re.compile(r"\d+")


def camera_info_yaml(rig: StereoRig) -> tuple[str, str]:
    """The texts of left.yaml and right.yaml of `rig`, every digit kept.

    Raises:
        InvalidRig: no rows can be made to correspond, as one camera lies ahead of the other; or a lens is of
            a model that camera_info has not.
    """
    R1, R2, K1, K2 = _rectified(rig)
    P1, P2 = np.hstack([K1, np.zeros((3, 1))]), np.hstack([K2, np.zeros((3, 1))])
    P2[0, 3] = -K2[0, 0] * rig.baseline_m
    return _camera_text(rig.left, "left", R1, P1), _camera_text(rig.right, "right", R2, P2)


def parse_camera_info(left: str, right: str) -> Found:
    """The rig in the texts of two camera_info, named left.yaml and right.yaml in messages.

    Raises:
        InvalidRig: no YAML, a value is missing or cannot be, or neither has a baseline.
    """
    return _pair(list(zip(FILE_NAMES, (left, right), strict=True)))


def _pair(named: Sequence[tuple[str, str]]) -> Found:
    """The rig in two texts, each with its file's name; the one with the baseline is the right camera's."""
    infos = []
    for name, text in named:
        try:
            infos.append(camera_info(text))
        except InvalidRig as error:
            raise InvalidRig(f"{name}: {error}") from None
    (first, second), remarks = _sides([name for name, _ in named], infos)
    left, right = infos[first], infos[second]
    if abs(left.P[0, 0] - right.P[0, 0]) > _ROUNDED * abs(left.P[0, 0]):
        raise InvalidRig(
            f"projection_matrix[0,0] {left.P[0, 0]:g} left, {right.P[0, 0]:g} right: must be equal, as of a"
            " rectified pair"
        )
    pose = rectified_pose((left.R, right.R), (left.P, right.P), "projection_matrix")
    every = dict.fromkeys((*left.remarks, *right.remarks, *remarks))
    return Found(StereoRig(left.camera, right.camera, pose), "m", tuple(every))


def _sides(names: Sequence[str], infos: Sequence[CameraInfo]) -> tuple[tuple[int, int], tuple[Remark, ...]]:
    """Which of two is left and which right: by P, and where both have a baseline by the names."""
    has = [bool(info.P[:2, 3].any()) for info in infos]
    if not any(has):
        raise InvalidRig(
            "projection_matrix[0,3] and [1,3] are 0 in both files: the right one's must be -fx b; are they"
            " two monocular calibrations? Calibrate both cameras together"
        )
    by_name = _left_of(*names) or _left_of(*(info.name for info in infos))
    if has[0] == has[1]:
        if by_name is None:
            raise InvalidRig(
                "projection_matrix has a baseline in both files, and neither their names nor camera_name tell"
                " left from right: name them left.yaml and right.yaml"
            )
        return by_name, ()
    by_baseline = (0, 1) if has[1] else (1, 0)
    if by_name in (None, by_baseline):
        return by_baseline, ()
    text = (
        f"{names[by_baseline[1]]} has the baseline in its projection_matrix and is taken for the right"
        " camera's, whatever its name: the two files may be exchanged"
    )
    return by_baseline, (Remark("files_exchanged", text),)


def _left_of(first: str, second: str) -> tuple[int, int] | None:
    """Places of the left and the right one of two names that differ in that; None where they do not."""
    return _by_word(first, second) or _by_number(first, second)


def _by_word(first: str, second: str) -> tuple[int, int] | None:
    sides = [[word[0].lower() for word in _SIDE.findall(name)] for name in (first, second)]
    if sides[0] == sides[1] or _SIDE.sub("*", first) != _SIDE.sub("*", second):
        return None
    return (0, 1) if sides[0] < sides[1] else (1, 0)


def _by_number(first: str, second: str) -> tuple[int, int] | None:
    numbers = [[int(word) for word in _NUMBER.findall(name)] for name in (first, second)]
    if numbers[0] == numbers[1] or _NUMBER.sub("*", first) != _NUMBER.sub("*", second):
        return None
    return (0, 1) if numbers[0] < numbers[1] else (1, 0)


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
    try:
        model, coefficients = model_of(camera.lens)
    except InvalidRig as error:
        raise InvalidRig(f"{name} {error}") from None
    return (
        f"# rigsim stereo rig, {name} camera. The right P[0,3] is -fx b, b in metres; integer pixel = pixel"
        " centre.\n"
        f"image_width: {camera.width}\n"
        f"image_height: {camera.height}\n"
        f"camera_name: {name}\n"
        + _matrix_text("camera_matrix", camera.K)
        + f"distortion_model: {model}\n"
        + _matrix_text("distortion_coefficients", np.array([coefficients]))
        + _matrix_text("rectification_matrix", R)
        + _matrix_text("projection_matrix", P)
    )


def _matrix_text(name: str, M: Array) -> str:
    data = ",\n         ".join(reals(row) for row in M)
    return f"{name}:\n  rows: {M.shape[0]}\n  cols: {M.shape[1]}\n  data: [{data}]\n"


def knows(text: str) -> bool:
    """Whether a text is a camera_info: a calibration's file, or the message of a running camera."""
    if _OF_FILE.search(text) is not None:
        return _FILE.search(text) is not None
    return _MESSAGE.search(text) is not None and _OF_MESSAGE.search(text) is not None


def groups(files: Sequence[File]) -> list[tuple[File, ...]]:
    """The pairs of files: two alone, or those of several whose names differ in the side, or whose P match."""
    known = [file for file in files if knows(file.text)][:_MOST]
    pairs = list(combinations(known, 2))
    if len(pairs) < 2:
        return list(pairs)
    tests = (lambda *pair: _by_word(*map(_called, pair)), lambda *pair: _by_number(*map(_called, pair)), _fit)
    made: Iterator[list[tuple[File, ...]]] = ([pair for pair in pairs if test(*pair)] for test in tests)
    return next((alike for alike in made if alike), [])


def _fit(one: File, other: File) -> bool:
    """Whether one of two files has a baseline and the other, seen with the same camera matrix, none."""
    try:
        infos = [camera_info(file.text) for file in (one, other)]
    except InvalidRig:
        return False
    same = np.allclose(infos[0].P[:, :2], infos[1].P[:, :2], rtol=_ROUNDED)
    return bool(same and infos[0].P[:2, 3].any() != infos[1].P[:2, 3].any())


def _called(file: File) -> str:
    """A file's name with its folder's: some keep left/camera.yaml and right/camera.yaml."""
    return f"{file.path.absolute().parent.name}/{file.name}"


def lacks(file: File) -> str | None:
    """What a file of one camera lacks."""
    if not knows(file.text) and _OF_FILE.search(file.text) is None:
        return None
    return (
        "camera_info of one camera: name the other's beside it, as --rig left.yaml --rig right.yaml; a rig"
        " needs both, each with its rectification_matrix and projection_matrix"
    )


def _open(files: tuple[File, ...], asked: Asked) -> Found:
    names = [file.name for file in files]
    if names[0] == names[1]:
        names = [_called(file) for file in files]
    found = _pair([(name, file.text) for name, file in zip(names, files, strict=True)])
    return replace(found, rig=swapped(found.rig)) if names_sides(asked) else found


FORMAT = Format(
    "ros",
    "ROS's camera_info, a file a camera",
    (".yml", ".yaml"),
    FILE_NAMES[0],
    groups=groups,
    open=_open,
    lacks=lacks,
    write=lambda rig: dict(zip(FILE_NAMES, camera_info_yaml(rig), strict=True)),
)
