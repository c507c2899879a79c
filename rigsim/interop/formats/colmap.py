"""A calibration as COLMAP's text model, rigs and frames of 3.12 on included (colmap.github.io/format).

COLMAP counts pixels from the corner of the first one: its principal point is half a pixel more. An
image's pose maps the world to the camera, axes as OpenCV's; lengths are metres here, in COLMAP they have no
unit.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Format
from rigsim.interop.formats.values import (
    clipped,
    number,
    opencv_distortion,
    pixels,
    quaternion_from_rotvec,
    read_text,
    real,
    rotation_from_quaternion,
)
from rigsim.rig.intrinsics import Intrinsics
from rigsim.rig.lens.distortion import brown_of
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

FILE_NAMES = ("cameras.txt", "rigs.txt", "frames.txt", "images.txt", "points3D.txt")

_HALF = 0.5
# how many numbers each model has, and which of them are fx, fy, cx, cy, k1, k2, p1, p2, k3
_MODELS: dict[str, tuple[int, tuple[int, ...]]] = {
    "SIMPLE_PINHOLE": (3, (0, 0, 1, 2)),
    "PINHOLE": (4, (0, 1, 2, 3)),
    "SIMPLE_RADIAL": (4, (0, 0, 1, 2, 3)),
    "RADIAL": (5, (0, 0, 1, 2, 3, 4)),
    "OPENCV": (8, (0, 1, 2, 3, 4, 5, 6, 7)),
    "FULL_OPENCV": (12, (0, 1, 2, 3, 4, 5, 6, 7, 8)),
}


def colmap_files(
    rig: StereoRig,
    left_from_world: Sequence[Pose] = (Pose(),),
    names: Sequence[tuple[str, str]] = (("left.png", "right.png"),),
) -> dict[str, str]:
    """The texts of a model in which `rig` took one frame a pose, without points.

    Args:
        rig: camera 1 is the left one, camera 2 the right one.
        left_from_world: where the rig was in each frame.
        names: the left and the right image's name of each frame.
    """
    cameras = [_camera_line(1, rig.left), _camera_line(2, rig.right)]
    frames, images = [], []
    for i, (pose, pair) in enumerate(zip(left_from_world, names, strict=True)):
        ids = (2 * i + 1, 2 * i + 2)
        frames.append(f"{i + 1} 1 {_pose_text(pose)} 2 CAMERA 1 {ids[0]} CAMERA 2 {ids[1]}")
        for camera, (image, name, own) in enumerate(
            zip(ids, pair, (pose, rig.right_from_left @ pose), strict=True), start=1
        ):
            images += [f"{image} {_pose_text(own)} {camera} {name}", ""]
    heads = (
        "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]; the first pixel's centre is at 0.5, 0.5",
        "# RIG_ID NUM_SENSORS REF_TYPE REF_ID (TYPE ID HAS_POSE QW QX QY QZ TX TY TZ)[]; metres",
        "# FRAME_ID RIG_ID QW QX QY QZ TX TY TZ NUM_DATA (TYPE SENSOR_ID IMAGE_ID)[]; rig from world",
        "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, and a line of points; camera from world",
        "# POINT3D_ID X Y Z R G B ERROR TRACK[]",
    )
    rigs = [f"1 2 CAMERA 1 CAMERA 2 1 {_pose_text(rig.right_from_left)}"]
    bodies: tuple[list[str], ...] = (cameras, rigs, frames, images, [])
    return {
        name: "\n".join([head, *body]) + "\n"
        for name, head, body in zip(FILE_NAMES, heads, bodies, strict=True)
    }


def parse_colmap(texts: Mapping[str, str]) -> StereoRig:
    """The rig in the texts of a model, by file name: ``cameras.txt``, and ``rigs.txt`` or ``images.txt``.

    The left camera is the first rig's reference; in a model without rigs it is the first image's, and the
    right one the second image's, which must be of another camera: two poses of one camera are no rig.

    Raises:
        InvalidRig: a line cannot be read, a camera is missing or moves between the images, or its model is
            unknown.
    """
    cameras = {}
    for words, where in _lines(texts["cameras.txt"], "cameras.txt"):
        cameras[words[0]] = _camera(words, where)
    rigs = list(_lines(texts.get("rigs.txt", ""), "rigs.txt"))
    if rigs:
        left, right, pose = _rig(*rigs[0])
    else:
        left, right, pose = _first_two(texts.get("images.txt", ""))
    for name in (left, right):
        if name not in cameras:
            raise InvalidRig(f"cameras.txt: camera {name} is missing: a rig needs two")
    return StereoRig(cameras[left], cameras[right], pose)


def _camera_line(number: int, camera: Intrinsics) -> str:
    d = brown_of(camera.lens, "COLMAP's OPENCV camera")
    params = [camera.fx, camera.fy, camera.cx + _HALF, camera.cy + _HALF]
    model = "PINHOLE"
    if not d.is_ideal:
        params += [d.k1, d.k2, d.p1, d.p2] + ([d.k3, 0.0, 0.0, 0.0] if d.k3 else [])
        model = "FULL_OPENCV" if d.k3 else "OPENCV"
    return f"{number} {model} {camera.width} {camera.height} {' '.join(real(value) for value in params)}"


def _pose_text(pose: Pose) -> str:
    return " ".join(real(value) for value in (*quaternion_from_rotvec(pose.rotvec_rad), *pose.t))


def _lines(text: str, file: str) -> Iterator[tuple[list[str], str]]:
    """The words of each line that says something, and where it stands."""
    for i, line in enumerate(text.splitlines(), start=1):
        if line.strip() and not line.lstrip().startswith("#"):
            yield line.split(), f"{file}, line {i}"


def _camera(words: list[str], where: str) -> Intrinsics:
    if len(words) < 5 or words[1] not in _MODELS:
        model = clipped(words[1]) if len(words) > 1 else "missing"
        raise InvalidRig(f"{where}: camera model {model}: must be one of {', '.join(_MODELS)}")
    count, places = _MODELS[words[1]]
    if len(words) != 4 + count:
        raise InvalidRig(f"{where}: {words[1]} has {len(words) - 4} numbers, must have {count}")
    width, height = (pixels(word, f"{where}: size") for word in words[2:4])
    params = [number(word, f"{where}: parameter") for word in words[4:]]
    fx, fy, cx, cy, *terms = (params[place] for place in places)
    terms += [0.0] * (5 - len(terms)) + params[9:]
    distortion = opencv_distortion(np.array(terms), where)
    return Intrinsics(width, height, fx, fy, cx - _HALF, cy - _HALF, distortion)


def _rig(words: list[str], where: str) -> tuple[str, str, Pose]:
    if len(words) != 14 or words[1] != "2" or words[2] != "CAMERA" or words[4] != "CAMERA":
        raise InvalidRig(f"{where}: must be a rig of two cameras, the second one with its pose")
    return words[3], words[5], _pose(words[7:], where)


def _first_two(text: str) -> tuple[str, str, Pose]:
    # every second line holds points, and may be empty
    rows = [
        (line.split(), f"images.txt, line {i}")
        for i, line in enumerate(text.splitlines(), start=1)
        if not line.lstrip().startswith("#")
    ][::2]
    seen = [(words, where) for words, where in rows if words][:2]
    for words, where in seen:
        if len(words) < 10:
            raise InvalidRig(f"{where}: has {len(words)} words, must have 10: id, pose, camera, name")
    if len(seen) < 2:
        raise InvalidRig(
            f"images.txt: has {len(seen)} image(s), must have 2, left and right; or give a rigs.txt"
        )
    names = [words[9] for words, _ in seen]
    if seen[0][0][8] == seen[1][0][8] and not ("left" in names[0] and "right" in names[1]):
        raise InvalidRig(
            f"images.txt: {clipped(names[0])} and {clipped(names[1])} are both of camera {seen[0][0][8]}: two"
            " poses of one camera that moves are no rig; give a rigs.txt, or name the images left and right"
        )
    left, right = (_pose(words[1:8], where) for words, where in seen)
    return seen[0][0][8], seen[1][0][8], right @ left.inverse


def _pose(words: list[str], where: str) -> Pose:
    values = np.array([number(word, f"{where}: pose") for word in words])
    return Pose(rotation_from_quaternion(values[:4], where), values[4:])


_READ = ("cameras.txt", "rigs.txt", "images.txt")


def _read(path: Path) -> StereoRig:
    folder = path.parent
    needed, *others = _READ
    names = [needed, *(name for name in others if (folder / name).exists())]
    try:
        return parse_colmap({name: read_text(folder / name) for name in names})
    except InvalidRig as error:
        raise InvalidRig(f"{folder}: {error}") from None


FORMAT = Format(
    "colmap",
    "COLMAP's text model, with its rigs and frames",
    (".txt",),
    _READ[0],
    "sparse/0/cameras.txt",
    read=_read,
    names=_READ,
    write=colmap_files,
)
