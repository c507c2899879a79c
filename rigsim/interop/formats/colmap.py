"""A calibration as COLMAP's text model, rigs and frames of 3.12 on included (colmap.github.io/format).

COLMAP counts pixels from the corner of the first one: its principal point is half a pixel more. An
image's pose maps the world to the camera, axes as OpenCV's; lengths are metres here, in COLMAP they have no
unit.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from rigsim.errors import InvalidRig
from rigsim.interop.formats.format import Asked, File, Format, Found
from rigsim.interop.formats.photogrammetry.colmap_models import NAMES, camera_line, camera_of
from rigsim.interop.formats.photogrammetry.together import Taken, pose_together
from rigsim.interop.formats.values import (
    clipped,
    number,
    quaternion_from_rotvec,
    real,
    rotation_from_quaternion,
    shown,
)
from rigsim.rig.pose import Pose
from rigsim.rig.stereo import StereoRig

FILE_NAMES = ("cameras.txt", "rigs.txt", "frames.txt", "images.txt", "points3D.txt")

IN_METRES = "(TYPE ID HAS_POSE QW QX QY QZ TX TY TZ)[]; metres"
"""How rigsim's own rigs.txt says its unit."""


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
    cameras = [camera_line(1, rig.left), camera_line(2, rig.right)]
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
        f"# RIG_ID NUM_SENSORS REF_TYPE REF_ID {IN_METRES}",
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


def parse_colmap(texts: Mapping[str, str], cameras: tuple[str, str] | None = None) -> StereoRig:
    """The rig in the texts of a model, by file name: ``cameras.txt``, and ``rigs.txt`` or ``images.txt``.

    The left camera is the first rig's reference; in a model without rigs it is the first image's, and the
    right one the second image's, which must be of another camera: two poses of one camera are no rig.

    Args:
        texts: the files' texts.
        cameras: ids of the left and the right camera, of a rig with more than two.

    Raises:
        InvalidRig: a line cannot be read, a camera is missing or moves between the images, or its model is
            unknown.
    """
    found = {
        words[0]: camera_of(words, where) for words, where in _lines(texts["cameras.txt"], "cameras.txt")
    }
    rigs = list(_lines(texts.get("rigs.txt", ""), "rigs.txt"))
    if rigs:
        left, right, pose = _two(_rig(rigs), cameras)
    else:
        left, right, pose = _first_two(texts.get("images.txt", ""))
    for name in (left, right):
        if name not in found:
            raise InvalidRig(f"cameras.txt: camera {name} is missing: a rig needs two")
    return StereoRig(found[left], found[right], pose)


def _pose_text(pose: Pose) -> str:
    return " ".join(real(value) for value in (*quaternion_from_rotvec(pose.rotvec_rad), *pose.t))


def _lines(text: str, file: str) -> Iterator[tuple[list[str], str]]:
    """The words of each line that says something, and where it stands."""
    for i, line in enumerate(text.splitlines(), start=1):
        if line.strip() and not line.lstrip().startswith("#"):
            yield line.split(), f"{file}, line {i}"


def _rig(rigs: Sequence[tuple[list[str], str]]) -> dict[str, Pose]:
    """The cameras of the first rig that has two, by id, the reference first: poses from the rig's frame."""
    for words, where in rigs:
        sensors = _sensors(words, where)
        if len(sensors) > 1:
            return sensors
    where = rigs[0][1]
    raise InvalidRig(
        f"{where}: must be a rig of two cameras: every rig has one, so that its pictures are of a camera that"
        " moves; tell COLMAP which sensors are one rig (rig_configurator)"
    )


def _sensors(words: Sequence[str], where: str) -> dict[str, Pose]:
    """The cameras of one rig; those without a pose are left out."""
    count = int(number(words[1], f"{where}: sensors")) if len(words) > 1 else 0
    if count > 0 and len(words) < 4:
        raise InvalidRig(f"{where}: must be a rig of two cameras, the second one with its pose")
    sensors = {words[3]: Pose()} if count > 0 and words[2] == "CAMERA" else {}
    place = 4
    for _ in range(count - 1):
        has_pose = words[place + 2 : place + 3] == ["1"]
        end = place + 3 + (7 if has_pose else 0)
        if len(words) < end:
            raise InvalidRig(f"{where}: must be a rig of two cameras, the second one with its pose")
        if has_pose and words[place] == "CAMERA":
            sensors[words[place + 1]] = _pose(words[place + 3 : end], where)
        place = end
    if len(words) != place and count > 0:
        raise InvalidRig(f"{where}: must be a rig of two cameras, the second one with its pose")
    return sensors


def _two(sensors: Mapping[str, Pose], cameras: tuple[str, str] | None) -> tuple[str, str, Pose]:
    names = list(sensors)
    if cameras is None and len(names) > 2:
        raise InvalidRig(
            f"rigs.txt: a rig of the cameras {clipped(', '.join(names))}: choose two, as --rig-cameras"
            f" {names[0]},{names[1]}"
        )
    left, right = cameras or (names[0], names[1])
    for name in (left, right):
        if name not in sensors:
            raise InvalidRig(f"camera {shown(name)}: must be one of {clipped(', '.join(names))}")
    return left, right, sensors[right] @ sensors[left].inverse


def _first_two(text: str) -> tuple[str, str, Pose]:
    """The cameras of the first two images, and their pose: that of all that were taken together."""
    # every second line holds points, and may be empty
    rows = [
        (line.split(), f"images.txt, line {i}")
        for i, line in enumerate(text.splitlines(), start=1)
        if not line.lstrip().startswith("#")
    ][::2]
    images = [_image(words, where) for words, where in rows if words]
    if len(images) < 2:
        raise InvalidRig(
            f"images.txt: has {len(images)} image(s), must have 2, left and right; or give a rigs.txt"
        )
    left = images[0]
    right = next((image for image in images if image.camera != left.camera), images[1])
    if right.camera == left.camera:
        if not ("left" in left.name and "right" in right.name):
            raise InvalidRig(
                f"images.txt: {clipped(left.name)} and {clipped(right.name)} are both of camera"
                f" {left.camera}: two poses of one camera that moves are no rig; give a rigs.txt, or name the"
                " images left and right"
            )
        return left.camera, right.camera, right.pose @ left.pose.inverse
    pose = pose_together(images, left.camera, right.camera, "give a rigs.txt")
    return left.camera, right.camera, pose


def _image(words: Sequence[str], where: str) -> Taken:
    if len(words) < 10:
        raise InvalidRig(f"{where}: has {len(words)} words, must have 10: id, pose, camera, name")
    return Taken(words[8], words[9], _pose(words[1:8], where))


def _pose(words: Sequence[str], where: str) -> Pose:
    values = np.array([number(word, f"{where}: pose") for word in words])
    return Pose(rotation_from_quaternion(values[:4], where), values[4:])


# what the first line of each file that says something looks like
_FIRST = {
    "cameras.txt": re.compile(rf"\d+\s+(?:{'|'.join(NAMES)})\b"),
    "rigs.txt": re.compile(r"\d+\s+\d+\s+(?:CAMERA|IMU)\s+\d+"),
    "images.txt": re.compile(r"\d+(?:\s+[-+.\deE]+){7}\s+\d+\s+\S"),
}


def _kind(file: File) -> str | None:
    """Which of a model's files it is, by what it says."""
    line = next((line for line in file.text.splitlines() if line.strip() and line.lstrip()[0] != "#"), "")
    return next((name for name, form in _FIRST.items() if form.match(line.strip())), None)


def _groups(files: Sequence[File]) -> list[tuple[File, ...]]:
    kinds = [(file, _kind(file)) for file in files]
    made = []
    for file, kind in kinds:
        if kind == "cameras.txt":
            beside = {other: one for one, other in kinds if one.path.parent == file.path.parent}
            others = [beside[name] for name in ("rigs.txt", "images.txt") if name in beside]
            if others:
                made.append((file, *others))
    return made


def _lacks(file: File) -> str | None:
    kind = _kind(file)
    if kind is None:
        return None
    if kind == "cameras.txt":
        return "is COLMAP's cameras.txt, and no rigs.txt or images.txt lies beside it"
    return f"is COLMAP's {kind}, and no cameras.txt lies beside it"


def _open(group: tuple[File, ...], asked: Asked) -> Found:
    texts = {str(_kind(file)): file.text for file in group}
    ours = any(IN_METRES in text for text in texts.values())
    return Found(parse_colmap(texts, asked.cameras), unit="m" if ours else None)


FORMAT = Format(
    "colmap",
    "COLMAP's text model, with its rigs and frames",
    (".txt",),
    "cameras.txt",
    "sparse/0/cameras.txt",
    groups=_groups,
    open=_open,
    lacks=_lacks,
    write=colmap_files,
)
